#include "numerics/cross_spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

namespace {

using pcor::internal::cross_spectrum;
using pcor::internal::CrossSpectrum;

constexpr double pi = 3.14159265358979323846;

std::vector<double> white(std::size_t count, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(count);
  for (double& value : values) value = normal(generator);
  return values;
}

// As of airspeeds, whose differences are all but white.
std::vector<double> red(std::size_t count, unsigned seed) {
  std::vector<double> values = white(count, seed);
  for (std::size_t i = 1; i < count; ++i) values[i] += 0.98 * values[i - 1];
  return values;
}

std::vector<double> times(std::size_t count, double step) {
  std::vector<double> time(count);
  for (std::size_t i = 0; i < count; ++i) time[i] = 1e9 + step * static_cast<double>(i);
  return time;
}

TEST(CrossSpectrum, FindsADelayAtAllPeriods) {
  constexpr std::size_t count = 8000;
  constexpr double step = 0.5;
  const std::vector<double> source = red(count + 3, 1);
  const std::vector<double> noise = red(count, 2);
  std::vector<double> late(count), early(count);
  for (std::size_t i = 0; i < count; ++i) {
    early[i] = source[i + 3];
    late[i] = source[i] + 0.3 * noise[i];
  }
  const CrossSpectrum found = cross_spectrum(late, early, times(count, step), step);
  ASSERT_GT(found.period.size(), 10U);
  for (std::size_t k = 0; k < found.period.size(); ++k) {
    // 1 / (1 + 0.3^2), within the error of about 60 segments times frequencies.
    EXPECT_NEAR(found.coherence[k], 0.917, 0.05) << found.period[k];
    if (found.period[k] < 3.2)
      continue;  // half a period of a wave and less: the phase is known except for a full turn
    EXPECT_NEAR(found.delay[k], 1.5, 4.0 * found.delay_error[k] + 0.02) << found.period[k];
    EXPECT_LT(found.delay_error[k], 0.1 * found.period[k]);
  }
  for (std::size_t k = 0; k < found.time.size(); ++k)
    EXPECT_NEAR(found.step[k], found.time[k] < 1.25 ? 0.0 : 1.0, 0.1) << found.time[k];
}

// y follows x by tau dy/dt + y = x, exactly for an x that is held over a sample.
TEST(CrossSpectrum, LagHasLessDelayAtShortPeriods) {
  constexpr std::size_t count = 40000;
  constexpr double tau = 4.0;
  const std::vector<double> source = red(count, 3);
  std::vector<double> lagging(count);
  double y = 0.0;
  const double kept = std::exp(-1.0 / tau);
  for (std::size_t i = 0; i < count; ++i) lagging[i] = y = kept * y + (1.0 - kept) * source[i];
  const CrossSpectrum found = cross_spectrum(lagging, source, times(count, 1.0), 1.0);
  for (std::size_t k = 0; k < found.period.size(); ++k) {
    if (found.period[k] < 5.0) continue;
    const double omega = 2.0 * pi / found.period[k];
    // The phase of (1 - a) / (1 - a exp(-i omega)); bands are up to a quarter of their period wide.
    const double phase = std::atan2(kept * std::sin(omega), 1.0 - kept * std::cos(omega));
    EXPECT_NEAR(found.delay[k], phase / omega, 4.0 * found.delay_error[k] + 0.03 * phase / omega);
    EXPECT_GT(found.coherence[k], 0.97);
  }
  for (std::size_t k = 0; k < found.time.size(); ++k) {
    const double expected = found.time[k] < -0.5 ? 0.0 : 1.0 - std::pow(kept, found.time[k] + 1.0);
    EXPECT_NEAR(found.step[k], expected, 0.05) << found.time[k];
  }
}

TEST(CrossSpectrum, UnrelatedSeriesHaveNoCoherence) {
  const CrossSpectrum found = cross_spectrum(white(8000, 4), white(8000, 5), times(8000, 1.0), 1.0);
  std::size_t delays = 0;
  for (std::size_t k = 0; k < found.period.size(); ++k) {
    EXPECT_LT(found.coherence[k], 0.2);
    if (std::isfinite(found.delay[k])) ++delays;
  }
  EXPECT_LE(delays, found.period.size() / 4) << "one in twenty by chance";
}

TEST(CrossSpectrum, IsEmptyForTooFewSamples) {
  EXPECT_TRUE(cross_spectrum(white(200, 6), white(200, 7), times(200, 1.0), 1.0).period.empty());
  EXPECT_TRUE(cross_spectrum({}, {}, {}, 1.0).period.empty());
  std::vector<double> pierced = white(2000, 8);
  for (std::size_t i = 0; i < pierced.size(); i += 100) pierced[i] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(cross_spectrum(pierced, white(2000, 9), times(2000, 1.0), 1.0).period.empty());
}

}  // namespace
