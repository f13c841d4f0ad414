#pragma once

#include <Eigen/Dense>
#include <vector>

#include "fit/fit_task.hpp"

namespace pcor::internal {

/// Covariance of all parameters from the standard errors and covariances in the files, in the order of
/// `FitTask::parameters`; zero if not stated.
Eigen::MatrixXd stated_covariance(const ModelDefinition& model, const Reference& reference);

/// Rows W of what draws wanted parameters to `centre`: the cost is |W (x - centre)|^2 / 2.
struct PriorRows {
  Eigen::MatrixXd rows{};
  Eigen::VectorXd centre{};
  /// Weight of each row relative to the prior itself (`SurfaceRoughness::inflation`).
  Eigen::VectorXd inflation{};
};

/// Where the fit uses a prior, parameters are drawn to their values in the files, with the covariance that
/// the files state, else with the typical size of the effect as the standard error; a parameter of which
/// neither is known is not drawn anywhere. Coefficients of a surface always have the prior of its roughness.
PriorRows prior_rows(const FitTask& task, const std::vector<std::size_t>& wanted);

}  // namespace pcor::internal
