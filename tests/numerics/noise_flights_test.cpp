#include "numerics/noise_flights.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>
#include <vector>

namespace pcor::internal {
namespace {

std::vector<NoiseFlight> flights(std::size_t count) {
  std::vector<NoiseFlight> all;
  for (std::size_t f = 0; f < count; ++f)
    all.push_back({86400.0 * static_cast<double>(f), f % 2 == 0 ? 900U : 2U});
  return all;
}

TEST(NoiseFlights, FewFlightsAreAllUsed) {
  EXPECT_THAT(flights_for_noise(flights(3)), ::testing::ElementsAre(0, 1, 2));
  EXPECT_EQ(flights_for_noise(flights(16)).size(), 16U);
}

TEST(NoiseFlights, InformativeFlightsAreChosenFromMany) {
  for (const std::size_t count : {17U, 34U, 200U}) {
    const std::vector<NoiseFlight> all = flights(count);
    const std::vector<std::size_t> chosen = flights_for_noise(all);
    EXPECT_LE(chosen.size(), 16U);
    EXPECT_GE(chosen.size(), 8U);
    for (const std::size_t f : chosen) EXPECT_EQ(all[f].bins, 900U);
  }
}

TEST(NoiseFlights, FlightsWithoutBinsAreLeftOut) {
  std::vector<NoiseFlight> all = flights(7);
  for (const std::size_t f : {0U, 2U, 4U, 6U}) all[f].bins = 0;
  EXPECT_THAT(flights_for_noise(all, 6), ::testing::ElementsAre(1, 3, 5));
}

TEST(NoiseFlights, FewLongFlightsArePreferredToManyShortOnes) {
  std::vector<NoiseFlight> all = flights(12);
  for (const std::size_t f : {0U, 2U, 6U, 8U}) all[f].bins = 2;
  EXPECT_THAT(flights_for_noise(all, 6), ::testing::ElementsAre(4, 10));
}

TEST(NoiseFlights, ChoiceIsIndependentOfFlightOrder) {
  std::vector<NoiseFlight> all = flights(50);
  std::mt19937 chance(1);
  std::vector<double> begins;
  for (int order = 0; order < 5; ++order) {
    std::vector<double> now;
    for (const std::size_t f : flights_for_noise(all)) now.push_back(all[f].begin);
    std::sort(now.begin(), now.end());
    if (order > 0) {
      EXPECT_EQ(now, begins);
    }
    begins = now;
    std::shuffle(all.begin(), all.end(), chance);
  }
}

}  // namespace
}  // namespace pcor::internal
