#include "flight/current_input.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

namespace pcor::internal {
namespace {

TEST(CurrentInput, IsTheLastFileRead) {
  const std::filesystem::path outer = "outer.nc", inner = "inner.nc";
  EXPECT_EQ(current_input_path(), nullptr);
  EXPECT_EQ(current_input_seconds(), 0.0);
  {
    const CurrentInput first(outer);
    EXPECT_STREQ(current_input_path(), "outer.nc");
    {
      const CurrentInput second(inner);
      EXPECT_STREQ(current_input_path(), "inner.nc");
    }
    EXPECT_STREQ(current_input_path(), "outer.nc");
  }
  EXPECT_EQ(current_input_path(), nullptr);
}

TEST(CurrentInputDeathTest, OnlyAnotherFileIsAPreviousInput) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";  // a new process: other tests have read other files
  const std::filesystem::path one = "one.nc", two = "two.nc";
  const auto read = [&] {
    { const CurrentInput first(one); }
    { const CurrentInput again(one); }
    const bool had_by_same = had_previous_input();
    const CurrentInput other(two);
    std::exit(!had_by_same && had_previous_input() ? 0 : 1);
  };
  EXPECT_EXIT(read(), testing::ExitedWithCode(0), "");
}

TEST(CurrentInput, MeasuresItsProcessingTime) {
  const std::filesystem::path path = "flight.nc";
  const CurrentInput current(path);
  const double before = current_input_seconds();
  EXPECT_GE(before, 0.0);
  while (current_input_seconds() < before + 0.01) {
  }
  const CurrentInput again(path);
  EXPECT_LT(current_input_seconds(), 0.01) << "restarted";
}

TEST(CurrentInput, WaitingBeginsWhenProcessingStops) {
  EXPECT_EQ(seconds_of_waiting(), 0.0);
  const std::filesystem::path path = "flight.nc";
  const CurrentInput current(path);
  while (current_input_seconds() < 0.15) {
  }
  EXPECT_LT(seconds_of_waiting(), 0.01);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_GE(seconds_of_waiting(), 0.2);
}

}  // namespace
}  // namespace pcor::internal
