#include "numerics/spectrum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

namespace {

using pcor::internal::octave_spectrum;
using pcor::internal::OctaveSpectrum;

constexpr double pi = 3.14159265358979323846;

std::vector<double> times(std::size_t count) {
  std::vector<double> time(count);
  for (std::size_t i = 0; i < count; ++i) time[i] = 1e9 + static_cast<double>(i);
  return time;
}

std::vector<double> white(std::size_t count) {
  std::mt19937 generator(8);
  std::normal_distribution<double> normal(0.0, 0.3);
  std::vector<double> values(count);
  for (double& value : values) value = normal(generator);
  return values;
}

TEST(OctaveSpectrum, WhiteNoiseFallsWithTheRootOfThePeriod) {
  const OctaveSpectrum spectrum = octave_spectrum(white(20000), times(20000), 1.0);
  ASSERT_GT(spectrum.period.size(), 10U);
  for (std::size_t i = 0; i < spectrum.period.size(); ++i) {
    // The variance is spread evenly up to half a cycle a sample: within an octave about f lies 2 f ln 2 of
    // it.
    const double expected = 0.3 * std::sqrt(2.0 * std::log(2.0) / spectrum.period[i]);
    // Four standard errors, and the few percent by which the middle of a band is not that of its power.
    EXPECT_NEAR(spectrum.rms[i], expected, 4.0 * spectrum.error[i] + 0.05 * expected) << spectrum.period[i];
    EXPECT_LT(spectrum.error[i], 0.2 * expected);
  }
}

TEST(OctaveSpectrum, WaveAppearsAtItsPeriod) {
  std::vector<double> values(20000);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = 0.2 * std::sin(2.0 * pi * static_cast<double>(i) / 24.0);
  const OctaveSpectrum spectrum = octave_spectrum(values, times(values.size()), 1.0);
  const auto maximum = std::max_element(spectrum.rms.begin(), spectrum.rms.end()) - spectrum.rms.begin();
  // Within a band of a third of an octave.
  EXPECT_NEAR(spectrum.period[static_cast<std::size_t>(maximum)], 24.0, 3.0);
}

TEST(OctaveSpectrum, UsesSegmentsBetweenGaps) {
  std::vector<double> values = white(6000);
  for (std::size_t i = 0; i < values.size(); i += 150) values[i] = std::numeric_limits<double>::quiet_NaN();
  const OctaveSpectrum spectrum = octave_spectrum(values, times(values.size()), 1.0);
  ASSERT_FALSE(spectrum.period.empty());
  EXPECT_LE(spectrum.period.front(), 128.0);  // the longest segment that fits between the gaps
  EXPECT_TRUE(octave_spectrum(white(200), times(200), 1.0).period.empty());
}

}  // namespace
