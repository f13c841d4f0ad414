#pragma once

#include <Eigen/Dense>
#include <vector>

#include "fit/fit_task.hpp"

namespace pcor::internal {

/// The covariance of the values that the files give to all parameters: what the files state, as standard
/// errors and covariances, in the order of `FitTask::parameters`; zero for those of which they state nothing.
Eigen::MatrixXd stated_covariance(const ModelDefinition& model, const Reference& reference);

/// Rows W of what draws wanted parameters to their values in the files: the cost is |W (x - start)|^2 / 2.
/// Their covariance is what the files state, else the typical size of the effect is the standard error; a
/// parameter of which neither is known is not drawn anywhere. No rows where the fit uses no prior.
Eigen::MatrixXd prior_rows(const FitTask& task, const std::vector<std::size_t>& wanted);

}  // namespace pcor::internal
