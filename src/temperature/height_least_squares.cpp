#include "temperature/height_least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "numerics/decompositions.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

/// Calls `see` with the first and one past the last block of every segment.
template <class See>
void for_each_segment(const HeightRecord& record, const See& see) {
  std::size_t first = 0;
  for (std::size_t i = 1; i <= record.blocks.size(); ++i) {
    if (i < record.blocks.size() && !record.blocks[i].starts_segment) continue;
    see(first, i);
    first = i;
  }
}

}  // namespace

Eigen::MatrixXd scaled_inverse(const Eigen::MatrixXd& information) {
  const Eigen::VectorXd scale =
      information.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  return scale.asDiagonal() * inverse_of(scaled) * scale.asDiagonal();
}

std::vector<double> height_differences(const HeightRecord& record, const std::vector<double>& coefficients) {
  std::vector<double> result(record.blocks.size());
  for_each_segment(record, [&](std::size_t first, std::size_t end) {
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t i = first; i < end; ++i) {
      const HeightBlock& block = record.blocks[i];
      result[i] = block.excess;
      for (std::size_t k = 0; k < coefficients.size(); ++k)
        result[i] -= coefficients[k] * block.columns[as_index(k)];
      sum += result[i] * static_cast<double>(block.samples);
      count += static_cast<double>(block.samples);
    }
    for (std::size_t i = first; i < end; ++i) result[i] -= sum / count;
  });
  return result;
}

double samples_as_one(const HeightRecord& record, const std::vector<double>& coefficients) {
  const std::vector<double> differences = height_differences(record, coefficients);
  const double squares = std::inner_product(differences.begin(), differences.end(), differences.begin(), 0.0);
  // To the first lag without correlation: heights about their mean have negative ones beyond.
  double as_one = 1.0;
  for (std::size_t lag = 1; lag < differences.size(); ++lag) {
    const double products = std::inner_product(
        differences.data() + lag, differences.data() + differences.size(), differences.data(), 0.0);
    if (!(products > 0.0)) break;
    as_one += 2.0 * products / squares;
  }
  return as_one * static_cast<double>(record.samples) / static_cast<double>(differences.size());
}

TemperatureFit fit_height_by_least_squares(const std::vector<HeightRecord>& records, std::size_t terms) {
  const Eigen::Index n = as_index(terms);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  double squares = 0.0;
  double samples = 0.0;
  for (const HeightRecord& record : records) {
    for_each_segment(record, [&](std::size_t first, std::size_t end) {
      Eigen::VectorXd mean = Eigen::VectorXd::Zero(n + 1);
      double count = 0.0;
      const auto row_of = [&](std::size_t i) {
        Eigen::VectorXd row(n + 1);
        row << record.blocks[i].columns.head(n), record.blocks[i].excess;
        return row;
      };
      for (std::size_t i = first; i < end; ++i) {
        const auto weight = static_cast<double>(record.blocks[i].samples);
        mean += weight * row_of(i);
        count += weight;
      }
      mean /= count;
      for (std::size_t i = first; i < end; ++i) {
        const auto weight = static_cast<double>(record.blocks[i].samples);
        const Eigen::VectorXd row = row_of(i) - mean;
        information += weight * row.head(n) * row.head(n).transpose();
        right += weight * row[n] * row.head(n);
        squares += weight * row[n] * row[n];
      }
      samples += count;
    });
  }
  TemperatureFit fit;
  const Eigen::MatrixXd inverse = scaled_inverse(information);
  const Eigen::VectorXd best = inverse * right;
  fit.sigma = std::sqrt(std::max(0.0, squares - best.dot(right)) / samples);
  for (Eigen::Index k = 0; k < n; ++k) {
    fit.coefficients.push_back(best[k]);
    fit.standard_errors.push_back(fit.sigma * std::sqrt(inverse(k, k)));
  }
  return fit;
}

}  // namespace pcor::internal
