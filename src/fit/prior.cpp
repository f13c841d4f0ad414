#include "fit/prior.hpp"

#include <algorithm>
#include <cmath>

#include "campaign/candidate.hpp"
#include "campaign/model_parameters.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {

Eigen::MatrixXd stated_covariance(const ModelDefinition& model, const Reference& reference) {
  const Eigen::MatrixXd own = stated_covariance(model);
  Eigen::MatrixXd other;
  if (reference.model() != nullptr) other = stated_covariance(*reference.model());
  const Eigen::Index size = own.rows() + other.rows();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  covariance.topLeftCorner(own.rows(), own.rows()) = own;
  covariance.bottomRightCorner(other.rows(), other.rows()) = other;
  return covariance;
}

namespace {

Eigen::MatrixXd stated_rows(const FitTask& task, const std::vector<std::size_t>& requested) {
  const Eigen::Index size = as_index(requested.size());
  if (!task.uses_prior()) return Eigen::MatrixXd::Zero(0, size);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(size, size);
  std::vector<Eigen::Index> stated;
  for (Eigen::Index k = 0; k < size; ++k) {
    const std::size_t parameter = requested[static_cast<std::size_t>(k)];
    if (task.surface_of(parameter) != nullptr) continue;
    const double typical = task.parameters[parameter].typical;
    if (task.doubt(as_index(parameter), as_index(parameter)) > 0.0) {
      stated.push_back(k);
    } else if (typical > 0.0) {
      rows(k, k) = 1.0 / typical;
    }
  }
  if (stated.empty()) return rows;
  std::vector<std::size_t> indices;
  for (const Eigen::Index k : stated) indices.push_back(requested[static_cast<std::size_t>(k)]);
  const Eigen::MatrixXd covariance = task.doubt(indices, indices);
  // The inverse root, of the correlations: coefficients of one law may differ by powers of ten.
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  constexpr double min_eigenvalue = 1e-10;  // nearly certain directions are treated as equal
  const SymmetricEigen solver(scale.asDiagonal() * covariance * scale.asDiagonal());
  rows(stated, stated) =
      solver.eigenvalues().cwiseMax(min_eigenvalue).cwiseSqrt().cwiseInverse().asDiagonal() *
      solver.eigenvectors().transpose() * scale.asDiagonal();
  return rows;
}

/// Adds the prior of the effects that a diagnosis added.
void add_rows_of_added(const FitTask& task, const std::vector<std::size_t>& requested, PriorRows& prior) {
  if (task.uses_prior()) return;
  const std::vector<std::string>& added = task.options.added;
  for (std::size_t k = 0; k < requested.size(); ++k) {
    const FitParameter& parameter = task.parameters[requested[k]];
    if (!(parameter.typical > 0.0) || task.surface_of(requested[k]) != nullptr ||
        std::find(added.begin(), added.end(), parameter.effect) == added.end())
      continue;
    const Eigen::Index row = prior.rows.rows();
    prior.rows.conservativeResizeLike(Eigen::MatrixXd::Zero(row + 1, prior.rows.cols()));
    const double deviation =
        std::max(spread_of_sizes * parameter.typical, std::abs(parameter.start - parameter.neutral));
    prior.rows(row, as_index(k)) = 1.0 / deviation;
    prior.centre[as_index(k)] = parameter.neutral;
  }
}

}  // namespace

PriorRows prior_rows(const FitTask& task, const std::vector<std::size_t>& requested) {
  PriorRows prior{stated_rows(task, requested), task.start(requested), {}};
  add_rows_of_added(task, requested, prior);
  prior.inflation = Eigen::VectorXd::Ones(prior.rows.rows());
  for (const SurfaceRoughness& surface : task.surfaces) {
    std::vector<Eigen::Index> columns;
    std::vector<Eigen::Index> own;
    for (std::size_t k = 0; k < requested.size(); ++k) {
      if (!surface.has(requested[k])) continue;
      columns.push_back(as_index(k));
      own.push_back(as_index(requested[k] - surface.first));
    }
    if (own.empty()) continue;
    const Eigen::MatrixXd penalty = std::sqrt(surface.inflation) * surface.rows()(Eigen::all, own);
    const Eigen::Index before = prior.rows.rows();
    prior.rows.conservativeResizeLike(Eigen::MatrixXd::Zero(before + penalty.rows(), prior.rows.cols()));
    prior.rows.bottomRows(penalty.rows())(Eigen::all, columns) = penalty;
    prior.inflation.conservativeResizeLike(Eigen::VectorXd::Constant(prior.rows.rows(), surface.inflation));
    prior.centre(columns).setZero();
  }
  return prior;
}

}  // namespace pcor::internal
