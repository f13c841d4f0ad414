#include "numerics/decompositions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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

// A product of a triangle with its transpose is positive definite, and its factor is the triangle.
TEST(Cholesky, SolvesWhitensAndHasTheDeterminant) {
  Eigen::Matrix3d lower;
  lower << 2.0, 0.0, 0.0, -1.0, 3.0, 0.0, 0.5, 1.0, 0.1;
  const Eigen::MatrixXd matrix = lower * lower.transpose();
  const Eigen::MatrixXd right = symmetric(3, 7);
  const Eigen::VectorXd one = right.col(1);
  const Cholesky factor(matrix);
  // Rounding errors times the condition number of the matrix, near 1e4.
  constexpr double tolerance = 1e-11;
  EXPECT_TRUE(factor.is_positive_definite());
  EXPECT_TRUE(factor.lower().isApprox(Eigen::MatrixXd(lower), tolerance));
  EXPECT_NEAR(factor.log_determinant(), 2.0 * std::log(2.0 * 3.0 * 0.1), tolerance);
  EXPECT_TRUE((matrix * factor.solve(right)).isApprox(right, tolerance));
  EXPECT_TRUE((matrix * factor.solve(one)).isApprox(one, tolerance));
  EXPECT_TRUE((lower * factor.whiten(right)).isApprox(right, tolerance));
  EXPECT_TRUE((lower * factor.whiten(one)).isApprox(one, tolerance));
  EXPECT_TRUE((matrix * symmetric_solution(matrix, right)).isApprox(right, tolerance));
  EXPECT_TRUE((lower * solution_of(Eigen::MatrixXd(lower), right)).isApprox(right, tolerance));
}

TEST(Cholesky, IndefiniteMatrix_HasNoDeterminant) {
  const Cholesky factor(Eigen::MatrixXd(Eigen::Vector3d(1.0, -1.0, 2.0).asDiagonal()));
  EXPECT_FALSE(factor.is_positive_definite());
  EXPECT_TRUE(std::isnan(factor.log_determinant()));
}

}  // namespace
}  // namespace pcor::internal
