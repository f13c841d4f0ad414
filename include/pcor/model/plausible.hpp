#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include <pcor/model/quantity.hpp>
#include <pcor/physics/scalar.hpp>

namespace pcor {

/// Range of plausible values.
struct Limits {
  double minimum = std::numeric_limits<double>::lowest();
  double maximum = std::numeric_limits<double>::max();
};

/// Limits of every element of a state: the limits of the quantity, or any finite number for other variables.
inline constexpr std::array<Limits, state_capacity> limits_of_places = [] {
  std::array<Limits, state_capacity> limits{};
  for (std::size_t i = 0; i < quantity_count; ++i) {
    limits[i] = {quantity_info[i].minimum, quantity_info[i].maximum};
  }
  return limits;
}();

/// True if the value, in the unit of the quantity, is infinite or outside its plausible range
/// (`QuantityInfo`). A missing value is not implausible.
template <class S>
constexpr auto is_implausible(Quantity quantity, const S& value) {
  const Limits& limits = limits_of_places[index(quantity)];
  return value < S(limits.minimum) || value > S(limits.maximum);
}

/// Value if it is plausible, otherwise NaN.
template <class S>
constexpr S plausible_or_missing(Quantity quantity, const S& value) {
  return select(is_implausible(quantity, value), missing<S>(), value);
}

}  // namespace pcor
