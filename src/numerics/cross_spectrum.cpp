#include "numerics/cross_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <unsupported/Eigen/FFT>

#include <pcor/numerics/noise.hpp>
#include "numerics/missing.hpp"
#include "numerics/windowed_transform.hpp"

namespace pcor::internal {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr std::size_t segment_length = 256;  // samples
constexpr double by_chance = 0.05;

/// Powers and the product of two series at one frequency, or the sums of these over several.
struct Sums {
  double first = 0.0;
  double second = 0.0;
  std::complex<double> product{};  // the first times the conjugate of the second
  double count = 0.0;
  double frequencies = 1.0;

  Sums& operator+=(const Sums& other) {
    first += other.first;
    second += other.second;
    product += other.product;
    count += other.count;
    return *this;
  }
  double coherence() const {
    return first > 0.0 && second > 0.0 ? std::min(1.0, std::norm(product) / (first * second)) : 0.0;
  }
  /// Number of independent products in the sums. Segments overlap by half, and neighbouring frequencies share
  /// the leakage of Hann's window.
  double independent() const { return count / (frequencies > 1.0 ? 1.06 * 1.9 : 1.06); }
  /// Whether two series that do not know of each other reach that coherence too rarely.
  bool is_coherent() const {
    return independent() > 1.0 && coherence() > 1.0 - std::pow(by_chance, 1.0 / (independent() - 1.0));
  }
};

std::vector<double> differences(const std::vector<double>& values, const std::vector<double>& time,
                                double step) {
  std::vector<double> result(values.size(), nan);
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (time[i] > time[i - 1] && time[i] - time[i - 1] < 1.5 * step) result[i] = values[i] - values[i - 1];
  }
  return result;
}

/// At each frequency k / (segment_length step), k = 0 to segment_length / 2.
std::vector<Sums> sums_of(const std::vector<double>& first, const std::vector<double>& second,
                          const std::vector<double>& time, double step) {
  const std::vector<double> a = differences(first, time, step);
  const std::vector<double> b = differences(second, time, step);
  std::vector<double> both(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) both[i] = a[i] + b[i];
  std::vector<Sums> sums(segment_length / 2 + 1);
  for (const Segment& segment : contiguous_segments(both, time, step)) {
    for (std::size_t begin = 0; begin + segment_length <= segment.count; begin += segment_length / 2) {
      const WindowedTransform of_a = windowed_transform(&a[segment.first + begin], segment_length);
      const WindowedTransform of_b = windowed_transform(&b[segment.first + begin], segment_length);
      for (std::size_t k = 0; k < sums.size(); ++k) {
        sums[k] += {std::norm(of_a.amplitudes[k]), std::norm(of_b.amplitudes[k]),
                    of_a.amplitudes[k] * std::conj(of_b.amplitudes[k]), 1.0};
      }
    }
  }
  return sums;
}

/// Delay, in samples, that the phases of neighbouring frequencies have in common: after its removal a band
/// can be summed without cancellation of its phases.
double common_delay(const std::vector<Sums>& sums) {
  std::complex<double> turn{};
  for (std::size_t k = 1; k + 2 < sums.size(); ++k) turn += sums[k + 1].product * std::conj(sums[k].product);
  return -std::arg(turn) * segment_length / (2.0 * pi);
}

/// Sums the impulse response, which lies around time zero, up to a step.
void find_step(const std::vector<Sums>& sums, double step, CrossSpectrum& spectrum) {
  constexpr double longest = 20.0;  // s, before and after
  std::vector<std::complex<double>> response(segment_length);
  for (std::size_t k = 0; k < sums.size(); ++k) {
    const std::complex<double> gain = k == 0                  ? 1.0
                                      : sums[k].is_coherent() ? sums[k].product / sums[k].second
                                                              : 0.0;
    response[k] = k == segment_length / 2 ? gain.real() : gain;
    if (k > 0) response[segment_length - k] = std::conj(response[k]);
  }
  std::vector<std::complex<double>> impulse;
  Eigen::FFT<double> fourier;
  fourier.inv(impulse, response);
  double sum = 0.0;
  const auto half = static_cast<std::ptrdiff_t>(segment_length / 2);
  for (std::ptrdiff_t n = -half; n < half; ++n) {
    sum += impulse[static_cast<std::size_t>((n + 2 * half) % (2 * half))].real();
    if (std::abs(static_cast<double>(n) * step) > longest) continue;
    spectrum.time.push_back(static_cast<double>(n) * step);
    spectrum.step.push_back(sum);
  }
}

}  // namespace

CrossSpectrum cross_spectrum(const std::vector<double>& first, const std::vector<double>& second,
                             const std::vector<double>& time, double step) {
  const std::vector<Sums> sums = sums_of(first, second, time, step);
  CrossSpectrum spectrum;
  if (sums[1].count == 0.0) return spectrum;
  const double common = common_delay(sums);
  for (std::size_t from = 2; from + 1 < sums.size();) {
    const auto to = std::min(sums.size() - 1, std::max(from + 1, from + from / 4));
    Sums band;
    band.frequencies = static_cast<double>(to - from);
    for (std::size_t k = from; k < to; ++k) {
      band += sums[k];
      band.product += sums[k].product *
                      (std::polar(1.0, 2.0 * pi * static_cast<double>(k) * common / segment_length) - 1.0);
    }
    const double frequency = 0.5 * static_cast<double>(from + to - 1) / (segment_length * step);
    const double coherence = band.coherence();
    const double phase_error = std::sqrt((1.0 - coherence) / (2.0 * band.independent() * coherence));
    const bool coherent = band.is_coherent();
    spectrum.period.push_back(1.0 / frequency);
    spectrum.coherence.push_back(coherence);
    spectrum.delay.push_back(coherent ? common * step - std::arg(band.product) / (2.0 * pi * frequency)
                                      : nan);
    spectrum.delay_error.push_back(coherent ? phase_error / (2.0 * pi * frequency) : nan);
    from = to;
  }
  find_step(sums, step, spectrum);
  return spectrum;
}

}  // namespace pcor::internal
