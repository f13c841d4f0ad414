#include <gmock/gmock.h>
#include <pcor/numerics/noise.hpp>

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "support/constants.hpp"

// Series with known autocovariance.

using pcor::NoiseFloor;
using pcor::Segment;
using pcor::test::missing;

namespace {

std::vector<double> seconds_from_zero(std::size_t count) {
  std::vector<double> time(count);
  std::iota(time.begin(), time.end(), 0.0);
  return time;
}

/// Noise of standard deviation 1 whose correlation over k samples is memory^k.
std::vector<double> first_order(std::size_t count, double memory, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(count);
  double value = normal(engine);
  for (double& each : values) {
    each = value;
    value = memory * value + std::sqrt(1.0 - memory * memory) * normal(engine);
  }
  return values;
}

std::vector<Segment> whole(const std::vector<double>& values) {
  return pcor::contiguous_segments(values, seconds_from_zero(values.size()), 1.0);
}

}  // namespace

TEST(Segments, EndAtMissingValuesAndGaps) {
  const std::vector<double> values{1, 2, missing, 3, 4, 5, missing, missing, 6};
  std::vector<double> time = seconds_from_zero(values.size());
  time[5] += 10;
  for (std::size_t i = 6; i < time.size(); ++i) time[i] += 10;
  const std::vector<Segment> segments = pcor::contiguous_segments(values, time, 1.0);
  ASSERT_EQ(segments.size(), 4U);
  EXPECT_EQ(segments[1].first, 3U);
  EXPECT_EQ(segments[1].count, 2U);
  EXPECT_EQ(segments[2].first, 5U);
  EXPECT_EQ(segments[3].count, 1U);
}

TEST(Segments, EndWhereTimeDoesNotIncrease) {
  // Two flights one after another, the earlier one last, and a constant time.
  const std::vector<Segment> segments =
      pcor::contiguous_segments({1, 2, 3, 4, 5, 6}, {100, 101, 20, 21, 22, 22}, 1.0);
  ASSERT_EQ(segments.size(), 3U);
  EXPECT_EQ(segments[1].first, 2U);
  EXPECT_EQ(segments[1].count, 3U);
  EXPECT_EQ(segments[2].first, 5U);
}

TEST(RobustDeviation, IsRobustAgainstOutliers) {
  std::vector<double> values = first_order(20000, 0.0, 1);
  for (std::size_t i = 0; i < values.size(); i += 5) values[i] = 1000.0;
  // A fifth of outliers moves the median of |x| to the 0.625 quantile of the rest: 1.316 instead of 1.
  EXPECT_NEAR(pcor::robust_standard_deviation(values), 1.316, 0.03);
  EXPECT_TRUE(std::isnan(pcor::robust_standard_deviation({missing, missing})));
}

// Over 20,000 samples of white noise a robust level errs by about 1.6/sqrt(40,000) = 0.8 %; 4 % is five
// times that. With memory there are fewer independent samples.
TEST(NoiseFloor, EqualsTheRmsOfWhiteNoise) {
  const std::vector<double> values = first_order(20000, 0.0, 2);
  const NoiseFloor floor = pcor::noise_floor(values, seconds_from_zero(values.size()), 1.0);
  EXPECT_NEAR(floor.rms, 1.0, 0.04);
  EXPECT_NEAR(floor.autocorrelation_time, 1.0, 0.15);
}

TEST(NoiseFloor, EstimatesTheAutocorrelationTime) {
  for (const double memory : {0.5, 0.8}) {
    const std::vector<double> values = first_order(50000, memory, 3);
    const NoiseFloor floor = pcor::noise_floor(values, seconds_from_zero(values.size()), 1.0);
    const double expected = (1.0 + memory) / (1.0 - memory);
    EXPECT_NEAR(floor.rms, 1.0, 0.08) << memory;
    EXPECT_NEAR(floor.autocorrelation_time, expected, 0.25 * expected) << memory;
  }
}

TEST(NoiseFloor, ExcludesSlowChanges) {
  std::vector<double> values = first_order(7200, 0.5, 4);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] += 5.0 * std::sin(2.0 * M_PI * static_cast<double>(i) / 1200.0);
  // Over 16 s the sine changes by at most 0.42, which adds 2 % to a difference of variance 2.
  EXPECT_NEAR(pcor::noise_floor(values, seconds_from_zero(values.size()), 1.0).rms, 1.0, 0.1);
}

TEST(NoiseFloor, ExcludesOutliers) {
  std::vector<double> values = first_order(7200, 0.5, 5);
  for (std::size_t i = 0; i < values.size(); i += 20) values[i] += 30.0;
  // A tenth of the differences has an outlier: the median of |x| moves to the 0.556 quantile, 1.13 times.
  EXPECT_NEAR(pcor::noise_floor(values, seconds_from_zero(values.size()), 1.0).rms, 1.13, 0.1);
}

TEST(NoiseFloor, FollowsAChangingLevel) {
  std::vector<double> values = first_order(7200, 0.3, 6);
  for (std::size_t i = 3600; i < values.size(); ++i) values[i] *= 4.0;
  const NoiseFloor floor = pcor::noise_floor(values, seconds_from_zero(values.size()), 1.0);
  EXPECT_NEAR(floor.rms, std::sqrt(0.5 * (1.0 + 16.0)), 0.25);
  // Brought by 15 % towards the whole, which lies between the two levels: 1 to 4^0.15 = 1.23.
  EXPECT_NEAR(std::accumulate(floor.local_rms.begin(), floor.local_rms.begin() + 3600, 0.0) / 3600.0, 1.12,
              0.15);
  EXPECT_NEAR(std::accumulate(floor.local_rms.begin() + 3600, floor.local_rms.end(), 0.0) / 3600.0, 3.6, 0.5);
}

TEST(NoiseFloor, IsEstimatedFromShortSegments) {
  std::vector<double> values = first_order(7200, 0.0, 12);
  for (std::size_t i = 0; i < values.size(); i += 7) values[i] = missing;
  EXPECT_NEAR(pcor::noise_floor(values, seconds_from_zero(values.size()), 1.0).rms, 1.0, 0.05);
}

TEST(NoiseFloor, TooFewSamplesGiveNan) {
  const std::vector<double> values = first_order(20, 0.0, 7);
  EXPECT_TRUE(std::isnan(pcor::noise_floor(values, seconds_from_zero(values.size()), 1.0).rms));
}

TEST(Autoregression, EstimatesASecondOrderProcess) {
  // Poles 0.5 +- 0.5i: stationary, and with a correlation that turns negative.
  std::mt19937_64 engine(8);
  std::normal_distribution<double> normal;
  std::vector<double> values(20000, 0.0);
  for (std::size_t i = 2; i < values.size(); ++i)
    values[i] = values[i - 1] - 0.5 * values[i - 2] + 0.3 * normal(engine);
  const std::vector<double> found = pcor::autoregression(values, whole(values));
  // The standard error of each coefficient is sqrt((1 - 0.25)/20000) = 0.006; higher orders may join in by
  // chance.
  ASSERT_GE(found.size(), 2U);
  EXPECT_NEAR(found[0], 1.0, 0.03);
  EXPECT_NEAR(found[1], -0.5, 0.03);
}

TEST(Autoregression, OrderIsLimited) {
  std::mt19937_64 engine(8);
  std::normal_distribution<double> normal;
  std::vector<double> values(20000, 0.0);  // depends on the values one and six steps before
  for (std::size_t i = 6; i < values.size(); ++i)
    values[i] = 0.4 * values[i - 1] + 0.4 * values[i - 6] + normal(engine);
  EXPECT_GE(pcor::autoregression(values, whole(values)).size(), 6U);
  EXPECT_LE(pcor::autoregression(values, whole(values), 5).size(), 5U);
}

TEST(Autoregression, GapsDoNotBiasTheEstimate) {
  std::vector<double> values = first_order(20000, 0.7, 9);
  for (std::size_t i = 100; i < values.size(); i += 101) values[i] = missing;
  const std::vector<double> found = pcor::autoregression(values, whole(values));
  ASSERT_GE(found.size(), 1U);
  EXPECT_NEAR(found[0], 0.7, 0.03);
}

TEST(Autoregression, IsEmptyForNoSamples) {
  EXPECT_TRUE(pcor::autoregression({}, {}).empty());
  const std::vector<double> zeros(100, 0.0);
  EXPECT_TRUE(pcor::autoregression(zeros, whole(zeros)).empty());
}
