#include "numerics/decompositions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

namespace pcor::internal {
namespace {

Eigen::MatrixXd symmetric(Eigen::Index size, unsigned seed) {
  std::srand(seed);
  const Eigen::MatrixXd any = Eigen::MatrixXd::Random(size, size);
  return any + any.transpose();
}

TEST(SymmetricEigen, ReproducesTheMatrix) {
  const Eigen::MatrixXd matrix = symmetric(7, 1);
  const SymmetricEigen eigen(matrix);
  const Eigen::MatrixXd again =
      eigen.eigenvectors() * eigen.eigenvalues().asDiagonal() * eigen.eigenvectors().transpose();
  EXPECT_LT((again - matrix).cwiseAbs().maxCoeff(), 1e-13) << "rounding of sums of seven terms near 1";
  EXPECT_TRUE(std::is_sorted(eigen.eigenvalues().begin(), eigen.eigenvalues().end()));
}

TEST(CovarianceRoot, SquareIsTheCovarianceForUnknownsInAnyUnits) {
  const Eigen::MatrixXd any = symmetric(5, 3);
  Eigen::VectorXd units(5);
  units << 1e-6, 1.0, 0.0, 1e5, 1e-2;
  const Eigen::MatrixXd covariance = units.asDiagonal() * any * any * units.asDiagonal();
  const Eigen::MatrixXd root = covariance_root(covariance);
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt();
  const Eigen::MatrixXd allowed = 1e-13 * scale * scale.transpose();  // rounding, of the standard deviations
  EXPECT_TRUE(((root * root.transpose() - covariance).array().abs() <= allowed.array()).all());
}

}  // namespace
}  // namespace pcor::internal
