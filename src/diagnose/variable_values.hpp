#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "parallel/flight_partition.hpp"

namespace pcor::internal {

/// The values of a variable on all flights of a team, of which each member has those of its own: the same of
/// all, whoever has which.
class VariableValues {
 public:
  /// @param values_of an own flight, NaN where missing
  VariableValues(const FlightPartition& share,
                 const std::function<std::vector<double>(std::size_t flight)>& values_of);

  std::size_t count() const { return count_; }      ///< of finite values
  std::size_t missing() const { return missing_; }  ///< all others
  double least() const { return least_; }
  double most() const { return most_; }
  double mean() const { return mean_; }
  double deviation() const { return deviation_; }  ///< from the mean, root mean square

  /// Those that occur, in their order; if they are more than `most`, more than `most` of them.
  std::vector<double> distinct(std::size_t most) const;

  /// The values at so many places at even distances of their order, the least and the greatest among them.
  std::vector<double> quantiles(std::size_t places) const;

 private:
  FlightPartition share_;
  std::vector<std::vector<double>> values_;  // finite ones of own flights
  std::size_t count_ = 0;
  std::size_t missing_ = 0;
  double least_ = 0.0;
  double most_ = 0.0;
  double mean_ = 0.0;
  double deviation_ = 0.0;
};

}  // namespace pcor::internal
