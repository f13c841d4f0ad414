#include "temperature/degrees.hpp"

#include <algorithm>
#include <cmath>

#include "model_io/calibration.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

// Threshold for held-out flights: standard errors of the gain in -2 ln L, and the gain itself. 4 corresponds
// to two standard deviations.
constexpr double sure = 2.0;
constexpr double worthwhile_held_out = 4.0;

/// A sum over flights with the standard error that their scatter gives it.
struct Sum {
  double value = 0.0;
  double error = 0.0;
};

Sum sum_of(const std::vector<double>& gains) {
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

Degrees::Degrees(const std::vector<HeightEquations>& flights, std::size_t maximum)
    : flights_(flights.size()) {
  HeightEquations all;
  for (const HeightEquations& one : flights) all += one;
  for (std::size_t terms = 0; terms <= maximum; ++terms) {
    const auto n = static_cast<Eigen::Index>(terms);
    DegreeChoice& choice = choices_.emplace_back();
    choice.degree = static_cast<int>(terms) - 1;
    choice.deviance = all.deviance(n) - all.deviance(0);
    choice.held_out = choice.held_out_error = nan;
    std::vector<double>& gains = gains_.emplace_back();
    if (flights_ < min_for_choice) continue;
    for (const HeightEquations& one : flights) {
      HeightEquations others = all;
      others.information -= one.information;
      others.right -= one.right;
      gains.push_back(one.deviance_of_heights(others.best_unknowns(n)) -
                      one.deviance_of_heights(others.best_unknowns(0)));
    }
    const Sum sum = sum_of(gains);
    choice.held_out = sum.value;
    choice.held_out_error = sum.error;
  }
}

/// True if one more coefficient significantly improves the prediction of held-out flights.
bool Degrees::is_worthwhile(std::size_t terms) const {
  if (flights_ < min_for_choice)
    return choices_[terms - 1].deviance - choices_[terms].deviance > worthwhile_gain;
  std::vector<double> gains(flights_);
  for (std::size_t f = 0; f < flights_; ++f) gains[f] = gains_[terms - 1][f] - gains_[terms][f];
  const Sum sum = sum_of(gains);
  return sum.value > sure * sum.error && sum.value > worthwhile_held_out;
}

std::size_t Degrees::worthwhile_terms() const {
  std::size_t terms = 1;
  while (terms < calibration_terms && is_worthwhile(terms + 1)) ++terms;
  // A curved error may show no slope at the mean temperature.
  if (terms == 1 && is_worthwhile(3) && choices_[1].deviance - choices_[3].deviance > 2.0 * worthwhile_gain)
    return 3;
  return terms;
}

}  // namespace pcor::internal
