#include "fit/prior.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <pcor/base/error.hpp>
#include "campaign/candidate.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

Eigen::MatrixXd stated_rows(const FitTask& task, const std::vector<std::size_t>& requested) {
  const Eigen::Index size = as_index(requested.size());
  if (!task.uses_prior()) return Eigen::MatrixXd::Zero(0, size);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(size, size);
  const Eigen::MatrixXd stated_covariance = task.stated_covariance(requested, requested);
  std::vector<Eigen::Index> stated;
  for (Eigen::Index k = 0; k < size; ++k) {
    const std::size_t parameter = requested[static_cast<std::size_t>(k)];
    if (task.surface_of(parameter) != nullptr) continue;
    const FitParameter& prior = task.parameters[parameter];
    // A formula has no typical size.
    const double typical = prior.typical > 0.0 ? prior.typical : std::abs(prior.start);
    if (stated_covariance(k, k) > 0.0) {
      stated.push_back(k);
    } else if (typical > 0.0) {
      rows(k, k) = 1.0 / typical;
    } else if (task.options.fit_reference) {
      throw Error(
          Error::Code::model,
          fmt::format(
              "{} is 0 and has no error, so it has no prior for a fit of two systems: give a value, or its "
              "error in stderr",
              prior.name));
    }
  }
  if (stated.empty()) return rows;
  const Eigen::MatrixXd covariance = stated_covariance(stated, stated);
  // The inverse root, of the correlations: coefficients of one law may differ by powers of ten.
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  constexpr double min_eigenvalue = 1e-10;  // nearly certain directions are treated as equal
  const SymmetricEigen solver(scale.asDiagonal() * covariance * scale.asDiagonal());
  rows(stated, stated) =
      solver.eigenvalues().cwiseMax(min_eigenvalue).cwiseSqrt().cwiseInverse().asDiagonal() *
      solver.eigenvectors().transpose() * scale.asDiagonal();
  return rows;
}

/// Adds rows of the prior of the requested parameters at these indices.
void add_rows(PriorRows& prior, const std::vector<Eigen::Index>& columns, const Eigen::MatrixXd& rows,
              double inflation) {
  const Eigen::Index count = prior.rows.rows() + rows.rows();
  prior.rows.conservativeResizeLike(Eigen::MatrixXd::Zero(count, prior.rows.cols()));
  prior.rows.bottomRows(rows.rows())(Eigen::all, columns) = rows;
  prior.inflation.conservativeResizeLike(Eigen::VectorXd::Constant(count, inflation));
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
    const double deviation =
        std::max(spread_of_sizes * parameter.typical, std::abs(parameter.start - parameter.neutral));
    add_rows(prior, {as_index(k)}, Eigen::MatrixXd::Constant(1, 1, 1.0 / deviation), 1.0);
    prior.centre[as_index(k)] = parameter.neutral;
  }
}

}  // namespace

PriorRows prior_rows(const FitTask& task, const std::vector<std::size_t>& requested) {
  PriorRows prior{stated_rows(task, requested), task.start(requested)};
  prior.inflation = Eigen::VectorXd::Ones(prior.rows.rows());
  add_rows_of_added(task, requested, prior);
  for (const SurfaceRoughness& surface : task.surfaces) {
    std::vector<Eigen::Index> columns;
    std::vector<Eigen::Index> coefficients;
    for (std::size_t k = 0; k < requested.size(); ++k) {
      if (!surface.has(requested[k])) continue;
      columns.push_back(as_index(k));
      coefficients.push_back(as_index(requested[k] - surface.first));
    }
    if (coefficients.empty()) continue;
    const Eigen::MatrixXd penalty = std::sqrt(surface.inflation) * surface.rows()(Eigen::all, coefficients);
    add_rows(prior, columns, penalty, surface.inflation);
    prior.centre(columns).setZero();
  }
  return prior;
}

}  // namespace pcor::internal
