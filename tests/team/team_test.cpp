#include <pcor/team/team.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <pcor/words/error.hpp>
#include "support/thread_team.hpp"

namespace pcor {
namespace {

using test::run_as_team;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// What each member of a team comes to, as text.
template <class Work>
std::vector<std::string> each_of(std::size_t size, const Work& work) {
  std::vector<std::string> results(size);
  run_as_team(size, [&](Team& team) {
    try {
      results[team.rank()] = work(team);
    } catch (const Error& error) {
      results[team.rank()] = std::string("error: ") + error.what();
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

TEST(Team, GathersWhatAllHaveInTheOrderOfRanks) {
  const auto gather = [](Team& team) {
    const std::string first = joined(team.gather(std::string(team.rank(), 'x')));
    return first + joined(team.gather(std::string("\0\n", 2) + number(team.rank()), 7));
  };
  const std::string zero("\0\n", 2);
  EXPECT_THAT(each_of(3, gather), Each("<><x><xx><" + zero + "0><" + zero + "1><" + zero + "2>"));
  EXPECT_EQ(gather(alone()), "<><" + zero + "0>");
}

TEST(Team, FailsOnAllMembersWithTheErrorThatOneAloneWouldMeetFirst) {
  const auto work = [](Team& team) {
    if (team.rank() == 1) team.fail(Error(Error::Code::unit, "flight 5"), 6);
    if (team.rank() == 2) team.fail(Error(Error::Code::file, "flight 3"), 4);
    return joined(team.gather("part"));
  };
  EXPECT_THAT(each_of(4, work), Each("error: flight 3"));
}

TEST(Team, MayGoOnAfterAnErrorThatAllKnowOf) {
  const auto work = [](Team& team) {
    try {
      if (team.rank() == 1) team.fail(Error(Error::Code::unit, "no unit"), 1);
      team.gather("");
    } catch (const Error& error) {
      return joined(team.gather(error.code() == Error::Code::unit ? error.what() : "?"));
    }
    return std::string("no error");
  };
  EXPECT_THAT(each_of(3, work), Each("<no unit><no unit><no unit>"));
}

TEST(Team, ToldByTheLastWordsOfAMemberWhyNothingComesOfItAnyMore) {
  const auto work = [](Team& team) {
    if (team.rank() == 1) return "left: " + std::string(team.leave(Error("no memory"))->what());
    std::string said;
    for (int time = 0; time < 2; ++time) {
      try {
        team.gather("");
      } catch (const Error& error) {
        said += std::string(error.what()) + ", ";
      }
    }
    return "left: " + std::string(team.leave()->what());
  };
  EXPECT_THAT(each_of(3, work), Each("left: no memory"));
}

TEST(Team, LeavesWithoutAWordWhereAllAreDone) {
  const auto work = [](Team& team) {
    team.gather("");
    return team.leave() ? "error" : "done";
  };
  EXPECT_THAT(each_of(3, work), Each("done"));
  EXPECT_THAT(each_of(1, work), ElementsAre("done"));
}

TEST(Team, FailsWhereMembersComeToDifferentNumbersOrPlaces) {
  EXPECT_THAT(each_of(3, [](Team& team) { return joined(team.gather("", team.rank() / 2)); }),
              Each(HasSubstr("different numbers")));
  const auto stops_early = [](Team& team) {
    if (team.rank() > 0) team.gather("");
    const auto error = team.leave();
    return std::string(error ? error->what() : "done");
  };
  EXPECT_THAT(each_of(2, stops_early), Each(HasSubstr("different numbers")));
}

TEST(Team, OfOneIsSilent) {
  EXPECT_TRUE(run_as_team(1,
                          [](Team& team) {
                            team.gather("part");
                            EXPECT_THROW(team.fail(Error("wrong"), 0), Error);
                            EXPECT_STREQ(team.leave(Error("wrong"))->what(), "wrong");
                          })
                  .front()
                  .empty());
}

/// Members that come and go at random, fail at random, never wait for each other in vain: `run_as_team` fails
/// where they do.
TEST(Team, EndsForAllWhateverAnyMemberDoes) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const std::vector<std::string> ends = each_of(4, [seed](Team& team) {
      std::mt19937 chance(seed * 4 + static_cast<unsigned>(team.rank()));
      try {
        for (int step = 0; step < 6; ++step) {
          const auto luck = chance() % 20;
          if (luck == 0) team.fail(Error("failed"), chance() % 9);
          if (luck == 1) throw Error("unexpected");
          if (luck == 2) break;
          team.gather(std::string(luck, 'x'));
        }
      } catch (const Error& error) {
        return std::string(team.leave(error).value_or(error).what());
      }
      const auto error = team.leave();
      return std::string(error ? error->what() : "done");
    });
    // All end well, or none.
    EXPECT_EQ(std::count(ends.begin(), ends.end(), "done") % 4, 0) << joined(ends);
  }
}

}  // namespace
}  // namespace pcor
