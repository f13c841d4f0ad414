#include "parallel/distributed_quantile.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "support/thread_team.hpp"

namespace pcor::internal {
namespace {

using test::run_with_communicator;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(OrderOfAll, EqualsTheOrderOfOneListForEachPartition) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  std::vector<double> values(1001);
  for (double& value : values) value = std::exp(20.0 * normal(engine)) * normal(engine);
  values[3] = values[700] = values[701] = 0.0;
  values[4] = -0.0;
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const std::vector<std::uint64_t> indices{0, 1, 250, 499, 500, 1000, 1000};
  for (const std::size_t size : {1U, 2U, 3U}) {
    run_with_communicator(size, [&](Communicator& comm) {
      std::vector<double> own;  // the last member has no values
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (i * i % std::max<std::size_t>(size - 1, 1) == comm.rank()) own.push_back(values[i]);
      }
      const std::vector<double> found = values_at(comm, own, [&](std::uint64_t count) {
        EXPECT_EQ(count, values.size());
        return indices;
      });
      ASSERT_EQ(found.size(), indices.size());
      for (std::size_t k = 0; k < indices.size(); ++k) EXPECT_EQ(found[k], sorted[indices[k]]);
    });
  }
}

TEST(OrderOfAll, AcceptsInfinitiesAndEmptyLists) {
  run_with_communicator(2, [&](Communicator& comm) {
    const std::vector<double> own =
        comm.rank() == 0 ? std::vector<double>{infinity, -2.0} : std::vector<double>{-infinity};
    EXPECT_THAT(values_at(comm, own,
                          [](std::uint64_t) {
                            return std::vector<std::uint64_t>{0, 1, 2};
                          }),
                ElementsAre(-infinity, -2.0, infinity));
    EXPECT_THAT(values_at(comm, {}, [](std::uint64_t) { return std::vector<std::uint64_t>(); }), IsEmpty());
  });
}

/// The values distributed at random to the given number of members.
double of_team(std::size_t members, const std::vector<double>& values) {
  std::mt19937 chance(7);
  std::vector<std::vector<double>> dealt(members);
  for (const double value : values) dealt[chance() % members].push_back(value);
  std::vector<double> found(members);
  const auto sent = run_with_communicator(members, [&](Communicator& comm) {
    found[comm.rank()] = median_of_absolute_values(comm, dealt[comm.rank()]);
  });
  for (const double each : found) EXPECT_TRUE(each == found.front() || std::isnan(found.front()));
  for (const auto& member : sent) EXPECT_LE(member.size(), 8U);
  return found.front();
}

TEST(MedianOfAll, EqualsTheMedianOfOneList) {
  std::mt19937 chance(3);
  std::normal_distribution<double> normal;
  std::vector<double> values{0.0, -0.0, nan, -infinity, 5e-324, -5e-324, 1e300};
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
