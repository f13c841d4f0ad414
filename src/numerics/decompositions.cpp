#include "numerics/decompositions.hpp"

#include <limits>

namespace pcor::internal {
namespace {

/// One over the eigenvalues above `minimum`; zero for the others.
Eigen::VectorXd inverse_above(double minimum, Eigen::VectorXd eigenvalues) {
  for (double& value : eigenvalues) value = value > minimum ? 1.0 / value : 0.0;
  return eigenvalues;
}

/// Covariance as standard deviations and eigenvectors of the correlations, which do not depend on units.
struct ScaledCovariance {
  explicit ScaledCovariance(const Eigen::MatrixXd& covariance)
      : scale(covariance.diagonal().cwiseMax(0.0).cwiseSqrt()),
        inverse_scale((scale.array() > 0.0).select(scale.cwiseInverse(), 0.0)),
        correlations(inverse_scale.asDiagonal() * covariance * inverse_scale.asDiagonal()) {}

  Eigen::VectorXd scale;          ///< standard deviations
  Eigen::VectorXd inverse_scale;  ///< zero for an unknown without a variance
  SymmetricEigen correlations;
};

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
  const ScaledCovariance scaled(covariance);
  const SymmetricEigen& eigen = scaled.correlations;
  return scaled.scale.asDiagonal() * eigen.eigenvectors() *
         eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
}

Eigen::MatrixXd larger_covariance(const Eigen::MatrixXd& one, const Eigen::MatrixXd& other) {
  // With R R' = one + other over the directions in which the sum is not zero, the parts R^-1 one R'^-1 and
  // R^-1 other R'^-1 add up to one, so they have the same eigenvectors.
  const ScaledCovariance sum(one + other);
  const Eigen::VectorXd& correlations = sum.correlations.eigenvalues();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < one.rows(); ++k) {
    if (correlations[k] > rank_limit) kept.push_back(k);
  }
  if (kept.empty()) return Eigen::MatrixXd::Zero(one.rows(), one.cols());
  const Eigen::VectorXd root = correlations(kept).cwiseSqrt();
  const Eigen::MatrixXd directions = sum.correlations.eigenvectors()(Eigen::all, kept);
  const Eigen::MatrixXd white =
      root.cwiseInverse().asDiagonal() * directions.transpose() * sum.inverse_scale.asDiagonal();
  const SymmetricEigen part(white * one * white.transpose());
  const Eigen::MatrixXd axes = sum.scale.asDiagonal() * directions * root.asDiagonal() * part.eigenvectors();
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

Eigen::MatrixXd symmetric_solution(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
  return matrix.ldlt().solve(right);
}

Eigen::MatrixXd solution_of(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
  return matrix.partialPivLu().solve(right);
}

Cholesky::Cholesky(const Eigen::MatrixXd& matrix) {
  const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
  lower_ = factor.matrixL();
  is_positive_definite_ = factor.info() == Eigen::Success;
  log_determinant_ = is_positive_definite_ ? 2.0 * lower_.diagonal().array().log().sum()
                                           : std::numeric_limits<double>::quiet_NaN();
}

Eigen::VectorXd Cholesky::solve(const Eigen::VectorXd& right) const {
  return lower_.triangularView<Eigen::Lower>().adjoint().solve(whiten(right));
}

Eigen::MatrixXd Cholesky::solve(const Eigen::MatrixXd& right) const {
  return lower_.triangularView<Eigen::Lower>().adjoint().solve(whiten(right));
}

Eigen::VectorXd Cholesky::whiten(const Eigen::VectorXd& right) const {
  return lower_.triangularView<Eigen::Lower>().solve(right);
}

Eigen::MatrixXd Cholesky::whiten(const Eigen::MatrixXd& right) const {
  return lower_.triangularView<Eigen::Lower>().solve(right);
}

Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& rows, const Eigen::VectorXd& right) {
  return rows.completeOrthogonalDecomposition().solve(right);
}

}  // namespace pcor::internal
