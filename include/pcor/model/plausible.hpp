#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include <pcor/model/quantity.hpp>
#include <pcor/physics/scalar.hpp>

namespace pcor {

/// Between which values something is believed.
struct Limits {
  double least = std::numeric_limits<double>::lowest();
  double most = std::numeric_limits<double>::max();
};

/// The limits of every place of a state: those of the facts, and for variables that are no quantities of the
/// library any finite number.
inline constexpr std::array<Limits, state_capacity> limits_of_places = [] {
  std::array<Limits, state_capacity> limits{};
  for (std::size_t i = 0; i < quantity_count; ++i) {
    limits[i] = {quantity_info[i].least, quantity_info[i].most};
  }
  return limits;
}();

/// True where the value, in the unit of the quantity, is infinite or beyond what is believed of it
/// (`QuantityInfo`). A missing value is not implausible.
template <class S>
constexpr auto is_implausible(Quantity quantity, const S& value) {
  const Limits& limits = limits_of_places[index(quantity)];
  return value < S(limits.least) || value > S(limits.most);
}

/// The value where it is believed, else not a number.
template <class S>
constexpr S plausible_or_missing(Quantity quantity, const S& value) {
  return select(is_implausible(quantity, value), missing<S>(), value);
}

}  // namespace pcor
