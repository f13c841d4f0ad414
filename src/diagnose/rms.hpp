#pragma once

#include <cmath>

#include "parallel/flight_partition.hpp"

namespace pcor::internal {

/// Sum of squares of some values; the sums of flights can be added.
struct SquareSum {
  double squares = 0.0;
  double count = 0.0;

  void add(double value) {
    squares += value * value;
    count += 1.0;
  }

  SquareSum& operator+=(const SquareSum& other) {
    squares += other.squares;
    count += other.count;
    return *this;
  }

  /// Root mean square; 0 if there is no value.
  double rms() const { return count > 0.0 ? std::sqrt(squares / count) : 0.0; }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(squares, count);
  }
};

/// Root mean square of one series over all flights, ignoring NaN; 0 if there is no value. @param series_of
/// gives the values of a local flight
template <class Series>
double rms_of(const FlightPartition& share, const Series& series_of) {
  return share
      .sum_of_each_flight<SquareSum>([&](std::size_t flight) {
        SquareSum sum;
        for (const double value : series_of(flight)) {
          if (!std::isnan(value)) sum.add(value);
        }
        return sum;
      })
      .rms();
}

}  // namespace pcor::internal
