#include "flight/current_input.hpp"

#include <gtest/gtest.h>

#include <chrono>
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
    { const CurrentInput again(outer); }
    EXPECT_FALSE(had_previous_input());
    {
      const CurrentInput second(inner);
      EXPECT_STREQ(current_input_path(), "inner.nc");
      EXPECT_TRUE(had_previous_input());
    }
    EXPECT_STREQ(current_input_path(), "outer.nc");
  }
  EXPECT_EQ(current_input_path(), nullptr);
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
