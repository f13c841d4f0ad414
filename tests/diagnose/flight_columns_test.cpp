// Sums of the columns of a flight.
#include "diagnose/flight_columns.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

/// Three records, the second without a residual, and two columns each of base and candidates, of which the
/// last has no values.
FlightColumns three_records() {
  FlightColumns columns;
  columns.given = {10.0, nan, 30.0};
  columns.base.resize(3, 2);
  columns.base << 1.0F, 2.0F, 1.0F, 4.0F, 1.0F, 8.0F;
  columns.candidates = Eigen::MatrixXf::Constant(3, 2, 0.5F);
  columns.candidates.col(1).setConstant(static_cast<float>(nan));
  return columns;
}

TEST(SumOfColumns, EqualsColumnsTimesCoefficients) {
  EXPECT_THAT(sum_of_columns(three_records(), Eigen::Vector4d(1.0, 2.0, 4.0, 0.0)),
              testing::ElementsAre(7.0, 11.0, 19.0));
}

TEST(SumOfColumns, MissingValueOfAUsedColumnIsMissing) {
  for (const double value : sum_of_columns(three_records(), Eigen::Vector4d(1.0, 2.0, 4.0, 1.0)))
    EXPECT_TRUE(std::isnan(value));
}

TEST(ResidualAfter, IsTheGivenResidualMinusTheSum) {
  const std::vector<double> residual = residual_after(three_records(), Eigen::Vector4d(1.0, 2.0, 4.0, 0.0));
  EXPECT_EQ(residual[0], 3.0);
  EXPECT_TRUE(std::isnan(residual[1]));
  EXPECT_EQ(residual[2], 11.0);
}

}  // namespace
}  // namespace pcor::internal
