#pragma once

#include <cstddef>
#include <vector>

#include <pcor/temperature/temperature.hpp>
#include "temperature/height_likelihood.hpp"

namespace pcor::internal {

/// Decrease of -2 ln L that justifies a coefficient if no flight can be held out: 3 standard deviations.
inline constexpr double worthwhile_gain = 9.0;

/// Flights, for errors from their scatter.
inline constexpr std::size_t min_for_choice = 3;

/// Number of coefficients that the flights justify.
struct DegreeSelection {
  std::vector<DegreeChoice> choices{};  ///< how well corrections of each degree explain the flights
  std::size_t terms = 1;                ///< number of coefficients that are justified, at least one
};

/// Compares the degrees from none to that of `maximum` coefficients, by the flights and by held-out flights.
DegreeSelection select_degree(const std::vector<HeightEquations>& flights, std::size_t maximum);

}  // namespace pcor::internal
