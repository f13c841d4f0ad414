#pragma once

#include <Eigen/Dense>
#include <functional>

#include "fit/fit_flights.hpp"

namespace pcor::internal {

/// Loss of the residuals as a function of the unknowns, with a prior and bounds.
struct LossProblem {
  std::function<Reduction(const Eigen::VectorXd& unknowns)> reduce{};  ///< one pass over the flights
  Eigen::MatrixXd prior_rows{};                                        ///< residuals rows (x - centre)
  Eigen::VectorXd prior_centre{};
  Eigen::VectorXd lower{};
  Eigen::VectorXd upper{};
};

/// Minimises the loss of residuals that are not linear in the unknowns, with Ceres, starting at `x`.
/// @throws Error if residuals are not numbers at the start
void minimise(const LossProblem& problem, Eigen::VectorXd& x);

}  // namespace pcor::internal
