#include "checks/redundant.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "support/many_seeds.hpp"
#include "support/nuisance.hpp"
#include "support/says.hpp"

// Two systems that measure one pressure: the errors of their difference and of the line through them know the
// drift of either.

using namespace pcor::internal;
using pcor::test::Nuisance;

namespace {

/// Three flights of two hours.
Redundant two_systems(unsigned seed, const Nuisance& nuisance) {
  Redundant both;
  for (unsigned flight = 0; flight < 3; ++flight) {
    std::vector<double> noise(7200, 0.0);
    std::mt19937_64 engine(3 * seed + flight);
    pcor::test::add_process(noise, engine, 0.05, 3.0);
    pcor::test::add_nuisance(noise, 1000 + 3 * seed + flight, nuisance);
    for (std::size_t i = 0; i < noise.size(); ++i) {
      const auto time = static_cast<double>(i);
      both.time.push_back(1e5 * flight + time);
      both.first.push_back(700.0 + 150.0 * std::sin(time / 900.0 + seed));
      both.second.push_back(both.first.back() + noise[i]);
    }
  }
  return both;
}

void expect_right(const Nuisance& nuisance, const std::string& what) {
  constexpr double size_that_matters = 0.15;  // hPa
  const std::size_t seeds = pcor::test::number_of_seeds();
  double difference = 0.0;
  double slope = 0.0;
  std::size_t inconsistent = 0;
  for (std::size_t s = 0; s < seeds; ++s) {
    const RedundantFit fit = fit_of(two_systems(static_cast<unsigned>(s), nuisance));
    difference += std::pow(fit.difference.value / fit.difference.error, 2) / static_cast<double>(seeds);
    slope += std::pow(fit.across.value / fit.across.error, 2) / static_cast<double>(seeds);
    for (const pcor::TestStatistic& number : test_statistics_of(fit, size_that_matters))
      if (number.verdict == pcor::CheckVerdict::inconsistent) ++inconsistent;
  }
  std::cout << what << ": rms of the scores of difference and slope " << std::sqrt(difference) << ", "
            << std::sqrt(slope) << ", inconsistent " << inconsistent << " of " << 2 * seeds << "\n";
  // Within 0.8 and 1.3, because three flights hardly determine the correlation time of a drift, and three
  // standard errors of the rms of this number of scores.
  const double chance = 3.0 / std::sqrt(2.0 * static_cast<double>(seeds));
  for (const double score : {std::sqrt(difference), std::sqrt(slope)}) {
    EXPECT_GT(score, 0.8 - chance) << what;
    EXPECT_LT(score, 1.3 + chance) << what;
  }
  // Three standard errors, of normal scores one in 370.
  EXPECT_LE(inconsistent, 2 + seeds / 40) << what;
}

}  // namespace

TEST(RedundantFitStudy, ErrorsIncludeDrift) {
  expect_right({}, "nothing");
  expect_right({0.15, 900.0}, "0.15 hPa, 900 s");
  expect_right({0.4, 3600.0}, "0.4 hPa, 3600 s");
  expect_right({0.0, 1.0, 0.05}, "1/f");
}

// In level flight the orthogonal line has any slope, and the ordinary one is too flat.
TEST(RedundantFit, LevelFlightShowsNoChangeOverTheRange) {
  const std::size_t seeds = pcor::test::number_of_seeds();
  std::size_t large = 0;
  for (std::size_t s = 0; s < seeds; ++s) {
    Redundant both;
    std::mt19937_64 engine(s);
    std::normal_distribution<double> noise(0.0, 0.05);
    for (int i = 0; i < 3600; ++i) {
      both.time.push_back(i);
      both.first.push_back(700.0 + noise(engine));
      both.second.push_back(700.0 + noise(engine));
    }
    const RedundantFit fit = fit_of(both);
    if (std::abs(fit.across.value) > 4.0 * fit.across.error) ++large;
    EXPECT_LT(std::abs(fit.across.value), 0.1);  // hPa; 0.35 hPa of range with a slope error of 0.03
  }
  EXPECT_EQ(large, 0U);  // four standard errors are one in 16,000
}

// Lags of the systems differ most near the take-off: five samples there must not decide the verdict.
TEST(RedundantFit, FewSamplesAtOneEndDoNotDecide) {
  Redundant both;
  std::mt19937_64 engine(1);
  std::normal_distribution<double> noise(0.0, 0.05);
  for (int i = 0; i < 3600; ++i) {
    const bool is_take_off = i < 5;
    both.time.push_back(i);
    both.first.push_back((is_take_off ? 988.0 : 765.0) + noise(engine));
    both.second.push_back(both.first.back() + (is_take_off ? 0.6 : 0.0) + noise(engine));
  }
  const RedundantFit fit = fit_of(both);
  constexpr double size_that_matters = 0.3;  // hPa
  for (const pcor::TestStatistic& number : test_statistics_of(fit, size_that_matters))
    EXPECT_EQ(number.verdict, pcor::CheckVerdict::consistent) << number.value;
}

/// A flight with two pairs of pressures, whose difference is noise.
CheckedFlight flight_of(std::size_t records, double step, double begin) {
  CheckedFlight result;
  std::mt19937_64 engine(records);
  std::normal_distribution<double> noise(0.0, 0.05);
  const auto samples = std::make_shared<pcor::FlightSamples>();
  samples->step = step;
  MeasuredPair one{"PSFD/QCF", {}, std::vector<double>(records, 60.0)};
  MeasuredPair two{"PSFRD/QCFR", {}, std::vector<double>(records, 60.0)};
  for (std::size_t i = 0; i < records; ++i) {
    const auto record = static_cast<double>(i);
    samples->time.push_back(begin + step * record);
    one.static_pressure.push_back(700.0 + 50.0 * std::sin(0.01 * record));
    two.static_pressure.push_back(one.static_pressure.back() + noise(engine));
  }
  result.air.samples = samples;
  result.air.flying.assign(records, true);
  result.measured = {one, two};
  return result;
}

TEST(TotalPressureCheck, OrderOfFlightsDoesNotDetermineTheRecordInterval) {
  const CheckedFlight few = flight_of(300, 5.0, 5e5);
  const CheckedFlight many = flight_of(2000, 1.0, 1e5);
  for (const CheckedFlights& flights : {CheckedFlights{few, many}, CheckedFlights{many, few}}) {
    EXPECT_THAT(check_total_pressure(flights).numbers, testing::Contains(testing::Pair("samples", 2000.0)));
  }
}

TEST(TotalPressureCheck, FlightsOfAnotherRecordIntervalAreNotUsed) {
  const auto check_with = [](double second_step) {
    return check_total_pressure({flight_of(1200, 1.0, 0.0), flight_of(1200, second_step, 1e5)});
  };
  const pcor::CheckResult result = check_with(2.0);
  EXPECT_THAT(result.numbers, testing::Contains(testing::Pair("samples", 1200.0)));
  EXPECT_THAT(result.notes, testing::Contains(pcor::test::Says("1 of 2 flights are not used")));
  EXPECT_THAT(check_with(1.0 + 1e-5).numbers, testing::Contains(testing::Pair("samples", 2400.0)))
      << "times are rounded";
}
