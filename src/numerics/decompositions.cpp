#include "numerics/decompositions.hpp"

namespace pcor::internal {

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix) { return SymmetricEigen(matrix); }

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix) {
  return SymmetricEigen(matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::VectorXd singular_values(const Eigen::MatrixXd& matrix) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(matrix).singularValues();
}

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& matrix) { return matrix.inverse(); }

Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& matrix, double least) {
  if (matrix.rows() == 0) return matrix;
  const SymmetricEigen solver(matrix);
  Eigen::VectorXd inverse = solver.eigenvalues();
  for (double& value : inverse) value = value > least ? 1.0 / value : 0.0;
  return solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
}

Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& matrix) {
  return matrix.completeOrthogonalDecomposition().pseudoInverse();
}

Eigen::VectorXd symmetric_solution(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right) {
  return matrix.ldlt().solve(right);
}

Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& rows, const Eigen::VectorXd& right) {
  return rows.completeOrthogonalDecomposition().solve(right);
}

}  // namespace pcor::internal
