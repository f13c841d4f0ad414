#include "team/in_a_copy.hpp"

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

TEST(InACopy, SaysWhatTheWorkSays) {
  const int here = ::getpid();
  const auto said = in_a_copy(
      3, [here](std::size_t i) { return std::to_string(i) + (::getpid() == here ? " here" : " in a copy"); });
  EXPECT_THAT(said, ElementsAre(Optional(StrEq("0 in a copy")), Optional(StrEq("1 in a copy")),
                                Optional(StrEq("2 in a copy"))));
  EXPECT_TRUE(in_a_copy(0, [](std::size_t) { return ""; }).empty());
}

TEST(InACopy, ACrashTakesOneAnswerAlong) {
  const auto said = in_a_copy(6, [](std::size_t i) -> std::string {
    if (i == 0 || i == 2) std::raise(SIGSEGV);
    if (i == 3) std::abort();
    if (i == 5) ::_exit(0);
    return std::string(100000, 'x') + std::to_string(i);
  });
  EXPECT_THAT(said, ElementsAre(std::nullopt, Optional(std::string(100000, 'x') + "1"), std::nullopt,
                                std::nullopt, Optional(std::string(100000, 'x') + "4"), std::nullopt));
}

TEST(InACopy, WhatIsThrownIsThrownHere) {
  const auto throws = [](std::size_t i) -> std::string {
    if (i == 1) throw std::bad_alloc();
    return "";
  };
  EXPECT_THROW(in_a_copy(3, throws), std::bad_alloc);
}

// What the program does where it is stopped, as to remove what is unfinished, a copy must not do.
volatile std::sig_atomic_t handled = 0;

TEST(InACopy, KnowsNoHandlersOfSignals) {
  const auto before = std::signal(SIGTERM, [](int) { handled = 1; });
  const auto said = in_a_copy(2, [](std::size_t i) {
    if (i == 0) std::raise(SIGTERM);
    return std::string(handled == 0 ? "unhandled" : "handled");
  });
  std::signal(SIGTERM, before);
  EXPECT_THAT(said, ElementsAre(std::nullopt, Optional(StrEq("unhandled"))));
}

TEST(InACopy, WorkWithoutEndHasOne) {
  const auto said = in_a_copy(2, [](std::size_t i) {
    for (volatile int forever = 0; i == 0;) forever = forever + 1;
    return std::string("done");
  });
  EXPECT_THAT(said, ElementsAre(std::nullopt, Optional(StrEq("done"))));
}

}  // namespace
}  // namespace pcor::internal
