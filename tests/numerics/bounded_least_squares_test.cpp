#include "numerics/bounded_least_squares.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

using namespace pcor::internal;

namespace {

/// The least squares of all ways to hold unknowns at a bound or leave them free: slow and sure.
double least_of_all_ways(const Eigen::MatrixXd& rows, const Eigen::VectorXd& right,
                         const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
  const Eigen::Index size = rows.cols();
  long ways = 1;
  for (Eigen::Index k = 0; k < size; ++k) ways *= 3;
  double minimum = std::numeric_limits<double>::infinity();
  for (long way = 0; way < ways; ++way) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(size);
    std::vector<Eigen::Index> free;
    long rest = way;
    for (Eigen::Index k = 0; k < size; ++k, rest /= 3) {
      if (rest % 3 == 0) free.push_back(k);
      if (rest % 3 == 1) x[k] = lower[k];
      if (rest % 3 == 2) x[k] = upper[k];
    }
    if (!free.empty()) {
      const Eigen::VectorXd solution = rows(Eigen::all, free).colPivHouseholderQr().solve(right - rows * x);
      for (std::size_t i = 0; i < free.size(); ++i) x[free[i]] = solution[static_cast<Eigen::Index>(i)];
    }
    if ((x.array() >= lower.array()).all() && (x.array() <= upper.array()).all())
      minimum = std::min(minimum, (rows * x - right).squaredNorm());
  }
  return minimum;
}

}  // namespace

TEST(BoundedLeastSquares, IsTheMinimumOverAllActiveSets) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Index size = 1 + trial % 5;
    Eigen::MatrixXd rows(size + 3, size);
    Eigen::VectorXd right(size + 3);
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      right[i] = 3.0 * normal(engine);
      for (Eigen::Index k = 0; k < size; ++k) rows(i, k) = normal(engine);
      // Nearly collinear columns in every other trial.
      if (trial % 2 == 0 && size > 1) rows(i, 1) = rows(i, 0) + 1e-3 * rows(i, 1);
    }
    const Eigen::VectorXd lower = Eigen::VectorXd::Constant(size, -0.7);
    const Eigen::VectorXd upper = Eigen::VectorXd::Constant(size, 0.4);
    const Eigen::VectorXd x =
        pcor::internal::bounded_least_squares(rows, right, lower, upper, Eigen::VectorXd::Zero(size));
    EXPECT_TRUE((x.array() >= lower.array()).all() && (x.array() <= upper.array()).all());
    for (const double each : x) {
      for (const double bound : {-0.7, 0.4}) EXPECT_TRUE(each == bound || std::abs(each - bound) > 1e-14);
    }
    EXPECT_NEAR((rows * x - right).squaredNorm(), least_of_all_ways(rows, right, lower, upper), 1e-8)
        << trial;
  }
}

TEST(BoundedLeastSquares, WithoutBoundsEqualsLeastSquares) {
  const double infinity = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd rows(3, 2);
  rows << 1.0, 0.0, 0.0, 2.0, 1.0, 1.0;
  const Eigen::VectorXd right = Eigen::Vector3d(1.0, 2.0, 5.0);
  const Eigen::VectorXd x =
      pcor::internal::bounded_least_squares(rows, right, Eigen::Vector2d::Constant(-infinity),
                                            Eigen::Vector2d::Constant(infinity), Eigen::Vector2d::Zero());
  EXPECT_TRUE(x.isApprox(rows.colPivHouseholderQr().solve(right), 1e-12));
}
