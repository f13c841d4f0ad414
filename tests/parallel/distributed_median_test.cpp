#include "parallel/distributed_median.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "support/thread_team.hpp"

namespace pcor::internal {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The values distributed at random to the given number of members.
double of_team(std::size_t members, const std::vector<double>& values) {
  std::mt19937 chance(7);
  std::vector<std::vector<double>> dealt(members);
  for (const double value : values) dealt[chance() % members].push_back(value);
  std::vector<double> found(members);
  const auto sent = test::run_with_communicator(members, [&](Communicator& comm) {
    found[comm.rank()] = median_of_absolute_values(comm, dealt[comm.rank()]);
  });
  for (const double each : found) EXPECT_TRUE(each == found.front() || std::isnan(found.front()));
  for (const auto& member : sent) EXPECT_LE(member.size(), 8U);
  return found.front();
}

TEST(MedianOfAll, EqualsTheMedianOfOneList) {
  std::mt19937 chance(3);
  std::normal_distribution<double> normal;
  std::vector<double> values{0.0,    -0.0,    nan,  -std::numeric_limits<double>::infinity(),
                             5e-324, -5e-324, 1e300};
  for (int count = 0; count < 300; ++count) {
    const double alone = of_team(1, values);
    for (const std::size_t members : {2, 5}) EXPECT_EQ(of_team(members, values), alone) << values.size();
    values.push_back(count % 5 == 0 ? values[chance() % values.size()]
                                    : std::ldexp(normal(chance), count % 40 - 20));
  }
}

TEST(MedianOfAll, IsTheUpperMiddleValue) {
  EXPECT_EQ(of_team(3, {-4.0, 1.0, 2.0, 3.0}), 3.0);
  EXPECT_EQ(of_team(3, {-4.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(of_team(4, {-0.25}), 0.25);
}

TEST(MedianOfAll, IsMissingForEmptyLists) {
  EXPECT_TRUE(std::isnan(of_team(3, {})));
  EXPECT_TRUE(std::isnan(of_team(3, {nan, nan})));
}

}  // namespace
}  // namespace pcor::internal
