#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <pcor/model/quantity.hpp>

namespace pcor {

/// How well a model and the sensors that it reads are known: standard uncertainties (GUM 2.3.1), one standard
/// deviation each. What is not stated is zero, and so left out of what follows from it.
struct ModelUncertainty {
  /// Covariance of the parameters of all effects, in the order of the model, row after row, in their units.
  /// It stays the same from sample to sample: what it makes is the systematic part of an uncertainty. Empty
  /// where nothing is stated.
  std::vector<double> covariance{};
  /// Of one sample of each role, in its unit. It is anew in every sample: the random part.
  std::array<double, role_count> random{};
  /// What the law leaves of delta-p in one sample: hPa, and a part of the static pressure. Both are counted.
  double static_defect = 0.0;
  double static_defect_ratio = 0.0;

  bool has_systematic() const {
    return std::any_of(covariance.begin(), covariance.end(), [](double value) { return value != 0.0; });
  }
  bool has_random() const {
    return static_defect > 0.0 || static_defect_ratio > 0.0 ||
           std::any_of(random.begin(), random.end(), [](double value) { return value > 0.0; });
  }

  /// What of it does not change from sample to sample, and what does.
  ModelUncertainty systematic_part() const {
    ModelUncertainty part;
    part.covariance = covariance;
    return part;
  }
  ModelUncertainty random_part() const {
    ModelUncertainty part = *this;
    part.covariance.clear();
    return part;
  }
};

/// True where the symmetric `matrix` of `size` rows, one after another, is a covariance: no combination of
/// what it is of has a negative variance. Correlations may be wrong by 1e-6, as rounding to six digits leaves
/// them.
inline bool is_covariance(std::vector<double> matrix, std::size_t size) {
  constexpr double rounding = 1e-6;
  const auto at = [&](std::size_t i, std::size_t j) -> double& { return matrix[i * size + j]; };
  std::vector<double> scale(size);
  for (std::size_t i = 0; i < size; ++i) {
    if (!(at(i, i) >= 0.0)) return false;
    scale[i] = std::sqrt(at(i, i));
  }
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) {
      const double product = scale[i] * scale[j];
      if (product > 0.0) {
        at(i, j) /= product;
      } else if (at(i, j) != 0.0) {
        return false;
      }
    }
  }
  // What remains of a covariance when one of its variables is known is a covariance, too: the variable of the
  // greatest variance goes first (Cholesky with pivots).
  std::vector<std::size_t> left(size);
  for (std::size_t i = 0; i < size; ++i) left[i] = i;
  while (!left.empty()) {
    std::sort(left.begin(), left.end(), [&](std::size_t a, std::size_t b) { return at(a, a) < at(b, b); });
    const std::size_t known = left.back();
    const double variance = at(known, known);
    if (at(left.front(), left.front()) < -rounding) return false;
    if (variance <= rounding) {
      return std::all_of(left.begin(), left.end(), [&](std::size_t i) {
        return std::all_of(left.begin(), left.end(),
                           [&](std::size_t j) { return std::abs(at(i, j)) <= 2.0 * rounding; });
      });
    }
    left.pop_back();
    for (const std::size_t i : left) {
      for (const std::size_t j : left) at(i, j) -= at(i, known) * at(known, j) / variance;
    }
  }
  return true;
}

}  // namespace pcor
