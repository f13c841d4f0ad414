#include "parallel/flight_partition.hpp"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "support/error_of.hpp"
#include "support/thread_communicator.hpp"

namespace pcor::internal {
namespace {

using test::run_with_communicator;
using ::testing::Each;

/// Total weight of the flights of each rank.
std::vector<std::uint64_t> loads(std::size_t ranks, const std::vector<std::uint64_t>& sizes) {
  std::vector<std::uint64_t> load(ranks, 0);
  std::vector<int> owners(sizes.size(), 0);
  std::mutex counting;
  run_with_communicator(ranks, [&](Communicator& comm) {
    const FlightPartition partition(comm, sizes);
    EXPECT_EQ(partition.flights(), sizes.size());
    std::size_t local = 0;
    const std::lock_guard lock(counting);
    for (std::size_t flight = 0; flight < sizes.size(); ++flight) {
      if (!partition.is_local(flight)) continue;
      ++owners[flight];
      ++local;
      load[comm.rank()] += sizes[flight];
    }
    EXPECT_EQ(partition.local_count(), local);
  });
  EXPECT_THAT(owners, Each(1));
  return load;
}

TEST(FlightPartition, FlightsAreAssignedOnceWithBalancedLoad) {
  std::mt19937 chance(1);
  std::vector<std::uint64_t> sizes;
  for (int flight = 0; flight < 60; ++flight) sizes.push_back(1'000'000 + chance() % 9'000'000);
  const std::uint64_t all = std::accumulate(sizes.begin(), sizes.end(), std::uint64_t{0});
  for (const std::size_t ranks : {1, 2, 3, 7}) {
    const std::vector<std::uint64_t> load = loads(ranks, sizes);
    // Assignment by decreasing length is at most a third above the optimum (Graham 1969), far less for this
    // number of flights.
    EXPECT_LT(*std::max_element(load.begin(), load.end()),
              1.02 * static_cast<double>(all) / static_cast<double>(ranks));
  }
  EXPECT_EQ(loads(5, {3, 4}).size(), 5U);  // more ranks than flights
}

TEST(FlightPartition, DifferentFlightsOfRanksAreAnError) {
  std::vector<std::optional<Error>> errors(2);
  test::run_with_communicator(2, [&](Communicator& comm) {
    errors[comm.rank()] = test::error_of([&] {
      partition_flights(comm, {"a.nc", comm.rank() == 0 ? "b.nc" : "c.nc"});
    });
  });
  EXPECT_THAT(errors, Each(test::IsError(Error::Code::system)));
}

/// A part of everything that is sent.
struct Part {
  double number = 0.0;
  std::vector<Eigen::MatrixXd> matrices{};
  Eigen::VectorXd vector{};
  std::string text{};
  std::optional<int> option{};
  std::vector<bool> bits{};

  template <class Archive>
  void serialize(Archive& archive) {
    archive(number, matrices, vector, text, option, bits);
  }
};

Part part_of(std::size_t flight) {
  const auto n = static_cast<Eigen::Index>(flight);
  Part part;
  part.number = flight % 2 == 0 ? -0.0 : std::numeric_limits<double>::denorm_min();
  part.matrices = {Eigen::MatrixXd::Random(n, 3), Eigen::MatrixXd(0, n)};
  part.vector = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::quiet_NaN());
  part.text = std::string(flight, '\0');
  if (flight > 1) part.option = -7;
  part.bits.resize(flight, true);
  return part;
}

TEST(FlightPartition, GatheredPartsKeepBitsAndFlightOrder) {
  constexpr std::size_t flights = 7;
  std::vector<Part> alone_parts(flights);
  for (std::size_t flight = 0; flight < flights; ++flight) alone_parts[flight] = part_of(flight);
  for (const std::size_t ranks : {1, 2, 3, 11}) {
    run_with_communicator(ranks, [&](Communicator& comm) {
      const FlightPartition partition(comm, std::vector<std::uint64_t>(flights, 5));
      const auto parts =
          partition.all_gather_flights<Part>([&](std::size_t flight) { return alone_parts[flight]; });
      EXPECT_EQ(serialized(parts), serialized(alone_parts));
    });
  }
}

TEST(FlightPartition, ReportsTheErrorOfTheFirstFailedFlight) {
  std::vector<std::string> messages(3);
  run_with_communicator(3, [&](Communicator& comm) {
    const FlightPartition partition(comm, std::vector<std::uint64_t>(9, 1));
    try {
      partition.all_gather_flights<int>([](std::size_t flight) {
        if (flight % 4 == 3) throw Error(Error::Code::file, "flight " + std::to_string(flight));
        return 0;
      });
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::file);
      messages[comm.rank()] = error.what();
    }
  });
  EXPECT_THAT(messages, Each("flight 3"));
}

constexpr std::size_t many = 50;

FlightPartition partition_of_many(Communicator& comm) {
  std::vector<std::uint64_t> sizes;
  for (std::size_t flight = 0; flight < many; ++flight) sizes.push_back(1 + flight * flight % 17);
  return {comm, sizes};
}

TEST(AllReduceFlights, AddsInTheOrderOfFlights) {
  // Of numbers whose sum depends on their order.
  const auto part = [](std::size_t flight) {
    return std::ldexp(1.0 + 1.0 / static_cast<double>(1 + flight), static_cast<int>(flight * 7 % 60));
  };
  double expected = 0.0;
  for (std::size_t flight = 0; flight < many; ++flight) expected += part(flight);
  for (const std::size_t size : {1U, 2U, 5U}) {
    run_with_communicator(size, [&](Communicator& comm) {
      const FlightPartition partition = partition_of_many(comm);
      EXPECT_EQ(partition.all_reduce_flights<double>(part), expected);
      EXPECT_EQ(partition.all_reduce_flights<double>(part, 3), expected);
    });
  }
  EXPECT_EQ(FlightPartition(0).all_reduce_flights<double>(part), 0.0);
}

TEST(AllReduceFlights, FailsOnAllRanks) {
  const auto part = [](std::size_t flight) {
    if (flight == 41 || flight == 43) throw Error(Error::Code::file, "flight " + std::to_string(flight));
    return 1.0;
  };
  for (const std::size_t threads : {1U, 2U}) {
    std::vector<int> failed(3, 0);
    run_with_communicator(3, [&](Communicator& comm) {
      try {
        partition_of_many(comm).all_reduce_flights<double>(part, threads);
      } catch (const Error& error) {
        if (std::string(error.what()) == "flight 41") ++failed[comm.rank()];
      }
    });
    EXPECT_THAT(failed, Each(1));
  }
}

TEST(AllReduceFlights, MatrixSumEqualsThatOfOneMember) {
  constexpr Eigen::Index width = 31;
  const auto part = [](std::size_t flight) {
    const Eigen::MatrixXd rows =
        Eigen::MatrixXd::NullaryExpr(3, width, [flight](Eigen::Index r, Eigen::Index c) {
          return std::sin(static_cast<double>(flight) + static_cast<double>(7 * r + c));
        });
    return Eigen::MatrixXd(rows.transpose() * rows);
  };
  const auto expected = FlightPartition(many).all_reduce_flights<Eigen::MatrixXd>(part);
  for (const std::size_t size : {2U, 40U}) {
    run_with_communicator(size, [&](Communicator& comm) {
      EXPECT_EQ(partition_of_many(comm).all_reduce_flights<Eigen::MatrixXd>(part), expected);
    });
  }
}

TEST(PartitionOfEntries, BelongToTheOwnersOfTheirFlights) {
  run_with_communicator(3, [](Communicator& comm) {
    const FlightPartition flights = partition_of_many(comm);
    const std::vector<std::size_t> flight_of_each{4, 0, 4, 49, 7};
    const FlightPartition entries = flights.of_entries(flight_of_each);
    ASSERT_EQ(entries.flights(), flight_of_each.size());
    std::size_t local = 0;
    for (std::size_t entry = 0; entry < flight_of_each.size(); ++entry) {
      EXPECT_EQ(entries.is_local(entry), flights.is_local(flight_of_each[entry]));
      local += entries.is_local(entry) ? 1 : 0;
    }
    EXPECT_EQ(entries.local_count(), local);
  });
}

}  // namespace
}  // namespace pcor::internal
