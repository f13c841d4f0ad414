#pragma once

#include <Eigen/Dense>

namespace pcor::internal {

/// The inverse of a symmetric matrix over the directions whose eigenvalue is above `least`; zero over the
/// others.
inline Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& matrix, double least) {
  if (matrix.rows() == 0) return matrix;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  Eigen::VectorXd inverse = solver.eigenvalues();
  for (double& value : inverse) value = value > least ? 1.0 / value : 0.0;
  return solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace pcor::internal
