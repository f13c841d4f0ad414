#include "roles/fast_series.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

namespace {

using pcor::FastSeries;
using pcor::internal::rate_of;
using pcor::internal::signal_band_of;

constexpr double pi = 3.14159265358979323846;

std::vector<double> seconds(std::size_t count) {
  std::vector<double> time(count);
  for (std::size_t i = 0; i < count; ++i) time[i] = static_cast<double>(i);
  return time;
}

/// A wave of a period of 40 s and 1 unit, and white noise, `in_record` samples a second.
FastSeries wave(std::size_t records, std::size_t in_record, double noise) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  FastSeries series;
  series.in_record = in_record;
  for (std::size_t i = 0; i < records * in_record; ++i) {
    const double t = (static_cast<double>(i) + 0.5) / static_cast<double>(in_record);
    series.values.push_back(std::sin(2.0 * pi * t / 40.0) + noise * normal(engine));
  }
  return series;
}

/// Air that wanders: each step is independent, so the spectrum falls with the square of the frequency.
FastSeries wandering(std::size_t records) {
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal;
  FastSeries series;
  for (std::size_t i = 0; i < records; ++i)
    series.values.push_back((i == 0 ? 0.0 : series.values.back()) + normal(engine));
  return series;
}

double rms_of_difference(const std::vector<double>& found, double shift, double factor) {
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t i = 60; i + 60 < found.size(); ++i) {
    const double t = static_cast<double>(i) + 0.5;
    const double requested = factor * std::cos(2.0 * pi * (t - shift) / 40.0);
    squares += (found[i] - requested) * (found[i] - requested);
    count += 1.0;
  }
  return std::sqrt(squares / count);
}

// A ramp of 2 a second; with samples of another interval its rate would be another.
TEST(RateOf, UnevenRecordsGiveTheRightRateOrNoRate) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> early(-0.4, 0.4);
  std::vector<std::vector<double>> all{seconds(100), seconds(100), {}};
  for (int i = 0; i < 90; ++i) {
    all[0].push_back(all[0].back() + 0.25);
    all[1].push_back(all[1].back() + 1.2);
  }
  for (int i = 0; i < 500; ++i) all[2].push_back(i + early(engine));
  for (const std::vector<double>& time : all) {
    FastSeries ramp;
    for (const double each : time) ramp.values.push_back(2.0 * each);
    std::size_t found = 0;
    for (const double rate : rate_of(ramp, time, 1.0, 2.0)) {
      if (std::isnan(rate)) continue;
      EXPECT_NEAR(rate, 2.0, 0.25);  // two samples, the fewest, may be a tenth off and are even
      ++found;
    }
    EXPECT_EQ(found > 80, time.size() < 200);
  }
}

TEST(ShortestPeriod, NoiselessSeriesKeepsTheWholeBand) {
  EXPECT_EQ(signal_band_of(wandering(4000), seconds(4000), 1.0).min_period, 2.0);
}

TEST(ShortestPeriod, ExcludesNoisyPeriods) {
  // All of the wave is at 40 s; shorter periods are noise. Half an octave to either side is excluded.
  const double period = signal_band_of(wave(4000, 1, 0.3), seconds(4000), 1.0).min_period;
  EXPECT_GT(period, 8.0);
  EXPECT_LT(period, 40.0);
}

TEST(ShortestPeriod, FindsNoiseSeenOnlyAtHighRate) {
  const double period = signal_band_of(wave(2000, 25, 1.5), seconds(2000), 1.0).min_period;
  EXPECT_GT(period, 8.0);
  EXPECT_LT(period, 40.0);
}

TEST(ShortestPeriod, WideSamplingGivesTwoSampleIntervals) {
  const FastSeries series = wave(50, 1, 0.1);
  for (const double step : {16.0, 20.0, 60.0}) {
    std::vector<double> time = seconds(50);
    for (double& each : time) each *= step;
    EXPECT_EQ(signal_band_of(series, time, step).min_period, 2.0 * step);
  }
}

TEST(RateOfSeries, EqualsTheMeanDerivativeOverARecord) {
  for (const std::size_t in_record : {std::size_t{1}, std::size_t{5}, std::size_t{25}}) {
    const std::vector<double> rate = rate_of(wave(400, in_record, 0.0), seconds(400), 1.0, 2.0);
    // The mean of a cosine of 40 s over a second is 0.1 % less than its middle.
    EXPECT_LT(rms_of_difference(rate, 0.0, 2.0 * pi / 40.0), 3e-4) << in_record;
  }
}

TEST(RateOfSeries, DelayGivesTheMeanOverEarlierSeconds) {
  for (const double delay : {0.3, 1.0, 2.5, -1.5}) {
    const std::vector<double> rate = rate_of(wave(400, 1, 0.0), seconds(400), 1.0, 2.0, delay);
    // (sin(wt) - sin(w(t - s)))/s = 2 sin(ws/2)/s cos(w(t - s/2))
    const double factor = 2.0 * std::sin(pi * delay / 40.0) / delay;
    // The interpolation between samples has half a percent of ripple.
    EXPECT_LT(rms_of_difference(rate, 0.5 * delay, factor), 0.005 * 2.0 * pi / 40.0) << delay;
  }
}

TEST(RateOfSeries, EstimatedCutOffReducesNoise) {
  const FastSeries noisy = wave(4000, 1, 0.1);
  const std::vector<double> time = seconds(4000);
  const double whole = rms_of_difference(rate_of(noisy, time, 1.0, 2.0), 0.0, 2.0 * pi / 40.0);
  const double cut = rms_of_difference(rate_of(noisy, time, 1.0, signal_band_of(noisy, time, 1.0).min_period),
                                       0.0, 2.0 * pi / 40.0);
  EXPECT_LT(cut, 0.1 * whole);
}

// A dropout would affect the rates of its neighbours.
TEST(FastSeries, ImpossiblePressureIsMissing) {
  const pcor::test::TemporaryDirectory folder;
  {
    pcor::test::NetcdfMaker maker(folder.path() / "flight.nc");
    maker.time(pcor::test::sequence(0, 50));
    std::vector<double> pressure(50, 700.0);
    pressure[20] = 0.0;
    maker.series("PSFD", "hPa", pressure);
  }
  const FastSeries series =
      pcor::internal::read_fast(pcor::Flight(folder.path() / "flight.nc"),
                                {"PSFD", pcor::Quantity::static_pressure, pcor::UnitConversion()}, 1);
  EXPECT_TRUE(std::isnan(series.values[20]));
  EXPECT_EQ(series.values[19], 700.0);
}

TEST(RateOfSeries, GapsAreNotBridged) {
  FastSeries series;
  std::vector<double> time = seconds(60);
  for (std::size_t i = 0; i < 60; ++i) {
    series.values.push_back(i < 30 ? static_cast<double>(i) : 1000.0 - static_cast<double>(i));
    if (i >= 30) time[i] += 100.0;
  }
  const std::vector<double> rate = rate_of(series, time, 1.0, 2.0);
  for (std::size_t i = 0; i < 60; ++i) EXPECT_NEAR(rate[i], i < 30 ? 1.0 : -1.0, 1e-9) << i;
}

}  // namespace
