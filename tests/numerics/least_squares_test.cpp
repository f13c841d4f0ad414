// Least squares whose errors include the correlation of the noise.
#include "numerics/least_squares.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

using namespace pcor::internal;

namespace pcor {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

struct Series {
  std::vector<double> time, x, y;
};

/// y = 2 + 0.5 x with noise of rms one and a correlation time of about eight samples.
Series made(unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  Series series;
  const double keep = 0.8;
  double noise = normal(engine);
  for (int i = 0; i < 600; ++i) {
    series.time.push_back(i);
    series.x.push_back(std::sin(i / 40.0));
    series.y.push_back(2.0 + 0.5 * series.x.back() + noise);
    noise = keep * noise + std::sqrt(1.0 - keep * keep) * normal(engine);
  }
  return series;
}

TEST(LeastSquares, ErrorsIncludeAutocorrelation) {
  constexpr unsigned count = 300;
  unsigned slopes = 0;
  unsigned offsets = 0;
  unsigned independent = 0;
  for (unsigned seed = 1; seed <= count; ++seed) {
    const Series s = made(seed);
    const LeastSquares fit = least_squares({std::vector<double>(s.x.size(), 1.0), s.x}, s.y, s.time, 1.0);
    const Estimate slope = fit.coefficients[1];
    if (std::abs(fit.coefficients[0].value - 2.0) < 2.0 * fit.coefficients[0].error) ++offsets;
    if (std::abs(slope.value - 0.5) < 2.0 * slope.error) ++slopes;
    // As if the samples were independent: the mean square of the sine is one half.
    if (std::abs(slope.value - 0.5) < 2.0 * fit.rms / std::sqrt(300.0)) ++independent;
  }
  // 286 +- 3.6 of 300 for normal errors that are known; the noise is estimated.
  EXPECT_GE(slopes, 272U);
  EXPECT_GE(offsets, 272U);
  EXPECT_LT(independent, 210U);  // three times too small: it would hold for half of them
}

// Isolated records are outside the bins, and here they determine the slope: its error was 15 times too small.
TEST(LeastSquares, ErrorsIncludeIsolatedRecords) {
  constexpr unsigned count = 200;
  double squares = 0.0;
  for (unsigned seed = 1; seed <= count; ++seed) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> normal;
    Series s;
    for (int i = 0; i < 1200; ++i) {
      const bool is_isolated = i > 600 && i % 100 == 50;
      s.time.push_back(i);
      s.x.push_back(i <= 600 ? 0.01 * normal(engine) : (is_isolated ? 50.0 : nan_value));
      s.y.push_back(2.0 + 0.5 * s.x.back() + normal(engine));
    }
    const Estimate slope =
        least_squares({std::vector<double>(s.x.size(), 1.0), s.x}, s.y, s.time, 1.0).coefficients[1];
    squares += std::pow((slope.value - 0.5) / slope.error, 2) / count;
  }
  // 200 scores determine their rms to 5 %.
  EXPECT_NEAR(std::sqrt(squares), 1.0, 0.2);
}

TEST(LeastSquares, IgnoresMissingValues) {
  Series s = made(5);
  const LeastSquares all = mean_of(s.y, s.time, 1.0);
  s.y[7] = s.y[100] = nan_value;
  const LeastSquares less = mean_of(s.y, s.time, 1.0);
  EXPECT_EQ(less.samples, all.samples - 2);
  EXPECT_TRUE(std::isnan(less.residuals[7]));
  EXPECT_NEAR(less.coefficients[0].value, all.coefficients[0].value, 0.02);  // two of 600 of at most 4
}

TEST(LeastSquares, UndeterminedCoefficientsAreMissing) {
  const Series s = made(1);
  EXPECT_TRUE(std::isnan(least_squares({s.x, s.x}, s.y, s.time, 1.0).coefficients[0].value));
  EXPECT_TRUE(std::isnan(mean_of({1.0, 2.0}, {0.0, 1.0}, 1.0).coefficients[0].value));
  EXPECT_TRUE(std::isnan(mean_of({}, {}, 1.0).coefficients[0].value));
}

TEST(LeastSquares, EstimatesAreCombinedByTheirErrors) {
  const Estimate two = combined({{1.0, 0.1}, {1.1, 0.1}});
  EXPECT_NEAR(two.value, 1.05, 1e-12);
  EXPECT_NEAR(two.error, 0.1 / std::sqrt(2.0), 1e-12);
  // Ten errors apart, they are known no better than they scatter: half of their distance.
  EXPECT_NEAR(combined({{1.0, 0.1}, {2.0, 0.1}}).error, 0.5, 1e-12);
  EXPECT_NEAR(combined({{nan_value, 0.1}, {2.0, 0.1}}).value, 2.0, 1e-12);
  EXPECT_EQ(combined({{0.0, 0.0}, {0.0, 0.0}}).value, 0.0);  // a series without noise
  EXPECT_TRUE(std::isnan(combined({}).value));
}

}  // namespace
}  // namespace pcor
