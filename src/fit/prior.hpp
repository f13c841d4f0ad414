#pragma once

#include <Eigen/Dense>
#include <vector>

#include "fit/fit_task.hpp"

namespace pcor::internal {

/// Rows W of the Gaussian prior of requested parameters around `centre`: the cost is |W (x - centre)|^2 / 2.
struct PriorRows {
  Eigen::MatrixXd rows{};
  Eigen::VectorXd centre{};
  /// Weight of each row relative to the prior itself (`SurfaceRoughness::inflation`).
  Eigen::VectorXd inflation{};
};

/// If the fit uses a prior, it is centred on the values in the files, with the covariance stated in the
/// files, otherwise with the typical size of the effect as the standard error, for a formula the value
/// itself. A parameter without any of these has no prior, which a fit of two systems refuses. Otherwise
/// coefficients of the effects `RefitOptions::added` have the prior of a diagnosis about their neutral value.
/// Coefficients of a surface always have the prior of its roughness.
PriorRows prior_rows(const FitTask& task, const std::vector<std::size_t>& requested);

}  // namespace pcor::internal
