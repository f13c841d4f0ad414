#pragma once

#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

namespace pcor::internal {

/// The probability that a chi-squared of `freedom` degrees exceeds `value`.
inline double chi_squared_tail(double value, double freedom) {
  if (!(value > 0.0)) return 1.0;
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(freedom), value));
}

/// The value that a chi-squared of one degree exceeds as rarely as one of `freedom` degrees exceeds `value`:
/// so scores of groups of any size can be compared.
inline double one_degree_equivalent(double value, double freedom) {
  if (freedom <= 1.0 || !(value > 0.0)) return value;
  // Beyond it tails are too small for a number; there the two differ by a logarithm only.
  constexpr double largest = 600.0;
  const double within = value < largest ? value : largest;
  const double tail = chi_squared_tail(within, freedom);
  const double equivalent =
      tail >= 1.0 ? 0.0 : boost::math::quantile(boost::math::complement(boost::math::chi_squared(1.0), tail));
  return equivalent + (value - within);
}

}  // namespace pcor::internal
