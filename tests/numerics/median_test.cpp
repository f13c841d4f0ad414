#include "numerics/median.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace pcor::internal {
namespace {

double by_order(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

TEST(Median, IsTheUpperMiddleValue) {
  EXPECT_TRUE(std::isnan(median({})));
  EXPECT_EQ(median({3.0}), 3.0);
  EXPECT_EQ(median({3.0, 1.0}), 3.0);
  EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median({4.0, 1.0, 2.0, 3.0}), 3.0);
}

TEST(Median, AgreesWithSortingForManyValues) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (const std::size_t count : {99U, 100U, 101U, 10000U, 100001U}) {
    std::vector<double> values(count);
    for (double& value : values) value = normal(random);
    EXPECT_EQ(median(values), by_order(values)) << count;
    for (double& value : values) value = std::round(value);
    EXPECT_EQ(median(values), by_order(values)) << count << " of which many are equal";
    std::fill(values.begin(), values.end(), 0.0);
    EXPECT_EQ(median(values), 0.0) << count << " that are all equal";
  }
}

TEST(Median, IgnoresMissingValues) {
  const double missing = std::nan("");
  EXPECT_TRUE(std::isnan(median({missing, missing})));
  EXPECT_EQ(median({missing, 2.0, missing, 1.0, 3.0}), 2.0);
  std::vector<double> values(2000, missing);
  for (std::size_t i = 0; i < values.size(); i += 2) values[i] = static_cast<double>(i);
  EXPECT_EQ(median(values), 1000.0);
}

}  // namespace
}  // namespace pcor::internal
