#pragma once

#include <Eigen/Dense>
#include <algorithm>
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

  /// Adds `count` rows, given by columns, each row times its scale.
  void add(const std::vector<const double*>& by_columns, const double* scale, std::size_t count) {
    for (std::size_t from = 0; from < count;) {
      if (filled_ == block) reduce();
      const Eigen::Index part = std::min(block - filled_, as_index(count - from));
      const Eigen::Map<const Eigen::ArrayXd> scales(scale + from, part);
      for (Eigen::Index c = 0; c < columns(); ++c) {
        const Eigen::Map<const Eigen::ArrayXd> column(by_columns[static_cast<std::size_t>(c)] + from, part);
        rows_.col(c).segment(columns() + filled_, part) = (scales * column).matrix();
      }
      filled_ += part;
      from += static_cast<std::size_t>(part);
    }
  }

  /// Adds the rows of another factor.
  void add(const Eigen::MatrixXd& factor) {
    if (block - filled_ < columns()) reduce();
    rows_.middleRows(columns() + filled_, columns()) = factor;
    filled_ += columns();
  }

  Eigen::Index columns() const { return rows_.cols(); }

  /// Upper triangular, square.
  Eigen::MatrixXd factor() const {
    TriangularFactor copy = *this;
    copy.reduce();
    return copy.rows_.topRows(columns());
  }

 private:
  static constexpr Eigen::Index block = 512;

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

}  // namespace pcor::internal
