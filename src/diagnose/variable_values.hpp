#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "parallel/flight_partition.hpp"

namespace pcor::internal {

/// Values of a variable on all flights of a team; each member has those of its local flights. Results do not
/// depend on the distribution of flights.
class VariableValues {
 public:
  /// @param values_of values of a local flight, NaN if missing
  VariableValues(const FlightPartition& share,
                 const std::function<std::vector<double>(std::size_t flight)>& values_of);

  std::size_t count() const { return count_; }      ///< finite values
  std::size_t missing() const { return missing_; }  ///< all others
  double minimum() const { return minimum_; }
  double maximum() const { return maximum_; }
  double mean() const { return mean_; }
  double deviation() const { return deviation_; }  ///< standard deviation

  /// Distinct values, ascending; if there are more than `maximum`, an incomplete list of more than `maximum`.
  std::vector<double> distinct(std::size_t maximum) const;

  /// Quantiles at equidistant ranks, including minimum and maximum.
  std::vector<double> quantiles(std::size_t number) const;

 private:
  FlightPartition share_;
  std::vector<std::vector<double>> values_;  // finite values of local flights
  std::size_t count_ = 0;
  std::size_t missing_ = 0;
  double minimum_ = 0.0;
  double maximum_ = 0.0;
  double mean_ = 0.0;
  double deviation_ = 0.0;
};

}  // namespace pcor::internal
