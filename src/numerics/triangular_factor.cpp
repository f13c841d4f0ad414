#include "numerics/triangular_factor.hpp"

#include <algorithm>

namespace pcor::internal {

void TriangularFactor::add(const Eigen::MatrixXd& rows, const Eigen::VectorXd& scale) {
  for (Eigen::Index from = 0; from < rows.rows();) {
    if (filled_ == block) reduce();
    const Eigen::Index part = std::min(block - filled_, rows.rows() - from);
    rows_.middleRows(columns() + filled_, part) =
        scale.segment(from, part).asDiagonal() * rows.middleRows(from, part);
    filled_ += part;
    from += part;
  }
}

void TriangularFactor::add(const Eigen::MatrixXd& factor) {
  if (block - filled_ < columns()) reduce();
  rows_.middleRows(columns() + filled_, columns()) = factor;
  filled_ += columns();
}

Eigen::MatrixXd TriangularFactor::factor() const {
  TriangularFactor copy = *this;
  copy.reduce();
  return copy.rows_.topRows(columns());
}

void TriangularFactor::reduce() {
  if (filled_ == 0) return;
  const Eigen::Index used = columns() + filled_;
  const Eigen::HouseholderQR<Eigen::MatrixXd> decomposition(rows_.topRows(used));
  rows_.topRows(columns()) = decomposition.matrixQR().topRows(columns()).triangularView<Eigen::Upper>();
  filled_ = 0;
}

std::vector<double> upper_triangle(const Eigen::MatrixXd& matrix) {
  std::vector<double> elements;
  for (Eigen::Index column = 0; column < matrix.cols(); ++column)
    elements.insert(elements.end(), matrix.col(column).data(), matrix.col(column).data() + column + 1);
  return elements;
}

}  // namespace pcor::internal
