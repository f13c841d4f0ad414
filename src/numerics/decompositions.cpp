#include "numerics/decompositions.hpp"

namespace pcor::internal {
namespace {

/// One over the eigenvalues above `minimum`; zero for the others.
Eigen::VectorXd inverse_above(double minimum, Eigen::VectorXd eigenvalues) {
  for (double& value : eigenvalues) value = value > minimum ? 1.0 / value : 0.0;
  return eigenvalues;
}

}  // namespace

SymmetricEigen::SymmetricEigen(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  eigenvalues_ = solver.eigenvalues();
  eigenvectors_ = solver.eigenvectors();
}

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::MatrixXd covariance_root(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = (scale.array() > 0.0).select(scale.cwiseInverse(), 0.0);
  const SymmetricEigen eigen(inverse.asDiagonal() * covariance * inverse.asDiagonal());
  return scale.asDiagonal() * eigen.eigenvectors() *
         eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
}

Eigen::MatrixXd larger_covariance(const Eigen::MatrixXd& one, const Eigen::MatrixXd& other) {
  // With R R' = one + other over the directions in which the sum is not zero, the parts R^-1 one R'^-1 and
  // R^-1 other R'^-1 add up to one, so they have the same eigenvectors.
  const Eigen::MatrixXd sum = one + other;
  const Eigen::VectorXd scale = sum.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = (scale.array() > 0.0).select(scale.cwiseInverse(), 0.0);
  const SymmetricEigen correlations(inverse.asDiagonal() * sum * inverse.asDiagonal());
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < sum.rows(); ++k) {
    if (correlations.eigenvalues()[k] > rank_limit) kept.push_back(k);
  }
  if (kept.empty()) return Eigen::MatrixXd::Zero(sum.rows(), sum.cols());
  const Eigen::VectorXd root = correlations.eigenvalues()(kept).cwiseSqrt();
  const Eigen::MatrixXd directions = correlations.eigenvectors()(Eigen::all, kept);
  const Eigen::MatrixXd white =
      root.cwiseInverse().asDiagonal() * directions.transpose() * inverse.asDiagonal();
  const SymmetricEigen part(white * one * white.transpose());
  const Eigen::MatrixXd axes = scale.asDiagonal() * directions * root.asDiagonal() * part.eigenvectors();
  const Eigen::VectorXd larger = part.eigenvalues().cwiseMax((1.0 - part.eigenvalues().array()).matrix());
  return axes * larger.asDiagonal() * axes.transpose();
}

Eigen::VectorXd singular_values(const Eigen::MatrixXd& matrix) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(matrix).singularValues();
}

Eigen::VectorXd weakest_direction(const Eigen::MatrixXd& matrix) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(matrix, Eigen::ComputeFullV).matrixV().rightCols(1);
}

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& matrix) { return matrix.inverse(); }

Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& matrix, double minimum) {
  if (matrix.rows() == 0) return matrix;
  const SymmetricEigen solver(matrix);
  return solver.eigenvectors() * inverse_above(minimum, solver.eigenvalues()).asDiagonal() *
         solver.eigenvectors().transpose();
}

Eigen::VectorXd pseudo_solution(const Eigen::MatrixXd& information, const Eigen::VectorXd& right,
                                double minimum) {
  if (information.rows() == 0) return right;
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const SymmetricEigen solver(scale.asDiagonal() * information * scale.asDiagonal());
  return scale.asDiagonal() *
         (solver.eigenvectors() * (inverse_above(minimum, solver.eigenvalues()).asDiagonal() *
                                   (solver.eigenvectors().transpose() * (scale.asDiagonal() * right))));
}

Eigen::MatrixXd information_inverse(const Eigen::MatrixXd& information) {
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() *
         pseudo_inverse(scale.asDiagonal() * information * scale.asDiagonal(), rank_limit) *
         scale.asDiagonal();
}

Eigen::MatrixXd products_of(const Eigen::Ref<const Eigen::MatrixXd>& rows) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(rows.cols(), rows.cols());
  result.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  return result.selfadjointView<Eigen::Lower>();
}

Eigen::MatrixXd products_after(const Eigen::MatrixXd& products, Eigen::Index count) {
  const Eigen::Index rest = products.cols() - count;
  const Eigen::MatrixXd across = products.topRightCorner(count, rest);
  return products.bottomRightCorner(rest, rest) -
         across.transpose() * (information_inverse(products.topLeftCorner(count, count)) * across);
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
