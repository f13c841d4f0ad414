#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>
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

  std::size_t count() const { return sums_.count; }      ///< finite values
  std::size_t missing() const { return sums_.missing; }  ///< all others
  double minimum() const { return sums_.minimum; }
  double maximum() const { return sums_.maximum; }
  double mean() const { return mean_; }
  double deviation() const { return deviation_; }  ///< standard deviation

  /// Distinct values, ascending; if there are more than `maximum`, an incomplete list of more than `maximum`.
  std::vector<double> distinct(std::size_t maximum) const;

  /// Quantiles at equidistant ranks, including minimum and maximum.
  std::vector<double> quantiles(std::size_t number) const;

 private:
  /// Sums over flights.
  struct Sums {
    std::size_t count = 0;
    std::size_t missing = 0;
    double sum = 0.0;
    double minimum = std::numeric_limits<double>::infinity();
    double maximum = -std::numeric_limits<double>::infinity();

    Sums& operator+=(const Sums& other) {
      count += other.count;
      missing += other.missing;
      sum += other.sum;
      minimum = std::min(minimum, other.minimum);
      maximum = std::max(maximum, other.maximum);
      return *this;
    }

    template <class Archive>
    void serialize(Archive& archive) {
      archive(count, missing, sum, minimum, maximum);
    }
  };

  FlightPartition share_;
  std::vector<std::vector<double>> values_;  // finite values of local flights
  Sums sums_{};
  double mean_ = 0.0;
  double deviation_ = 0.0;
};

}  // namespace pcor::internal
