#pragma once

#include <Eigen/Dense>

#include "fit/fit_flights.hpp"

namespace pcor::internal {

/// Prior on the unknowns about their starting values: rows (x - start) as further residuals. Empty without a
/// prior.
struct Prior {
  Eigen::VectorXd start{};
  Eigen::MatrixXd rows{};
};

/// Minimises the loss over the wanted parameters of a fit with Ceres, starting at `x`. Every step is one pass
/// over the flights.
///
/// @param parameters all parameters; unwanted ones are unchanged
/// @param loss of the innovations
/// @throws Error if residuals are not numbers
void minimise(FitFlights& flights, const Eigen::VectorXd& parameters, const ScaledLoss& loss,
              const Prior& prior, Eigen::VectorXd& x);

}  // namespace pcor::internal
