#pragma once

#include <Eigen/Dense>

namespace pcor::internal {

/// The x within the bounds with the least |rows x - right|, exactly, by an active set: bounds that the free
/// solution crosses are held one by one, and let go again where the gradient points inwards (Stark and Parker
/// 1995, Computational Statistics 10, 129). What is held is at its bound to the last digit. For a few
/// unknowns.
/// @param start within the bounds
Eigen::VectorXd bounded_least_squares(const Eigen::MatrixXd& rows, const Eigen::VectorXd& right,
                                      const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                      const Eigen::VectorXd& start);

}  // namespace pcor::internal
