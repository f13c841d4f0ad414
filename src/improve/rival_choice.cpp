#include "improve/rival_choice.hpp"

#include <algorithm>
#include <cmath>

#include "diagnose/rms.hpp"

namespace pcor::internal {
namespace {

/// Rms of a - b over the samples in which both have a value.
double distance(const std::vector<double>& a, const std::vector<double>& b) {
  SquareSum sum;
  for (std::size_t i = 0; i < a.size(); ++i) sum.add(a[i] - b[i]);
  return sum.rms();
}

}  // namespace

RivalChoice choose_rival(const std::vector<std::vector<double>>& changes, const std::vector<double>& weights,
                         double tolerance) {
  const std::vector<double> none(changes.front().size(), 0.0);
  const auto expected_error = [&](const std::vector<double>& change) {
    double squares = 0.0;
    for (std::size_t k = 0; k < changes.size(); ++k)
      squares += weights[k] * std::pow(distance(change, changes[k]), 2);
    return std::sqrt(squares);
  };
  const auto is_harmless = [&](const std::vector<double>& change) {
    return std::none_of(changes.begin(), changes.end(), [&](const std::vector<double>& rival) {
      return distance(change, rival) > distance(none, rival) + tolerance;
    });
  };
  const double error_of_first = expected_error(changes.front());
  if (error_of_first <= tolerance) return {0, error_of_first, error_of_first};
  RivalChoice best{std::nullopt, expected_error(none), error_of_first};
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const double error = expected_error(changes[k]);
    if (error < best.error && is_harmless(changes[k])) best = {k, error, error_of_first};
  }
  return best;
}

}  // namespace pcor::internal
