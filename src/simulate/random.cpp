#include "simulate/random.hpp"

#include <cmath>

#include "parallel/digest.hpp"

namespace pcor::internal::simulate {
namespace {

// FNV-1a over the name, started from the seed, then the finaliser of SplitMix64, which spreads every bit.
std::uint64_t stream_seed(std::uint64_t seed, std::string_view name) {
  std::uint64_t hash = digest_of(name, 0xcbf29ce484222325U ^ (seed * 0x9e3779b97f4a7c15U));
  hash = (hash ^ (hash >> 30U)) * 0xbf58476d1ce4e5b9U;
  hash = (hash ^ (hash >> 27U)) * 0x94d049bb133111ebU;
  return hash ^ (hash >> 31U);
}

}  // namespace

Random::Random(std::uint64_t seed, std::string_view name) : engine_(stream_seed(seed, name)) {}

double Random::uniform() {
  constexpr double step = 1.0 / 9007199254740992.0;  // 2^-53
  return (static_cast<double>(engine_() >> 11U) + 0.5) * step;
}

double Random::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  for (;;) {
    const double x = 2.0 * uniform() - 1.0;
    const double y = 2.0 * uniform() - 1.0;
    const double square = x * x + y * y;
    if (square >= 1.0 || square == 0.0) continue;
    const double factor = std::sqrt(-2.0 * std::log(square) / square);
    spare_ = y * factor;
    has_spare_ = true;
    return x * factor;
  }
}

Drift::Drift(std::uint64_t seed, std::string_view name) : random_(seed, name), value_(random_.normal()) {}

double Drift::next(double kept) {
  const double now = value_;
  value_ = kept * value_ + std::sqrt(1.0 - kept * kept) * random_.normal();
  return now;
}

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

double variance_of_mean(double kept, std::size_t count) {
  const auto n = static_cast<double>(count);
  double sum = n;
  double power = 1.0;
  for (std::size_t lag = 1; lag < count; ++lag) {
    power *= kept;
    sum += 2.0 * (n - static_cast<double>(lag)) * power;
  }
  return sum / (n * n);
}

}  // namespace pcor::internal::simulate
