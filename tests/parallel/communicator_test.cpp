#include <pcor/parallel/communicator.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <pcor/base/error.hpp>
#include "support/thread_communicator.hpp"

namespace pcor {
namespace {

using test::run_with_communicator;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::StartsWith;

/// Result of each rank, as text.
template <class Work>
std::vector<std::string> each_of(std::size_t size, const Work& work) {
  std::vector<std::string> results(size);
  run_with_communicator(size, [&](Communicator& comm) {
    try {
      results[comm.rank()] = work(comm);
    } catch (const Error& error) {
      results[comm.rank()] = std::string(to_string(error.code())) + ": " + error.what();
    }
  });
  return results;
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += "<" + part + ">";
  return text;
}

std::string number(std::size_t value) { return std::to_string(value); }

TEST(Communicator, GathersValuesInRankOrder) {
  const auto gather = [](Communicator& comm) {
    const std::string first = joined(comm.all_gather(std::string(comm.rank(), 'x')));
    return first + joined(comm.all_gather(std::string("\0\n", 2) + number(comm.rank()), 7));
  };
  const std::string zero("\0\n", 2);
  EXPECT_THAT(each_of(3, gather), Each("<><x><xx><" + zero + "0><" + zero + "1><" + zero + "2>"));
  EXPECT_EQ(gather(serial_communicator()), "<><" + zero + "0>");
}

TEST(Communicator, AllRanksFailWithTheEarliestError) {
  const auto work = [](Communicator& comm) {
    if (comm.rank() == 1) comm.fail(Error(Error::Code::unit, "flight 5"), 6);
    if (comm.rank() == 2) comm.fail(Error(Error::Code::file, "flight 3"), 4);
    return joined(comm.all_gather("part"));
  };
  EXPECT_THAT(each_of(4, work), Each("file: flight 3"));
}

TEST(Communicator, ContinuesAfterACommonError) {
  const auto work = [](Communicator& comm) {
    try {
      if (comm.rank() == 1) comm.fail(Error(Error::Code::unit, "no unit"), 1);
      comm.all_gather("");
    } catch (const Error& error) {
      return joined(comm.all_gather(error.code() == Error::Code::unit ? error.what() : "?"));
    }
    return std::string("no error");
  };
  EXPECT_THAT(each_of(3, work), Each("<no unit><no unit><no unit>"));
}

TEST(Communicator, LastMessageExplainsMemberFailure) {
  const auto work = [](Communicator& comm) {
    if (comm.rank() == 1)
      return "left: " + std::string(comm.finalize(Error(Error::Code::system, "no memory"))->what());
    std::string said;
    for (int time = 0; time < 2; ++time) {
      try {
        comm.all_gather("");
      } catch (const Error& error) {
        said += std::string(error.what()) + ", ";
      }
    }
    return "left: " + std::string(comm.finalize()->what());
  };
  EXPECT_THAT(each_of(3, work), Each("left: no memory"));
}

TEST(Communicator, FinishedRanksExitSilently) {
  const auto work = [](Communicator& comm) {
    comm.all_gather("");
    return comm.finalize() ? "error" : "done";
  };
  EXPECT_THAT(each_of(3, work), Each("done"));
  EXPECT_THAT(each_of(1, work), ElementsAre("done"));
}

TEST(Communicator, DifferentExchangesAreAnError) {
  EXPECT_THAT(each_of(3, [](Communicator& comm) { return joined(comm.all_gather("", comm.rank() / 2)); }),
              Each(StartsWith("system: ")));
  const auto stops_early = [](Communicator& comm) {
    if (comm.rank() > 0) comm.all_gather("");
    const auto error = comm.finalize();
    return std::string(error ? to_string(error->code()) : "done");
  };
  EXPECT_THAT(each_of(2, stops_early), Each(StartsWith("system")));
}

TEST(Communicator, OneMemberSendsNoMessage) {
  EXPECT_TRUE(run_with_communicator(1,
                                    [](Communicator& comm) {
                                      comm.all_gather("part");
                                      EXPECT_THROW(comm.fail(Error(Error::Code::usage, "wrong"), 0), Error);
                                      EXPECT_STREQ(comm.finalize(Error(Error::Code::usage, "wrong"))->what(),
                                                   "wrong");
                                    })
                  .front()
                  .empty());
}

/// Ranks that start, end and fail at random never wait for each other forever: otherwise
/// `run_with_communicator` fails.
TEST(Communicator, RandomFailuresCauseNoDeadlock) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const std::vector<std::string> ends = each_of(4, [seed](Communicator& comm) {
      std::mt19937 chance(seed * 4 + static_cast<unsigned>(comm.rank()));
      try {
        for (int step = 0; step < 6; ++step) {
          const auto luck = chance() % 20;
          if (luck == 0) comm.fail(Error(Error::Code::usage, "failed"), chance() % 9);
          if (luck == 1) throw Error(Error::Code::usage, "unexpected");
          if (luck == 2) break;
          comm.all_gather(std::string(luck, 'x'));
        }
      } catch (const Error& error) {
        return std::string(comm.finalize(error).value_or(error).what());
      }
      const auto error = comm.finalize();
      return std::string(error ? error->what() : "done");
    });
    // Either all ranks succeed or all fail.
    EXPECT_EQ(std::count(ends.begin(), ends.end(), "done") % 4, 0) << joined(ends);
  }
}

}  // namespace
}  // namespace pcor
