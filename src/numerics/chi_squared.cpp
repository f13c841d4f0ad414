#include "numerics/chi_squared.hpp"

#include <boost/math/distributions/chi_squared.hpp>

namespace pcor::internal {

double chi_squared_tail(double value, double degrees_of_freedom) {
  if (!(value > 0.0)) return 1.0;
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(degrees_of_freedom), value));
}

double chi_squared_value(double tail, double degrees_of_freedom) {
  return boost::math::quantile(boost::math::complement(boost::math::chi_squared(degrees_of_freedom), tail));
}

double chi2_one_dof(double value, double degrees_of_freedom) {
  if (degrees_of_freedom <= 1.0 || !(value > 0.0)) return value;
  // Beyond it tails are too small for a number; there the two differ by a logarithm only.
  constexpr double largest = 600.0;
  const double within = value < largest ? value : largest;
  const double tail = chi_squared_tail(within, degrees_of_freedom);
  const double equivalent = tail >= 1.0 ? 0.0 : chi_squared_value(tail, 1.0);
  return equivalent + (value - within);
}

}  // namespace pcor::internal
