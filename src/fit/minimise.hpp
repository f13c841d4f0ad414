#pragma once

#include <Eigen/Dense>

#include "fit/fit_flights.hpp"

namespace pcor::internal {

/// What draws the unknowns to their starting values: rows (x - start) as further residuals. No rows for none.
struct Prior {
  Eigen::VectorXd start{};
  Eigen::MatrixXd rows{};
};

/// Finds with Ceres, from `x` on, the wanted parameters of a fit with the least loss. Every step is one pass
/// over the flights.
///
/// @param parameters all parameters; those that are not wanted stay as they are there
/// @param loss of the innovations
/// @throws Error if residuals are not numbers
void minimise(FitFlights& flights, const Eigen::VectorXd& parameters, const ScaledLoss& loss,
              const Prior& prior, Eigen::VectorXd& x);

}  // namespace pcor::internal
