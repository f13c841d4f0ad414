#include "temperature/degrees.hpp"

#include <algorithm>
#include <cmath>

#include "numerics/least_squares.hpp"
#include "numerics/missing.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

// Threshold for held-out flights: standard errors of the gain in -2 ln L, and the gain itself. 4 corresponds
// to two standard deviations.
constexpr double sure = 2.0;
constexpr double worthwhile_held_out = 4.0;

/// A sum over flights with the standard error that their scatter gives it.
Estimate sum_of(const std::vector<double>& gains) {
  double sum = 0.0;
  double squares = 0.0;
  for (const double gain : gains) {
    sum += gain;
    squares += gain * gain;
  }
  const auto count = static_cast<double>(gains.size());
  return {sum, std::sqrt(std::max(0.0, (squares - sum * sum / count) * count / (count - 1.0)))};
}

}  // namespace

DegreeSelection select_degree(const std::vector<HeightEquations>& flights, std::size_t maximum) {
  const bool can_hold_out = flights.size() >= min_for_choice;
  HeightEquations all;
  for (const HeightEquations& one : flights) all += one;
  DegreeSelection result;
  std::vector<std::vector<double>> gains(maximum + 1);  // -2 ln L of each held-out flight
  for (std::size_t terms = 0; terms <= maximum; ++terms) {
    const Eigen::Index n = as_index(terms);
    DegreeChoice& choice = result.choices.emplace_back();
    choice.degree = static_cast<int>(terms) - 1;
    choice.deviance = all.deviance(n) - all.deviance(0);
    choice.held_out = choice.held_out_error = nan;
    if (!can_hold_out) continue;
    for (const HeightEquations& one : flights) {
      HeightEquations others = all;
      others.information -= one.information;
      others.right -= one.right;
      gains[terms].push_back(one.deviance_of_heights(others.best_unknowns(n)) -
                             one.deviance_of_heights(others.best_unknowns(0)));
    }
    const Estimate sum = sum_of(gains[terms]);
    choice.held_out = sum.value;
    choice.held_out_error = sum.error;
  }
  const auto decrease = [&](std::size_t from, std::size_t to) {
    return result.choices[from].deviance - result.choices[to].deviance;
  };
  // True if one more coefficient significantly improves the prediction of held-out flights.
  const auto is_worthwhile = [&](std::size_t terms) {
    if (!can_hold_out) return decrease(terms - 1, terms) > worthwhile_gain;
    std::vector<double> more(flights.size());
    for (std::size_t f = 0; f < more.size(); ++f) more[f] = gains[terms - 1][f] - gains[terms][f];
    const Estimate sum = sum_of(more);
    return sum.value > sure * sum.error && sum.value > worthwhile_held_out;
  };
  while (result.terms < maximum && is_worthwhile(result.terms + 1)) ++result.terms;
  // A curved error may show no slope at the mean temperature.
  if (result.terms == 1 && maximum == 3 && is_worthwhile(3) && decrease(1, 3) > 2.0 * worthwhile_gain)
    result.terms = 3;
  return result;
}

}  // namespace pcor::internal
