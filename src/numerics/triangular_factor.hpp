#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <vector>

namespace pcor::internal {

/// A size as Eigen counts.
inline Eigen::Index as_index(std::size_t n) { return static_cast<Eigen::Index>(n); }

/// The triangular factor R of rows (derivatives, residual), of which all that a least-squares step needs can
/// be had: rows' rows = R' R. Factors of parts add up to that of the whole.
class TriangularFactor {
 public:
  explicit TriangularFactor(Eigen::Index columns) : rows_(Eigen::MatrixXd::Zero(columns + block, columns)) {}

  /// Adds rows, each times its scale.
  void add(const Eigen::MatrixXd& rows, const Eigen::VectorXd& scale);

  /// Adds the rows of another factor.
  void add(const Eigen::MatrixXd& factor);

  Eigen::Index columns() const { return rows_.cols(); }

  /// Upper triangular, square.
  Eigen::MatrixXd factor() const;

 private:
  static constexpr Eigen::Index block = 512;

  void reduce();

  Eigen::MatrixXd rows_;
  Eigen::Index filled_ = 0;
};

/// The elements of an upper triangular square matrix that may differ from zero, column by column.
std::vector<double> upper_triangle(const Eigen::MatrixXd& matrix);

}  // namespace pcor::internal
