#include "temperature/parts.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <functional>

#include "numerics/chi_squared.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/triangular_factor.hpp"
#include "temperature/degrees.hpp"

namespace pcor::internal {
namespace {

constexpr double rare = 0.01;  // significance level of a difference

/// Common correction at the mean temperature of a part, the ratio of the columns of a1 and a0.
PartCorrection common_at(double temperature, const HeightUnknowns& unknowns) {
  PartCorrection part;
  part.temperature = temperature;
  double power = 1.0;
  for (Eigen::Index k = 0; k < lasting; ++k, power *= temperature) part.common += unknowns[k] * power;
  return part;
}

/// Whether a step of the height, proportional to the change of the column of a0, belongs to the first part.
using IsFirst = std::function<bool(const HeightBlock& block, double step)>;

/// Record of residual heights, with the columns of a0 in each of two parts, and both times the temperature.
HeightRecord in_two_parts(HeightRecord record, const IsFirst& is_first) {
  double first = 0.0;
  double second = 0.0;
  double before = 0.0;
  for (HeightBlock& block : record.blocks) {
    const double step = block.starts_segment ? 0.0 : block.columns[0] - before;
    before = block.columns[0];
    (is_first(block, step) ? first : second) += step;
    block.columns.head<lasting>() = Eigen::Vector3d(first, second, block.columns[1]);
  }
  return record;
}

/// Corrections from records in two parts. Empty if one part has no heights.
std::vector<PartCorrection> corrections_of_two(const std::vector<HeightRecord>& parted,
                                               const std::array<const char*, 2>& names,
                                               const HeightNoise& noise, const HeightPrior& prior,
                                               const HeightUnknowns& unknowns, const Workers& workers) {
  const HeightEquations equations = height_equations(parted, noise, prior, workers);
  for (Eigen::Index k = 0; k < 2; ++k) {
    if (!(equations.information(k, k) > 0.0)) return {};
  }
  // The column of a1 as the sum of both of a0, each times a temperature.
  const Eigen::MatrixXd both = equations.information.topLeftCorner(2, 3);
  const Eigen::VectorXd temperature = inverse_of(both.leftCols(2)) * both.col(2);
  const Eigen::MatrixXd covariance = equations.covariance(2);
  const double of_difference = covariance(0, 0) + covariance(1, 1) - 2.0 * covariance(0, 1);  // K^2
  std::vector<PartCorrection> parts;
  for (Eigen::Index k = 0; k < 2; ++k) {
    PartCorrection part = common_at(temperature[k], unknowns);
    part.part = names.at(static_cast<std::size_t>(k));
    part.correction = part.common + equations.best(2)[k];
    part.standard_error = std::sqrt(covariance(k, k));
    part.difference_error = std::sqrt(0.5 * of_difference);
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace

std::vector<PartCorrection> corrections_of_flights(const std::vector<HeightRecord>& records,
                                                   const HeightNoise& noise, const HeightPrior& prior,
                                                   const HeightUnknowns& unknowns) {
  std::vector<PartCorrection> parts;
  for (const HeightRecord& record : records) {
    const HeightEquations one = height_equations(record, noise, prior);
    PartCorrection part = common_at(one.information(0, 1) / one.information(0, 0), unknowns);
    part.part = record.name;
    part.correction =
        part.common + (one.right[0] - one.information.row(0).dot(unknowns)) / one.information(0, 0);
    part.standard_error = part.difference_error = std::sqrt(1.0 / one.information(0, 0));
    parts.push_back(std::move(part));
  }
  return parts;
}

std::vector<PartCorrection> corrections_of_climbs_and_descents(const std::vector<HeightRecord>& records,
                                                               const HeightNoise& noise,
                                                               const HeightPrior& prior,
                                                               const HeightUnknowns& unknowns,
                                                               const Workers& workers) {
  std::vector<HeightRecord> parted;
  for (const HeightRecord& record : records) {
    parted.push_back(in_two_parts(without_unknowns(record, unknowns),
                                  [](const HeightBlock&, double step) { return step > 0.0; }));
  }
  return corrections_of_two(parted, {"climbs", "descents"}, noise, prior, unknowns, workers);
}

std::vector<PartCorrection> corrections_of_halves(const std::vector<HeightRecord>& records,
                                                  const HeightNoise& noise, const HeightPrior& prior,
                                                  const HeightUnknowns& unknowns, const Workers& workers) {
  std::vector<HeightRecord> parted;
  for (const HeightRecord& record : records) {
    const double middle = 0.5 * (record.blocks.front().time + record.blocks.back().time);
    parted.push_back(
        in_two_parts(without_unknowns(record, unknowns),
                     [middle](const HeightBlock& block, double) { return block.time < middle; }));
  }
  return corrections_of_two(parted, {"first halves", "second halves"}, noise, prior, unknowns, workers);
}

Disagreement disagreement_of(const std::vector<PartCorrection>& parts) {
  Disagreement result;
  if (parts.size() < 2) return result;
  double weights = 0.0;
  double squared_weights = 0.0;
  double mean = 0.0;
  for (const PartCorrection& part : parts) {
    const double weight = 1.0 / (part.difference_error * part.difference_error);
    weights += weight;
    squared_weights += weight * weight;
    mean += weight * (part.correction - part.common);
  }
  mean /= weights;
  for (const PartCorrection& part : parts)
    result.chi_squared += std::pow((part.correction - part.common - mean) / part.difference_error, 2);
  const auto degrees_of_freedom = static_cast<double>(parts.size() - 1);
  result.p_value = chi_squared_tail(result.chi_squared, degrees_of_freedom);
  if (result.p_value < rare)
    result.spread =
        std::sqrt((result.chi_squared - degrees_of_freedom) / (weights - squared_weights / weights));
  return result;
}

bool is_made_worse(const PartCorrection& part) {
  const double from_none = part.correction / part.standard_error;
  const double from_common = (part.correction - part.common) / part.standard_error;
  return from_common * from_common - from_none * from_none > worthwhile_gain;
}

}  // namespace pcor::internal
