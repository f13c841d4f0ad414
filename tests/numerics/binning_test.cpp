// Means over bins, and outliers that are replaced before.
#include "numerics/binning.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "numerics/spikes.hpp"
#include "support/constants.hpp"

using namespace pcor::internal;
using pcor::test::missing;

namespace {

std::vector<double> seconds(std::size_t count, double step = 1.0) {
  std::vector<double> time(count);
  for (std::size_t i = 0; i < count; ++i) time[i] = 1321560000.0 + step * static_cast<double>(i);
  return time;
}

/// Noise of standard deviation `size` that remembers 0.6 of itself from one sample to the next.
std::vector<double> noise(std::size_t count, double size, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(count);
  double value = normal(engine);
  for (double& each : values) {
    each = size * value;
    value = 0.6 * value + 0.8 * normal(engine);
  }
  return values;
}

std::vector<double> without_outliers(const std::vector<double>& residual, std::size_t& count) {
  return pcor::internal::without_outliers(residual, std::vector<double>(residual.size(), 0.0),
                                          seconds(residual.size()), 1.0, count);
}

}  // namespace

TEST(Binning, BinsAreMeansOfFourSeconds) {
  std::vector<double> values(40);
  std::iota(values.begin(), values.end(), 0.0);
  const Binning bins(values, seconds(40), 1.0);
  ASSERT_EQ(bins.size(), 10U);
  ASSERT_EQ(bins.segments().size(), 1U);
  EXPECT_EQ(bins.segments()[0].count, 10U);
  const Eigen::VectorXd means = bins.means(values);
  for (std::size_t b = 0; b < 10; ++b) {
    EXPECT_EQ(means[static_cast<Eigen::Index>(b)], 4.0 * static_cast<double>(b) + 1.5);
    EXPECT_EQ(bins.time()[b], 1321560000.0 + 4.0 * static_cast<double>(b) + 1.5);
  }
}

TEST(Binning, EachRecordCountsOnce) {
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> uniform;
  std::vector<double> residual(997);
  std::vector<double> other(997);
  for (std::size_t i = 0; i < residual.size(); ++i) {
    residual[i] = uniform(engine) < 0.3 ? missing : uniform(engine);
    other[i] = uniform(engine);
  }
  const Binning bins(residual, seconds(997), 1.0);
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(bins.size()));
  double sum = 0.0;
  for (std::size_t k = 0; k < bins.records().size(); ++k) {
    EXPECT_FALSE(std::isnan(residual[bins.records()[k]]));
    sum += other[bins.records()[k]];
    counts[bins.bins()[k]] += 1.0;
  }
  // Rounding of a thousand additions.
  EXPECT_NEAR(bins.means(other).dot(counts), sum, 1e-10);
  EXPECT_GE(counts.minCoeff(), 2.0);
  EXPECT_LE(counts.maxCoeff(), 4.0);
}

TEST(Binning, CellLessThanHalfFullEndsASegment) {
  std::vector<double> residual(20, 1.0);
  residual[4] = residual[5] = missing;                   // half of the second cell is there
  residual[12] = residual[13] = residual[15] = missing;  // a quarter of the fourth
  const Binning bins(residual, seconds(20), 1.0);
  ASSERT_EQ(bins.size(), 4U);
  EXPECT_EQ(bins.time()[1], 1321560006.5);  // mean time of the records that are present
  ASSERT_EQ(bins.segments().size(), 2U);
  EXPECT_EQ(bins.segments()[0].count, 3U);
  EXPECT_EQ(bins.segments()[1].first, 3U);
  EXPECT_EQ(bins.segments()[1].count, 1U);
  for (const std::size_t record : bins.records()) EXPECT_NE(record, 14U);
}

TEST(Binning, TimeGapEndsASegment) {
  std::vector<double> time = seconds(40);
  for (std::size_t i = 20; i < 40; ++i) time[i] += 600.0;
  const Binning bins(std::vector<double>(40, 0.0), time, 1.0);
  ASSERT_EQ(bins.segments().size(), 2U);
  EXPECT_EQ(bins.segments()[0].count, 5U);
  EXPECT_EQ(bins.segments()[1].count, 5U);
}

// The differences over a minute that begin in one telescope into a difference of means of minutes.
TEST(Binning, BinsHaveTheRequestedLength) {
  const Binning bins(std::vector<double>(300, 0.0), seconds(300), 1.0, 60.0);
  EXPECT_EQ(bins.size(), 5U);
  EXPECT_EQ(bins.time()[1] - bins.time()[0], 60.0);
  EXPECT_EQ(bins.segments().size(), 1U);
}

TEST(Binning, IsEmptyForNoSamples) {
  EXPECT_EQ(Binning({}, {}, 1.0).size(), 0U);
  EXPECT_EQ(Binning(std::vector<double>(30, missing), seconds(30), 1.0).size(), 0U);
}

TEST(Binning, SlowRecordsAreNotAveraged) {
  const std::vector<double> values{1.0, 5.0, 2.0};
  const Binning bins(values, seconds(3, 10.0), 10.0);
  ASSERT_EQ(bins.size(), 3U);
  EXPECT_EQ(bins.segments().size(), 1U);
  EXPECT_EQ(bins.means(values)[1], 5.0);
}

TEST(Outliers, OnlySpikesAreReplaced) {
  const std::vector<double> clean = noise(3600, 0.2, 1);
  std::vector<double> residual = clean;
  std::size_t spikes = 0;
  for (std::size_t i = 50; i < residual.size(); i += 97, ++spikes)
    residual[i] += spikes % 2 == 0 ? 5.0 : -5.0;
  std::size_t count = 0;
  const std::vector<double> result = without_outliers(residual, count);
  // 4.5 deviations: 7e-6 of normal samples, so not one of 3600, except for the error of the level.
  EXPECT_GE(count, spikes);
  EXPECT_LE(count, spikes + 3);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    changed += result[i] != residual[i] ? 1 : 0;
    // A prediction replaces a spike, with the error of an innovation, 0.16, and four of them at most.
    EXPECT_NEAR(result[i], clean[i], 0.7) << i;
  }
  EXPECT_EQ(changed, count);
}

TEST(Outliers, LargeSmoothEffectIsNotAnOutlier) {
  std::vector<double> residual = noise(3600, 0.1, 2);
  // 4 hPa, forty times the noise, over a climb of five minutes and in pitch manoeuvres of 20 s.
  for (std::size_t i = 600; i < 900; ++i)
    residual[i] += 4.0 * std::pow(std::sin(M_PI * (static_cast<double>(i) - 600.0) / 300.0), 2);
  for (std::size_t i = 1800; i < 1960; ++i)
    residual[i] += 0.6 * std::sin(2.0 * M_PI * (static_cast<double>(i) - 1800.0) / 20.0);
  std::size_t count = 0;
  const std::vector<double> result = without_outliers(residual, count);
  EXPECT_LE(count, 3U);
  for (std::size_t i = 700; i < 800; ++i) EXPECT_NEAR(result[i], residual[i], 0.5) << i;
}

// A step is a sudden departure at its first sample, and a large value that its neighbours share from then
// on: the laser in cloud, flaps.
TEST(Outliers, OnlyTheEdgesOfAStepAreOutliers) {
  std::vector<double> residual = noise(3600, 0.1, 3);
  for (std::size_t i = 1000; i < 1060; ++i) residual[i] += 2.0;
  std::size_t count = 0;
  const std::vector<double> result = without_outliers(residual, count);
  EXPECT_LE(count, 10U);
  for (std::size_t i = 1010; i < 1050; ++i) EXPECT_EQ(result[i], residual[i]) << i;
}

// After a gap nothing is known: a value is not an outlier because it is not zero.
TEST(Outliers, FirstValueOfASegmentIsNotAnOutlier) {
  std::vector<double> residual = noise(3600, 0.1, 4);
  for (std::size_t i = 1000; i < 1100; ++i) residual[i] += 2.0;
  residual[999] = residual[1100] = missing;
  std::size_t count = 0;
  const std::vector<double> result = without_outliers(residual, count);
  EXPECT_LE(count, 10U);
  for (std::size_t i = 1010; i < 1100; ++i) EXPECT_EQ(result[i], residual[i]) << i;
}

TEST(Outliers, PredictedValuesAreNoOutliers) {
  std::vector<double> residual = noise(1200, 0.1, 5);
  std::vector<double> predicted(residual.size(), 0.0);
  for (std::size_t i = 500; i < 520; ++i) predicted[i] = 3.0;
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] += predicted[i];
  std::size_t count = 0;
  pcor::internal::without_outliers(residual, predicted, seconds(residual.size()), 1.0, count);
  EXPECT_LE(count, 1U);
}

TEST(Outliers, MissingValuesStayMissing) {
  std::vector<double> residual = noise(1200, 0.2, 6);
  for (std::size_t i = 0; i < residual.size(); i += 11) residual[i] = missing;
  residual[500] = 20.0;
  std::size_t count = 0;
  const std::vector<double> result = without_outliers(residual, count);
  for (std::size_t i = 0; i < result.size(); ++i) EXPECT_EQ(std::isnan(result[i]), std::isnan(residual[i]));
  EXPECT_LT(std::abs(result[500]), 1.0);
}
