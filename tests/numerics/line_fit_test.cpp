#include <gtest/gtest.h>
#include <pcor/numerics/line_fit.hpp>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

using pcor::LineFit;

namespace {

struct Pairs {
  std::vector<double> x;
  std::vector<double> y;
};

/// Points of y = 3 + 0.98 x with normal noise, from a fixed seed.
Pairs noisy(std::size_t count, double noise_x, double noise_y, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  Pairs pairs;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = 500.0 + 400.0 * static_cast<double>(i) / static_cast<double>(count);
    pairs.x.push_back(x + noise_x * normal(engine));
    pairs.y.push_back(3.0 + 0.98 * x + noise_y * normal(engine));
  }
  return pairs;
}

}  // namespace

TEST(LineFit, FindsAnExactLine) {
  const Pairs pairs = noisy(100, 0.0, 0.0, 1);
  for (const LineFit& fit : {pcor::ordinary_fit(pairs.x, pairs.y), pcor::orthogonal_fit(pairs.x, pairs.y)}) {
    EXPECT_NEAR(fit.slope, 0.98, 1e-12);
    EXPECT_NEAR(fit.offset, 3.0, 1e-9);  // rounding of values near 900
    EXPECT_NEAR(fit.rms, 0.0, 1e-5);     // the root of the rounding of squares
    EXPECT_EQ(fit.samples, 100U);
  }
}

TEST(LineFit, EqualNoiseFitIsSymmetricInVariables) {
  const Pairs pairs = noisy(2000, 5.0, 5.0, 2);
  const LineFit forth = pcor::orthogonal_fit(pairs.x, pairs.y);
  const LineFit back = pcor::orthogonal_fit(pairs.y, pairs.x);
  EXPECT_NEAR(forth.slope * back.slope, 1.0, 1e-12);
  EXPECT_NEAR(forth.rms, back.rms, 1e-9);
  EXPECT_NEAR(forth.offset, -back.offset / back.slope, 1e-8);
}

TEST(LineFit, OnlyOrthogonalFitIsUnbiasedWithNoiseInBoth) {
  // Noise of x flattens an ordinary fit by var(noise)/var(x) = 1600/13333 = 11 %.
  const Pairs pairs = noisy(20000, 40.0, 40.0, 3);
  const LineFit orthogonal = pcor::orthogonal_fit(pairs.x, pairs.y);
  EXPECT_NEAR(orthogonal.slope, 0.98, 4.0 * orthogonal.slope_error);
  EXPECT_NEAR(pcor::ordinary_fit(pairs.x, pairs.y).slope, 0.98 / (1.0 + 1600.0 / 13333.0), 0.01);
}

TEST(LineFit, StatesItsErrors) {
  // The spread over 400 repetitions is known to 1/sqrt(800) = 3.5 %; 15 % is four times that.
  std::vector<double> slopes;
  double stated = 0.0;
  for (unsigned seed = 10; seed < 410; ++seed) {
    const Pairs pairs = noisy(300, 2.0, 2.0, seed);
    const LineFit fit = pcor::orthogonal_fit(pairs.x, pairs.y);
    slopes.push_back(fit.slope);
    stated += fit.slope_error / 400.0;
  }
  double mean = 0.0;
  for (const double slope : slopes) mean += slope / 400.0;
  double variance = 0.0;
  for (const double slope : slopes) variance += (slope - mean) * (slope - mean) / 399.0;
  EXPECT_NEAR(std::sqrt(variance) / stated, 1.0, 0.15);
}

TEST(LineFit, IgnoresMissingValues) {
  Pairs pairs = noisy(100, 0.0, 0.0, 4);
  pairs.x[3] = std::numeric_limits<double>::quiet_NaN();
  pairs.y[7] = std::numeric_limits<double>::quiet_NaN();
  const LineFit fit = pcor::ordinary_fit(pairs.x, pairs.y);
  EXPECT_EQ(fit.samples, 98U);
  EXPECT_NEAR(fit.slope, 0.98, 1e-12);
  EXPECT_TRUE(std::isnan(pcor::ordinary_fit({1.0, 2.0}, {1.0, 2.0}).slope));
  EXPECT_TRUE(std::isnan(pcor::ordinary_fit({1.0, 1.0, 1.0}, {1.0, 2.0, 3.0}).slope));
}

TEST(PairMoments, CorrelationNeedsVariationOfBoth) {
  pcor::PairMoments pairs;
  pcor::PairMoments constant;
  const std::vector<double> swapped{2.0, 1.0, 4.0, 3.0};
  for (std::size_t i = 0; i < swapped.size(); ++i) {
    pairs.add(static_cast<double>(i), swapped[i]);
    constant.add(static_cast<double>(i), 1.0);
  }
  EXPECT_NEAR(pairs.correlation(), 0.6, 1e-15);  // rounding
  EXPECT_TRUE(std::isnan(constant.correlation()));
}

TEST(LineFit, FitOfPartsEqualsFitOfTheWhole) {
  const Pairs pairs = noisy(1000, 0.1, 0.1, 5);
  pcor::PairMoments parts[3];
  for (std::size_t i = 0; i < pairs.x.size(); ++i)
    parts[i < 10 ? 0 : i < 400 ? 1 : 2].add(pairs.x[i], pairs.y[i]);
  pcor::PairMoments sum;
  sum.add(pcor::PairMoments());
  for (const pcor::PairMoments& part : parts) sum.add(part);
  const LineFit whole = pcor::orthogonal_fit(pairs.x, pairs.y);
  const LineFit of_parts = pcor::orthogonal_fit(sum);
  EXPECT_EQ(of_parts.samples, whole.samples);
  EXPECT_NEAR(of_parts.slope, whole.slope, 1e-13);
  EXPECT_NEAR(of_parts.offset, whole.offset, 1e-10);
  // The squares of 0.1 are 1e-6 of those of x, which lose 1e-16 each.
  EXPECT_NEAR(of_parts.rms, whole.rms, 1e-9);
  EXPECT_NEAR(of_parts.mean_difference, whole.mean_difference, 1e-10);  // rounding of values near 900
}
