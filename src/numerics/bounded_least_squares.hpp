#pragma once

#include <Eigen/Dense>

namespace pcor::internal {

/// Minimizes |rows x - right| within the bounds, exactly, by an active set: bounds that the free solution
/// crosses are fixed one by one, and released if the gradient points inwards (Stark and Parker 1995,
/// Computational Statistics 10, 129). A fixed unknown is exactly at its bound. For a few unknowns.
/// @param start within the bounds
Eigen::VectorXd bounded_least_squares(const Eigen::MatrixXd& rows, const Eigen::VectorXd& right,
                                      const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                      const Eigen::VectorXd& start);

}  // namespace pcor::internal
