// Behaviour in a program that enables fast mathematics by a pragma, which the preprocessor cannot detect.
#include <gtest/gtest.h>

// The headers before the pragma keep NaN.
#include <pcor/model/model.hpp>

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("finite-math-only")
#define PCOR_LOSES_NAN
#endif

#include <pcor/realtime/loop.hpp>

namespace {

TEST(LostNan, LoopIsRefused) {
#ifndef PCOR_LOSES_NAN
  GTEST_SKIP() << "this compiler has no such pragma";
#endif
  pcor::Model model;
  model.effects = {{"static-constant", {0.004}}};
  std::string error;
  const auto loop = pcor::Loop::build(
      model, {pcor::Quantity::static_pressure, pcor::Quantity::dynamic_pressure}, 25.0, &error);
  EXPECT_FALSE(loop.has_value());
  EXPECT_NE(error.find("fast mathematics"), std::string::npos) << error;
}

}  // namespace
