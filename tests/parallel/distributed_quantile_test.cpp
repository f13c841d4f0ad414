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
  constexpr double infinity = std::numeric_limits<double>::infinity();
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

}  // namespace
}  // namespace pcor::internal
