#include "numerics/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

#include <pcor/numerics/line_fit.hpp>

namespace pcor::internal {

Periodogram periodogram(const double* values, std::size_t count) {
  constexpr double pi = 3.14159265358979323846;
  std::vector<double> positions(count);
  for (std::size_t i = 0; i < count; ++i) positions[i] = static_cast<double>(i);
  const LineFit line = ordinary_fit(positions, std::vector<double>(values, values + count));
  Periodogram result;
  std::vector<double> windowed(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double window = 0.5 - 0.5 * std::cos(2.0 * pi * (positions[i] + 0.5) / static_cast<double>(count));
    windowed[i] = window * (values[i] - line.offset - line.slope * positions[i]);
    result.window += window * window;
  }
  Eigen::FFT<double> fourier;
  std::vector<std::complex<double>> amplitudes;
  fourier.fwd(amplitudes, windowed);
  for (std::size_t k = 0; k <= count / 2; ++k) {
    const double signs = k == 0 || k == count / 2 ? 1.0 : 2.0;
    result.squares.push_back(signs * std::norm(amplitudes[k]));
  }
  return result;
}

std::vector<std::size_t> overlapping_parts(const std::vector<Segment>& segments, std::size_t length) {
  std::vector<std::size_t> begins;
  for (const Segment& segment : segments) {
    for (std::size_t begin = 0; begin + length <= segment.count; begin += length / 2)
      begins.push_back(segment.first + begin);
  }
  return begins;
}

OctaveSpectrum octave_spectrum(const std::vector<double>& values, const std::vector<double>& time,
                               double step) {
  constexpr std::size_t max_segment = 1024;  // samples
  constexpr std::size_t min_segment = 64;
  constexpr std::size_t min_segments = 8;
  const std::vector<Segment> segments = contiguous_segments(values, time, step);
  std::size_t length = max_segment;
  std::vector<std::size_t> begins = overlapping_parts(segments, length);
  while (begins.size() < min_segments && length > min_segment)
    begins = overlapping_parts(segments, length /= 2);
  OctaveSpectrum spectrum;
  if (begins.size() < min_segments) return spectrum;
  // The variance at the frequencies k / (length step), both signs together.
  std::vector<double> variance(length / 2 + 1, 0.0);
  const auto count = static_cast<double>(begins.size());
  for (const std::size_t begin : begins) {
    const auto [squares, window] = periodogram(&values[begin], length);
    for (std::size_t k = 1; k < variance.size(); ++k)
      variance[k] += squares[k] / (window * static_cast<double>(length) * count);
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
