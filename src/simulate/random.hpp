#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace pcor::internal::simulate {

/// A stream of random numbers that depends on a seed and a name alone, so that each sensor has its own.
///
/// std::mt19937_64 is the same everywhere by the standard; std::normal_distribution is not, so the normal
/// numbers are made here.
class Random {
 public:
  Random(std::uint64_t seed, std::string_view name);

  /// Evenly distributed over (0, 1).
  double uniform();

  /// Normally distributed, mean 0, variance 1: Marsaglia's polar method.
  double normal();

 private:
  std::mt19937_64 engine_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

/// Normal process of mean 0, variance 1 and autocorrelation exp(-t/memory) (Ornstein-Uhlenbeck).
class Drift {
 public:
  Drift(std::uint64_t seed, std::string_view name);

  /// Value a step later; `kept` = exp(-step/memory) is its correlation with the previous one, 0 to below 1.
  double next(double kept);

 private:
  Random random_;
  double value_;
};

/// One component of turbulence along the path, with the spectrum of the inertial range
///
///     F(k) = alpha eps^(2/3) k^(-5/3),  alpha = 0.49 along the path, 4/3 of that across it
///
/// (one-sided, k in rad/m; Kolmogorov constant 1.5 of the three-dimensional spectrum), between wavelengths of
/// 3 km and 12 m; larger scales have no more energy. It is a sum of Ornstein-Uhlenbeck processes whose wave
/// numbers are a factor of 3 apart.
class Turbulence {
 public:
  Turbulence(std::uint64_t seed, const std::string& name, bool across);

  /// The value, m/s, after `distance` m of flight through air of dissipation rate `dissipation` m2/s3.
  double next(double distance, double dissipation);

 private:
  struct Scale {
    double wave_number;  // rad/m
    double deviation;    // m/s at a dissipation rate of 1 m2/s3
    Drift drift;
  };
  std::vector<Scale> scales_;
};

/// The variance of the mean of `count` successive values of a process of variance 1 that keeps `kept` of
/// itself from value to value.
double variance_of_mean(double kept, std::size_t count);

}  // namespace pcor::internal::simulate
