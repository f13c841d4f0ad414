#include <gtest/gtest.h>
#include <pcor/fit/loss.hpp>

#include <array>

#include "fit/loss_function.hpp"

using namespace pcor;

namespace {

constexpr std::array<Loss, 2> losses{Loss::huber, Loss::none};

/// The weight of a sample that is that many deviations off, next to one of least squares.
double weight(Loss loss, double deviations) {
  constexpr double deviation = 0.4;
  return internal::ScaledLoss(loss, deviation)(deviations * deviation)[1];
}

TEST(Loss, IsFoundByItsName) {
  for (const Loss loss : losses) EXPECT_EQ(loss_named(to_string(loss)), loss) << to_string(loss);
  EXPECT_FALSE(loss_named("hubert"));
}

TEST(Loss, ReducesTheWeightOfOutliers) {
  for (const Loss loss : losses) {
    SCOPED_TRACE(to_string(loss));
    EXPECT_NEAR(weight(loss, 0.0), 1.0, 1e-12);
    if (loss == Loss::none) {
      EXPECT_EQ(weight(loss, 10.0), 1.0);
    } else {
      EXPECT_LT(weight(loss, 10.0), 0.5);
    }
  }
  EXPECT_EQ(weight(Loss::huber, 3.9), 1.0);
  EXPECT_LT(weight(Loss::huber, 4.1), 1.0);
}

TEST(Loss, ZeroDeviationGivesLeastSquares) {
  for (const Loss loss : losses) EXPECT_TRUE(internal::ScaledLoss(loss, 0.0).is_least_squares());
}

}  // namespace
