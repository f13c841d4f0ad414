#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "simulate/random.hpp"

namespace pcor::internal::simulate {

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

}  // namespace pcor::internal::simulate
