#include "parallel/in_a_copy.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <new>
#include <optional>
#include <string>
#include <vector>

namespace pcor::internal {
namespace {

using testing::ElementsAre;
using testing::Optional;
using testing::StrEq;

constexpr int max_seconds = 1;

/// "here" in the process that called it, otherwise "copy".
class Place {
 public:
  bool is_here() const { return ::getpid() == here_; }
  std::string operator()() const { return is_here() ? "here" : "copy"; }

 private:
  int here_ = ::getpid();
};

TEST(InACopy, ReturnsWhatTheWorkReturns) {
  const Place place;
  const auto results =
      in_a_copy(3, max_seconds, [&](std::size_t i) { return std::to_string(i) + " " + place(); });
  EXPECT_THAT(results,
              ElementsAre(Optional(StrEq("0 copy")), Optional(StrEq("1 copy")), Optional(StrEq("2 copy"))));
  EXPECT_TRUE(in_a_copy(0, max_seconds, [](std::size_t) { return ""; }).empty());
}

TEST(InACopy, ACrashTakesOneResultAlong) {
  const std::string most(10000, 'x');
  const auto results = in_a_copy(6, max_seconds, [&](std::size_t i) -> std::string {
    if (i == 0 || i == 2) std::raise(SIGSEGV);
    if (i == 3 || i == 5) std::abort();
    return most;
  });
  EXPECT_THAT(results, ElementsAre(std::nullopt, Optional(most), std::nullopt, std::nullopt, Optional(most),
                                   std::nullopt));
}

TEST(InACopy, CrashAffectsOnlyItsOwnCopy) {
  static bool is_spoilt = false;
  const auto results = in_a_copy(3, max_seconds, [](std::size_t i) -> std::string {
    if (is_spoilt) std::abort();
    is_spoilt = i == 0;
    return "whole";
  });
  EXPECT_THAT(results, testing::Each(Optional(StrEq("whole"))));
}

TEST(InACopy, WhatNoCrashEndsIsDoneHere) {
  const Place place;
  for (const int signal : {SIGKILL, SIGTERM}) {
    const auto results = in_a_copy(2, max_seconds, [&](std::size_t i) {
      if (i == 0 && !place.is_here()) std::raise(signal);
      return place();
    });
    EXPECT_THAT(results, ElementsAre(Optional(StrEq("here")), Optional(StrEq("copy"))));
  }
  const auto too_long =
      in_a_copy(1, max_seconds, [&](std::size_t) { return place() + std::string(10001, '.'); });
  EXPECT_THAT(too_long.front(), Optional(testing::StartsWith("here")));
}

TEST(InACopy, WhatIsThrownIsThrownHere) {
  const auto throws = [](std::size_t i) -> std::string {
    if (i == 1) throw std::bad_alloc();
    return "";
  };
  EXPECT_THROW(in_a_copy(3, max_seconds, throws), std::bad_alloc);
}

volatile std::sig_atomic_t handled = 0;

// A copy must not run the program's cleanup on termination, such as the removal of unfinished files.
TEST(InACopy, HasNoHandlersOfSignalsAndIgnoresWhatIsIgnored) {
  const Place place;
  const auto stop = std::signal(SIGTERM, [](int) { handled = 1; });
  const auto hang_up = std::signal(SIGHUP, SIG_IGN);
  const auto results = in_a_copy(2, max_seconds, [&](std::size_t i) {
    if (!place.is_here()) std::raise(i == 0 ? SIGTERM : SIGHUP);
    return place();
  });
  std::signal(SIGTERM, stop);
  std::signal(SIGHUP, hang_up);
  EXPECT_THAT(results, ElementsAre(Optional(StrEq("here")), Optional(StrEq("copy"))));
  EXPECT_EQ(handled, 0);
}

TEST(InACopy, WorkWithoutEndHasOne) {
  const auto results = in_a_copy(2, max_seconds, [](std::size_t i) {
    for (volatile int forever = 0; i == 0;) forever = forever + 1;
    return std::string("done");
  });
  EXPECT_THAT(results, ElementsAre(std::nullopt, Optional(StrEq("done"))));
}

}  // namespace
}  // namespace pcor::internal
