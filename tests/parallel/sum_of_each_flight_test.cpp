#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include <pcor/base/error.hpp>
#include "parallel/flight_partition.hpp"
#include "support/thread_team.hpp"

namespace pcor::internal {
namespace {

using test::run_with_communicator;
using ::testing::Each;

constexpr std::size_t count = 50;

FlightPartition share_of_many(Communicator& comm) {
  std::vector<std::uint64_t> sizes;
  for (std::size_t flight = 0; flight < count; ++flight) sizes.push_back(1 + flight * flight % 17);
  return {comm, sizes};
}

TEST(SumOfEachFlight, AddsInTheOrderOfFlights) {
  // Of numbers whose sum depends on their order.
  const auto part = [](std::size_t flight) {
    return std::ldexp(1.0 + 1.0 / static_cast<double>(1 + flight), static_cast<int>(flight * 7 % 60));
  };
  double expected = 0.0;
  for (std::size_t flight = 0; flight < count; ++flight) expected += part(flight);
  for (const std::size_t size : {1U, 2U, 5U}) {
    run_with_communicator(size, [&](Communicator& comm) {
      const FlightPartition share = share_of_many(comm);
      EXPECT_EQ(share.sum_of_each_flight<double>(part), expected);
    });
  }
  EXPECT_EQ(FlightPartition(0).sum_of_each_flight<double>(part), 0.0);
}

TEST(SumOfEachFlight, FailsOnAllMembers) {
  std::vector<int> failed(3, 0);
  run_with_communicator(3, [&](Communicator& comm) {
    try {
      share_of_many(comm).sum_of_each_flight<double>([](std::size_t flight) {
        if (flight == 41 || flight == 43) throw Error(Error::Code::file, "flight " + std::to_string(flight));
        return 1.0;
      });
    } catch (const Error& error) {
      if (std::string(error.what()) == "flight 41") ++failed[comm.rank()];
    }
  });
  EXPECT_THAT(failed, Each(1));
}

TEST(SumOfEachFlight, MatrixSumEqualsThatOfOneMember) {
  constexpr Eigen::Index width = 31;
  const auto part = [](std::size_t flight) {
    const Eigen::MatrixXd rows =
        Eigen::MatrixXd::NullaryExpr(3, width, [flight](Eigen::Index r, Eigen::Index c) {
          return std::sin(static_cast<double>(flight) + static_cast<double>(7 * r + c));
        });
    return Eigen::MatrixXd(rows.transpose() * rows);
  };
  const auto expected = FlightPartition(count).sum_of_each_flight<Eigen::MatrixXd>(part);
  for (const std::size_t size : {2U, 40U}) {
    run_with_communicator(size, [&](Communicator& comm) {
      EXPECT_EQ(share_of_many(comm).sum_of_each_flight<Eigen::MatrixXd>(part), expected);
    });
  }
}

TEST(SharesOfEntries, BelongToTheOwnersOfTheirFlights) {
  run_with_communicator(3, [](Communicator& comm) {
    const FlightPartition flights = share_of_many(comm);
    const std::vector<std::size_t> flight_of_each{4, 0, 4, 49, 7};
    const FlightPartition entries = flights.of_entries(flight_of_each);
    ASSERT_EQ(entries.flights(), flight_of_each.size());
    std::size_t own = 0;
    for (std::size_t entry = 0; entry < flight_of_each.size(); ++entry) {
      EXPECT_EQ(entries.is_local(entry), flights.is_local(flight_of_each[entry]));
      own += entries.is_local(entry) ? 1 : 0;
    }
    EXPECT_EQ(entries.local_count(), own);
  });
}

}  // namespace
}  // namespace pcor::internal
