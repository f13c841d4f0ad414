#pragma once

#include <cmath>
#include <vector>

#include "parallel/flight_partition.hpp"

namespace pcor::internal {

/// Sum of squares of some values, without NaN; the sums of flights can be added.
struct SquareSum {
  double squares = 0.0;
  double count = 0.0;

  void add(double value) {
    if (std::isnan(value)) return;
    squares += value * value;
    count += 1.0;
  }

  SquareSum& operator+=(const SquareSum& other) {
    squares += other.squares;
    count += other.count;
    return *this;
  }

  /// Root mean square; NaN if there is no value.
  double rms() const { return std::sqrt(squares / count); }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(squares, count);
  }
};

inline SquareSum square_sum_of(const std::vector<double>& values) {
  SquareSum sum;
  for (const double value : values) sum.add(value);
  return sum;
}

/// Root mean square of one series over all flights. @param series_of gives the values of a local flight
template <class Series>
double rms_of(const FlightPartition& partition, const Series& series_of) {
  return partition
      .all_reduce_flights<SquareSum>([&](std::size_t flight) { return square_sum_of(series_of(flight)); })
      .rms();
}

}  // namespace pcor::internal
