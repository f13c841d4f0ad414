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

TEST(LargerCovariance, IsTheLargerOneAlongEachAxis) {
  // Independent unknowns in different units: the larger variance of each; without a variance: zero.
  const Eigen::Vector4d one{4.0, 1e-12, 0.0, 9.0};
  const Eigen::Vector4d other{1.0, 9e-12, 0.0, 9.0};
  const Eigen::MatrixXd larger = larger_covariance(one.asDiagonal(), other.asDiagonal());
  const Eigen::MatrixXd expected = one.cwiseMax(other).asDiagonal();
  const Eigen::VectorXd scale = expected.diagonal().cwiseSqrt();
  const Eigen::MatrixXd allowed = 1e-13 * scale * scale.transpose();  // rounding, of the standard deviations
  EXPECT_TRUE(((larger - expected).array().abs() <= allowed.array()).all());
}

// Also if both are zero along one direction, as that of a level that flights do not determine.
TEST(LargerCovariance, ExceedsBothAndNotTheirSum) {
  const Eigen::MatrixXd any = symmetric(4, 5);
  const Eigen::MatrixXd other = symmetric(4, 6);
  const Eigen::Vector4d direction{0.5, -0.1, 0.7, 0.3};
  const Eigen::Vector4d weight{1.0, 2.0, 0.5, -1.0};
  const Eigen::MatrixXd oblique =
      Eigen::MatrixXd::Identity(4, 4) - direction * weight.transpose() / weight.dot(direction);
  for (const Eigen::MatrixXd& level : {Eigen::MatrixXd(Eigen::MatrixXd::Identity(4, 4)), oblique}) {
    const Eigen::MatrixXd a = level * any * any * level.transpose();
    const Eigen::MatrixXd b = level * other * other * level.transpose();
    const Eigen::MatrixXd larger = larger_covariance(a, b);
    for (const Eigen::MatrixXd& excess :
         {Eigen::MatrixXd(larger - a), Eigen::MatrixXd(larger - b), Eigen::MatrixXd(a + b - larger)})
      EXPECT_GT(symmetric_eigenvalues(excess).minCoeff(), -1e-10) << "rank limit times elements near 10";
    EXPECT_TRUE(larger_covariance(a, 4.0 * a).isApprox(4.0 * a, 1e-10));
  }
}

}  // namespace
}  // namespace pcor::internal
