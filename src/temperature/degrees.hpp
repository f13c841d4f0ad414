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

/// How well corrections of each degree explain the flights, and those that are held out.
class Degrees {
 public:
  /// Degrees from none to that of `maximum` coefficients.
  Degrees(const std::vector<HeightEquations>& flights, std::size_t maximum);

  const std::vector<DegreeChoice>& choices() const { return choices_; }

  /// Number of coefficients that are justified, at least one.
  std::size_t worthwhile_terms() const;

 private:
  bool is_worthwhile(std::size_t terms) const;

  std::size_t flights_;
  std::vector<DegreeChoice> choices_;
  std::vector<std::vector<double>> gains_;  // -2 ln L, by number of terms, of each held-out flight
};

}  // namespace pcor::internal
