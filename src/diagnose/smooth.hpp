#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "parallel/flight_partition.hpp"

namespace pcor::internal {

/// Finite values of a variable on all flights; every rank holds all of them, 8 bytes each.
/// Results do not depend on the distribution of flights.
struct VariableValues {
  /// @param values_of values of a local flight; values that are not finite are missing
  VariableValues(const FlightPartition& partition,
                 const std::function<std::vector<double>(std::size_t flight)>& values_of);

  /// Distinct values, ascending; if there are more than `max_count`, an incomplete list of more than
  /// `max_count`.
  std::vector<double> distinct(std::size_t max_count) const;

  /// Quantiles at equidistant ranks, including minimum and maximum.
  std::vector<double> quantiles(std::size_t number) const;

  std::vector<double> values{};  ///< all flights, in their order
  std::size_t missing = 0;
  // The following are zero without a value.
  double minimum = 0.0;
  double maximum = 0.0;
  double mean = 0.0;
  double deviation = 0.0;  ///< standard deviation
};

/// Functions of one variable that together standardize any smooth dependence on it, without a constant.
class Smooth {
 public:
  /// Quadratic splines with knots at the values, or one function per value if there are only a few. The first
  /// is the straight line.
  /// @param columns maximum number, at least 1
  static Smooth with_knots_at_values(const VariableValues& values, std::size_t columns);

  /// Quadratic splines with equidistant knots, for a curve that bends many times over the range of the
  /// values, independent of their density. The first function is the straight line.
  static Smooth with_even_knots(const VariableValues& values, std::size_t columns);

  /// Cosine and sine of an angle and of twice the angle. @param turn full turn in the unit of the angle
  static Smooth periodic(const VariableValues& values, double turn);

  /// Number of functions; 0 if the variable does not vary.
  std::size_t columns() const { return columns_; }
  /// Whether the first function is the straight line, centred and of unit deviation.
  bool has_line() const { return turn_ == 0.0; }
  double centre() const { return centre_; }
  double deviation() const { return deviation_; }

  /// The functions at one value.
  void evaluate(double value, double* out) const;

 private:
  /// Takes centre and deviation of the values. @return whether they vary
  bool standardize(const VariableValues& values);

  std::size_t columns_ = 0;
  double centre_ = 0.0;
  double deviation_ = 0.0;
  double turn_ = 0.0;             // full turn of an angle; 0 for other variables
  std::vector<double> levels_{};  // levels of a variable with few values
  std::vector<double> knots_{};   // density follows the values
  double first_ = 0.0;            // first equidistant knot
  double distance_ = 0.0;         // distance between equidistant knots
};

}  // namespace pcor::internal
