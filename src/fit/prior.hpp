#pragma once

#include <Eigen/Dense>
#include <vector>

#include "fit/fit_task.hpp"

namespace pcor::internal {

/// Covariance of all parameters from the standard errors and covariances in the files, in the order of
/// `FitTask::parameters`; zero if not stated.
Eigen::MatrixXd stated_covariance(const ModelDefinition& model, const Reference& reference);

/// Prior rows W of wanted parameters about their values in the files: the cost is |W (x - start)|^2 / 2. The
/// covariance comes from the files, otherwise the typical size of the effect is the standard error; a
/// parameter without either has no prior. Empty if the fit uses no prior.
Eigen::MatrixXd prior_rows(const FitTask& task, const std::vector<std::size_t>& wanted);

}  // namespace pcor::internal
