#include "improve/rival_choice.hpp"

#include <cmath>

namespace pcor::internal {
namespace {

/// Rms of a - b over the samples in which both have a value; 0 if there are no such samples.
double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double difference = a[i] - b[i];
    if (std::isnan(difference)) continue;
    sum += difference * difference;
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
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
    for (const std::vector<double>& rival : changes) {
      if (distance(change, rival) > distance(none, rival) + tolerance) return false;
    }
    return true;
  };
  const double error_of_first = expected_error(changes.front());
  if (error_of_first <= tolerance) return {0, error_of_first};
  RivalChoice best{std::nullopt, expected_error(none)};
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const double error = expected_error(changes[k]);
    if (error < best.error && is_harmless(changes[k])) best = {k, error};
  }
  return best;
}

}  // namespace pcor::internal
