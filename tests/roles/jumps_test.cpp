#include "roles/jumps.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "support/netcdf_file.hpp"

namespace pcor::internal {
namespace {

/// A climb with waves, 1 Hz.
std::vector<double> climb() {
  std::vector<double> height;
  for (int i = 0; i < 600; ++i) height.push_back(1000.0 + 8.0 * i + 20.0 * std::sin(0.1 * i));
  return height;
}

TEST(Jumps, TemporaryHeightExcursionIsFound) {
  std::vector<double> height = climb();
  for (const int i : {300, 301, 302}) height[static_cast<std::size_t>(i)] += 160.0 * (i - 299);
  const std::vector<double> time = test::sequence(1.4e9, height.size());
  const std::vector<Jump> jumps = find_jumps(height, time);
  ASSERT_EQ(jumps.size(), 1U);
  EXPECT_EQ(jumps[0].first, 300U);
  EXPECT_EQ(jumps[0].count, 3U);
  EXPECT_NEAR(jumps[0].size, 480.0, 10.0);
  mask(jumps, height);
  EXPECT_TRUE(std::isnan(height[301]));
  EXPECT_TRUE(std::isfinite(height[299]));
  EXPECT_TRUE(std::isfinite(height[303]));
}

TEST(Jumps, VelocityHasItsOwnMinimumRate) {
  std::vector<double> east(600, 80.0);
  east[300] += 15.0;
  const std::vector<double> time = test::sequence(1.4e9, east.size());
  EXPECT_TRUE(find_jumps(east, time).empty());
  const std::vector<Jump> jumps = find_jumps(east, time, min_velocity_rate);
  ASSERT_EQ(jumps.size(), 1U);
  EXPECT_EQ(jumps[0].first, 300U);
  EXPECT_EQ(jumps[0].count, 1U);
}

TEST(Jumps, AFlightWithoutJumpsGivesAnEmptyList) {
  EXPECT_TRUE(find_jumps(climb(), test::sequence(1.4e9, 600)).empty());
  EXPECT_TRUE(find_jumps({}, {}).empty());
}

}  // namespace
}  // namespace pcor::internal
