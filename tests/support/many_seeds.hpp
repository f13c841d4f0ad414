#pragma once

#include <cmath>
#include <cstdlib>
#include <string>

// Number of simulated flights of a study, and limits that depend on it. A correct program exceeds a limit
// with a probability of about 1e-4.

namespace pcor::test {

/// Number of seeds: 5, or the value of PCOR_SEEDS in the environment.
inline std::size_t number_of_seeds() {
  const char* requested = std::getenv("PCOR_SEEDS");
  return requested == nullptr ? 5 : std::stoul(requested);
}

/// Probability that a normal error is within two or three standard errors.
inline constexpr double within_two = 0.9545;
inline constexpr double within_three = 0.9973;

/// Minimum number of errors within limits, among `count` independent errors that are within limits with
/// `probability`. Fewer have a binomial probability below 1e-4.
inline std::size_t least_within(std::size_t count, double probability) {
  const auto n = static_cast<double>(count);
  double exactly = std::pow(probability, n);  // probability of `outside` errors
  double more = 1.0 - exactly;
  std::size_t outside = 0;
  for (; more > 1e-4; ++outside) {
    exactly *= (n - static_cast<double>(outside)) / (static_cast<double>(outside) + 1.0) *
               (1.0 - probability) / probability;
    more -= exactly;
  }
  return count - outside;
}

/// Relative tolerance of the standard deviation of `count` values: four times its standard error
/// 1/sqrt(2 (n - 1)).
inline double tolerance_of_spread(std::size_t count) {
  return 4.0 / std::sqrt(2.0 * (static_cast<double>(count) - 1.0));
}

}  // namespace pcor::test
