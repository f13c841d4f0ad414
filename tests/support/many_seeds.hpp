#pragma once

#include <cmath>
#include <cstdlib>
#include <string>

// Number of flights of studies over many simulated flights, and the resulting limits. A correct program
// exceeds a limit with a probability of about 1e-4.

namespace pcor::test {

/// Number of seeds: 10, or the value of PCOR_SEEDS in the environment.
inline std::size_t number_of_seeds() {
  const char* requested = std::getenv("PCOR_SEEDS");
  return requested == nullptr ? 10 : std::stoul(requested);
}

/// The probabilities that a normal error is within two and three standard errors.
inline constexpr double within_two = 0.9545;
inline constexpr double within_three = 0.9973;

/// The fewest of `count` independent errors that must be within limits which each keeps with `probability`:
/// the largest number that fewer keep with a binomial probability below 1e-4.
inline std::size_t least_within(std::size_t count, double probability) {
  const auto n = static_cast<double>(count);
  double exactly = std::pow(probability, n);  // the probability that `outside` are
  double more = 1.0 - exactly;
  std::size_t outside = 0;
  for (; more > 1e-4; ++outside) {
    exactly *= (n - static_cast<double>(outside)) / (static_cast<double>(outside) + 1.0) *
               (1.0 - probability) / probability;
    more -= exactly;
  }
  return count - outside;
}

/// Permitted difference of the spread of `count` values from the true one, as a share of it: four times its
/// standard error 1/sqrt(2 (n - 1)).
inline double tolerance_of_spread(std::size_t count) {
  return 4.0 / std::sqrt(2.0 * (static_cast<double>(count) - 1.0));
}

}  // namespace pcor::test
