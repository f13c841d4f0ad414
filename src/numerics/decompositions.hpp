#pragma once

#include <Eigen/Dense>

// Eigen's decompositions, compiled once: each file that names one itself pays seconds for its templates.

namespace pcor::internal {

/// Eigenvalues, ascending, and orthonormal eigenvectors of a symmetric matrix, of which the lower triangle is
/// read. Rounding errors choose the signs of the eigenvectors, and those of equal eigenvalues.
class SymmetricEigen {
 public:
  explicit SymmetricEigen(const Eigen::MatrixXd& matrix);

  const Eigen::VectorXd& eigenvalues() const { return eigenvalues_; }
  const Eigen::MatrixXd& eigenvectors() const { return eigenvectors_; }

 private:
  Eigen::VectorXd eigenvalues_;
  Eigen::MatrixXd eigenvectors_;
};

/// Eigenvalues alone, ascending, of a symmetric matrix.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix);

/// Root R of a covariance of unknowns of different orders of magnitude, R R' = C: rows scaled by standard
/// deviations, times the symmetric root of the correlations. Rows of unknowns without a variance are zero.
Eigen::MatrixXd covariance_root(const Eigen::MatrixXd& covariance);

/// The larger of two covariances of the same unknowns along each of their common principal axes: those in
/// which both are diagonal.
Eigen::MatrixXd larger_covariance(const Eigen::MatrixXd& one, const Eigen::MatrixXd& other);

/// The singular values, descending.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& matrix);

/// The combination of columns, of length 1, that changes the rows least.
Eigen::VectorXd weakest_direction(const Eigen::MatrixXd& matrix);

/// The inverse of a regular matrix.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& matrix);

/// Share of the largest eigenvalue, unknowns scaled alike, below which normal equations in double precision
/// do not determine a direction.
inline constexpr double rank_limit = 1e-11;

/// The inverse of a symmetric matrix over the directions whose eigenvalue is above `minimum`; zero over the
/// others.
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& matrix, double minimum);

/// The x of information x = right, unknowns scaled alike, over the directions above `minimum`; zero over the
/// others.
Eigen::VectorXd pseudo_solution(const Eigen::MatrixXd& information, const Eigen::VectorXd& right,
                                double minimum = rank_limit);

/// The inverse of the information on unknowns in any units, over the directions that it determines.
Eigen::MatrixXd information_inverse(const Eigen::MatrixXd& information);

/// Products of columns with each other: half the work of rows' rows.
Eigen::MatrixXd products_of(const Eigen::Ref<const Eigen::MatrixXd>& rows);

/// Products of columns after least squares by the first `count` of them, in any units.
/// @param products of all columns with each other @return those of the columns after the first `count`
Eigen::MatrixXd products_after(const Eigen::MatrixXd& products, Eigen::Index count);

/// Moore-Penrose inverse, without the directions whose singular values are zero within rounding errors.
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& matrix);

/// The X with matrix X = right, for a symmetric positive definite matrix.
Eigen::VectorXd symmetric_solution(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right);
Eigen::MatrixXd symmetric_solution(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

/// The X with matrix X = right, for a regular matrix.
Eigen::MatrixXd solution_of(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

/// Factor L of a symmetric positive definite matrix, L L' = matrix.
class Cholesky {
 public:
  explicit Cholesky(const Eigen::MatrixXd& matrix);

  /// If false, the other results have no meaning, and the logarithm of the determinant is NaN.
  bool is_positive_definite() const { return is_positive_definite_; }
  /// L; its upper triangle is zero.
  const Eigen::MatrixXd& lower() const { return lower_; }
  double log_determinant() const { return log_determinant_; }  ///< logarithm of the determinant of the matrix

  /// The X with matrix X = right.
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  /// L^-1 right, whose covariance is the identity if that of `right` is the matrix.
  Eigen::VectorXd whiten(const Eigen::VectorXd& right) const;
  Eigen::MatrixXd whiten(const Eigen::MatrixXd& right) const;

 private:
  Eigen::MatrixXd lower_;
  double log_determinant_;
  bool is_positive_definite_;
};

/// The x with the least |rows x - right|; of several the shortest.
Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& rows, const Eigen::VectorXd& right);

}  // namespace pcor::internal
