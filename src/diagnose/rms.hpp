#pragma once

#include <cmath>
#include <functional>

namespace pcor::internal {

/// The root mean square over all flights of one of their series, in which NaN is missing; 0 where there is
/// nothing. @param series a member of a flight, or a function of it, that gives its values
template <class Flights, class Series>
double rms_of(const Flights& flights, const Series& series) {
  double squares = 0.0;
  double count = 0.0;
  for (const auto& flight : flights) {
    for (const double value : std::invoke(series, flight)) {
      if (std::isnan(value)) continue;
      squares += value * value;
      count += 1.0;
    }
  }
  return count > 0.0 ? std::sqrt(squares / count) : 0.0;
}

}  // namespace pcor::internal
