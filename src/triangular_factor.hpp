#pragma once

#include <Eigen/Dense>
#include <cstddef>

namespace pcor {

/// The triangular factor R of rows (derivatives, residual), of which all that a least-squares step needs can
/// be had: rows' rows = R' R. Factors of parts add up to that of the whole.
class TriangularFactor {
 public:
  explicit TriangularFactor(Eigen::Index columns) : rows_(Eigen::MatrixXd::Zero(columns + block, columns)) {}

  /// The place for the next row. Write all its columns.
  auto next_row() {
    if (filled_ == block) reduce();
    return rows_.row(columns() + filled_++);
  }

  void add(const TriangularFactor& other) {
    const Eigen::MatrixXd factor = other.factor();
    for (Eigen::Index i = 0; i < factor.rows(); ++i) next_row() = factor.row(i);
  }

  Eigen::Index columns() const { return rows_.cols(); }

  /// Upper triangular, square.
  Eigen::MatrixXd factor() const {
    TriangularFactor copy = *this;
    copy.reduce();
    return copy.rows_.topRows(columns());
  }

 private:
  static constexpr Eigen::Index block = 256;

  void reduce() {
    if (filled_ == 0) return;
    const Eigen::Index used = columns() + filled_;
    const Eigen::HouseholderQR<Eigen::MatrixXd> decomposition(rows_.topRows(used));
    rows_.topRows(columns()) = decomposition.matrixQR().topRows(columns()).triangularView<Eigen::Upper>();
    filled_ = 0;
  }

  Eigen::MatrixXd rows_;
  Eigen::Index filled_ = 0;
};

}  // namespace pcor
