#pragma once

#include <cstddef>
#include <vector>

#include <pcor/temperature/temperature.hpp>
#include "temperature/height_likelihood.hpp"

namespace pcor::internal {

/// How much -2 ln L falls for a coefficient that is worth having where no flight can be held out: 3
/// deviations.
inline constexpr double worthwhile_gain = 9.0;

/// Flights, for errors from their scatter.
inline constexpr std::size_t min_for_choice = 3;

/// How well corrections of each degree explain the flights, and those that are held out.
class Degrees {
 public:
  /// Degrees from none to that of `most` coefficients.
  Degrees(const std::vector<HeightEquations>& flights, std::size_t most);

  const std::vector<DegreeChoice>& choices() const { return choices_; }

  /// How many coefficients are worth having, one at least.
  std::size_t worthwhile_terms() const;

 private:
  bool is_worthwhile(std::size_t terms) const;

  std::size_t flights_;
  std::vector<DegreeChoice> choices_;
  std::vector<std::vector<double>> gains_;  // of each number of terms, -2 ln L of each flight held out
};

}  // namespace pcor::internal
