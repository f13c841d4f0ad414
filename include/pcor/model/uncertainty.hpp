#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <pcor/model/model.hpp>

namespace pcor {

/// Standard uncertainties (GUM 2.3.1) of a model and its sensors, one standard deviation each. Contributions
/// that are not stated are zero and therefore not included in results.
struct ModelUncertainty {
  /// Covariance of the parameters of all effects, in the order of the model, then of those of `calibration`,
  /// row by row, in their units. Constant from sample to sample (systematic component). Empty if not stated.
  std::vector<double> covariance{};
  /// Effects of unknown calibration errors of sensors that the model does not correct, with coefficients that
  /// do not change the results.
  std::vector<ModelEffect> calibration{};
  /// Standard uncertainty of one sample of each role, in its unit; independent in every sample (random
  /// component).
  std::array<double, role_count> random{};
  /// Remaining error of delta-p in one sample after the model: hPa, and relative to the static pressure. Both
  /// are added in quadrature.
  double static_defect = 0.0;
  double static_defect_ratio = 0.0;

  bool has_systematic() const {
    return std::any_of(covariance.begin(), covariance.end(), [](double value) { return value != 0.0; });
  }
  bool has_random() const {
    return static_defect != 0.0 || static_defect_ratio != 0.0 ||
           std::any_of(random.begin(), random.end(), [](double value) { return value != 0.0; });
  }

  /// Components that are constant from sample to sample (systematic) and independent (random).
  ModelUncertainty systematic_part() const {
    ModelUncertainty part;
    part.covariance = covariance;
    part.calibration = calibration;
    return part;
  }
  ModelUncertainty random_part() const {
    ModelUncertainty part = *this;
    part.covariance.clear();
    part.calibration.clear();
    return part;
  }
};

/// Root of a covariance: vectors v of `size` elements with sum v_i v_j = C_ij, each a change of all variables
/// by independent errors of one standard deviation (pivoted Cholesky). nullopt if the `matrix` of `size`
/// rows, row by row, is not a covariance: finite, symmetric, and no linear combination has a negative
/// variance. Correlations may have rounding errors of 1e-6, as from six digits.
inline std::optional<std::vector<std::vector<double>>> covariance_root(std::vector<double> matrix,
                                                                       std::size_t size) {
  constexpr double rounding = 1e-6;
  const auto at = [&](std::size_t i, std::size_t j) -> double& { return matrix[i * size + j]; };
  std::vector<double> scale(size);
  for (std::size_t i = 0; i < size; ++i) {
    if (!(is_finite(at(i, i)) && at(i, i) >= 0.0)) return std::nullopt;
    scale[i] = std::sqrt(at(i, i));
  }
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!(std::abs(at(i, j) - at(j, i)) <= rounding * scale[i] * scale[j])) return std::nullopt;
    }
  }
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) {
      const double product = scale[i] * scale[j];
      if (product > 0.0) {
        at(i, j) /= product;
      } else if (at(i, j) != 0.0) {
        return std::nullopt;
      }
    }
  }
  // The conditional covariance for one known variable is also a covariance: pivoted Cholesky, starting with
  // the variable of the largest variance. Those below the rounding errors belong to the root only as
  // long as no covariance exceeds them.
  std::vector<std::vector<double>> root;
  std::vector<std::size_t> remaining(size);
  for (std::size_t i = 0; i < size; ++i) remaining[i] = i;
  bool is_checked = false;
  while (!remaining.empty()) {
    std::sort(remaining.begin(), remaining.end(),
              [&](std::size_t a, std::size_t b) { return at(a, a) < at(b, b); });
    const std::size_t known = remaining.back();
    const double variance = at(known, known);
    const auto all_below = [&](double limit) {
      return std::all_of(remaining.begin(), remaining.end(), [&](std::size_t i) {
        return std::all_of(remaining.begin(), remaining.end(),
                           [&](std::size_t j) { return std::abs(at(i, j)) <= limit; });
      });
    };
    if (!is_checked && at(remaining.front(), remaining.front()) < -rounding) return std::nullopt;
    if (!is_checked && variance <= rounding) {
      if (!all_below(2.0 * rounding)) return std::nullopt;
      is_checked = true;
    }
    if (is_checked && (variance < 1e-12 || !all_below(1.01 * variance))) break;
    std::vector<double>& change = root.emplace_back(size, 0.0);
    for (const std::size_t i : remaining) change[i] = at(i, known) / std::sqrt(variance) * scale[i];
    remaining.pop_back();
    for (const std::size_t i : remaining) {
      for (const std::size_t j : remaining) at(i, j) -= at(i, known) * at(known, j) / variance;
    }
  }
  return root;
}

/// True if the `matrix` of `size` rows is a covariance (`covariance_root`).
inline bool is_covariance(const std::vector<double>& matrix, std::size_t size) {
  return covariance_root(matrix, size).has_value();
}

}  // namespace pcor
