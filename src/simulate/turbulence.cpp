#include "simulate/turbulence.hpp"

#include <cmath>

namespace pcor::internal::simulate {

Turbulence::Turbulence(std::uint64_t seed, const std::string& name, bool across) {
  constexpr double longest = 3000.0;  // m
  constexpr double ratio = 3.0;
  constexpr double two_pi = 6.283185307179586;
  constexpr int count = 6;
  const double alpha = 0.49 * (across ? 4.0 / 3.0 : 1.0);
  // A process of wave number K and variance s^2 has F(k) = s^2 (2/pi) K/(K^2 + k^2). With s^2 = A K^(-2/3) at
  // wave numbers `ratio` apart the sum is 2 A k^(-5/3)/ln(ratio).
  const double scale = 0.5 * alpha * std::log(ratio);
  // The first component includes all larger scales: this factor is the sum of their spectra far above its
  // wave number.
  const double larger = 1.0 / (1.0 - std::cbrt(1.0 / ratio));
  double wave_number = two_pi / longest;
  for (int i = 0; i < count; ++i) {
    const double variance = scale * std::pow(wave_number, -2.0 / 3.0) * (i == 0 ? larger : 1.0);
    const double deviation = std::sqrt(variance);
    scales_.push_back({wave_number, deviation, Drift(seed, name + std::to_string(i))});
    wave_number *= ratio;
  }
}

double Turbulence::next(double distance, double dissipation) {
  double sum = 0.0;
  for (Scale& scale : scales_)
    sum += scale.deviation * scale.drift.next(std::exp(-scale.wave_number * distance));
  return std::cbrt(dissipation) * sum;
}

}  // namespace pcor::internal::simulate
