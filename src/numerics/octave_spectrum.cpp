#include "numerics/octave_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <pcor/numerics/noise.hpp>
#include "numerics/windowed_transform.hpp"

namespace pcor::internal {
namespace {

constexpr std::size_t max_segment = 1024;  // samples
constexpr std::size_t min_segment = 64;
constexpr std::size_t min_segments = 8;

std::vector<std::size_t> segments_of(const std::vector<Segment>& segments, std::size_t length) {
  std::vector<std::size_t> begins;
  for (const Segment& segment : segments) {
    for (std::size_t begin = 0; begin + length <= segment.count; begin += length / 2)
      begins.push_back(segment.first + begin);
  }
  return begins;
}

}  // namespace

OctaveSpectrum octave_spectrum(const std::vector<double>& values, const std::vector<double>& time,
                               double step) {
  const std::vector<Segment> segments = contiguous_segments(values, time, step);
  std::size_t length = max_segment;
  std::vector<std::size_t> begins = segments_of(segments, length);
  while (begins.size() < min_segments && length > min_segment) begins = segments_of(segments, length /= 2);
  OctaveSpectrum spectrum;
  if (begins.size() < min_segments) return spectrum;
  // The variance at the frequencies k / (length step), both signs together.
  std::vector<double> variance(length / 2 + 1, 0.0);
  const auto count = static_cast<double>(begins.size());
  for (const std::size_t begin : begins) {
    const auto [amplitudes, power] = windowed_transform(&values[begin], length);
    for (std::size_t k = 1; k < variance.size(); ++k) {
      const double sides = k == length / 2 ? 1.0 : 2.0;
      variance[k] += sides * std::norm(amplitudes[k]) / (power * static_cast<double>(length) * count);
    }
  }
  // The first frequency contains the remainder of the subtracted line.
  for (std::size_t from = 2; from < variance.size();) {
    const std::size_t to = std::min(variance.size(), std::max(from + 1, from + from / 4));
    double sum = 0.0;
    for (std::size_t k = from; k < to; ++k) sum += variance[k];
    const double low = static_cast<double>(from) - 0.5;
    const double high = static_cast<double>(to) - 0.5;
    const double rms = std::sqrt(sum / std::log2(high / low));
    // Segments overlap by half and neighbouring frequencies share what Hann's window leaks.
    const auto frequencies = static_cast<double>(to - from);
    const double independent = count * frequencies / (frequencies > 1.0 ? 1.06 * 1.9 : 1.06);
    spectrum.period.push_back(static_cast<double>(length) * step / std::sqrt(low * high));
    spectrum.rms.push_back(rms);
    spectrum.error.push_back(0.5 * rms / std::sqrt(independent));
    from = to;
  }
  return spectrum;
}

}  // namespace pcor::internal
