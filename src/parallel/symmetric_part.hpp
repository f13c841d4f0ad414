#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <utility>

#include "parallel/packed.hpp"

namespace pcor::internal {

/// A column of a square matrix from the diagonal on, to be packed.
template <class Matrix>
auto from_diagonal(Matrix& matrix, Eigen::Index column) {
  return cereal::binary_data(matrix.col(column).data() + column,
                             static_cast<std::size_t>(matrix.rows() - column) * sizeof(double));
}

/// A symmetric matrix that a flight has in a sum over all flights. As bytes it is its lower triangle.
struct SymmetricPart {
  Eigen::MatrixXd matrix{};

  SymmetricPart() = default;
  explicit SymmetricPart(Eigen::MatrixXd symmetric) : matrix(std::move(symmetric)) {}

  SymmetricPart& operator+=(const SymmetricPart& other) {
    matrix += other.matrix;
    return *this;
  }

  template <class Archive>
  void save(Archive& archive) const {
    archive(matrix.cols());
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) archive(from_diagonal(matrix, c));
  }

  template <class Archive>
  void load(Archive& archive) {
    Eigen::Index width = 0;
    archive(width);
    matrix.resize(width, width);
    for (Eigen::Index c = 0; c < width; ++c) archive(from_diagonal(matrix, c));
    matrix = Eigen::MatrixXd(matrix.selfadjointView<Eigen::Lower>());
  }
};

}  // namespace pcor::internal
