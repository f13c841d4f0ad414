#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
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

/// The variance of the mean of `count` successive values of a process of variance 1 that keeps `kept` of
/// itself from value to value.
double variance_of_mean(double kept, std::size_t count);

}  // namespace pcor::internal::simulate
