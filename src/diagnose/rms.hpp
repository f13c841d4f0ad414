#pragma once

#include <cmath>

#include "parallel/flight_partition.hpp"

namespace pcor::internal {

/// The squares of some values; those of flights add up.
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

  /// The root of their mean; 0 where there is none.
  double rms() const { return count > 0.0 ? std::sqrt(squares / count) : 0.0; }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(squares, count);
  }
};

/// The root mean square over all flights of one of their series, in which NaN is missing; 0 where there is
/// nothing. @param series_of gives the values of an own flight
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
