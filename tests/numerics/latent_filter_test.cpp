#include "numerics/latent_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace pcor::internal {
namespace {

TEST(LatentFilter, EqualsTheCholeskyFactorOfTheCovariance) {
  // An Ornstein-Uhlenbeck process and a random walk, coupled, at times with gaps.
  const std::vector<double> time{0.0, 1.0, 2.0, 5.0, 6.0, 12.0};
  constexpr double noise = 0.3, memory = 4.0, walk = 0.2, start = 9.0, coupling = 0.5;
  const auto count = static_cast<Eigen::Index>(time.size());
  Eigen::MatrixXd rows(count, 2);
  for (Eigen::Index i = 0; i < count; ++i) rows.row(i) << std::sin(1.0 + 2.0 * static_cast<double>(i)), 1.0;

  LatentFilter<2> filter({1.0, start}, 2, count);
  // The processes as sums of independent normal numbers: one column for each.
  Eigen::MatrixXd state = Eigen::MatrixXd::Zero(2, 2 + 2 * count);
  state(0, 0) = 1.0;
  state(1, 1) = std::sqrt(start);
  Eigen::MatrixXd sums(count, state.cols());
  double before = 0.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double passed = time[static_cast<std::size_t>(i)] - before;
    before = time[static_cast<std::size_t>(i)];
    const double stays = std::exp(-passed / memory);
    if (passed > 0.0) {
      filter.couple(1, 0, coupling);
      filter.pass({stays, 1.0}, {1.0 - stays * stays, walk * passed});
      state.row(1) += coupling * state.row(0);
      state.row(0) *= stays;
      state(0, 2 + 2 * i) = std::sqrt(1.0 - stays * stays);
      state(1, 3 + 2 * i) = std::sqrt(walk * passed);
    }
    const Eigen::Vector2d by(1.0, i % 3 == 2 ? 0.0 : 1.0);  // some rows do not depend on the walk
    filter.read(i, rows.row(i), by, noise);
    sums.row(i) = by.transpose() * state;
  }
  Eigen::MatrixXd covariance = sums * sums.transpose();
  covariance.diagonal().array() += noise;
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  const Eigen::MatrixXd expected = factor.matrixL().solve(rows);
  EXPECT_LT((filter.white().rows - expected).cwiseAbs().maxCoeff(), 1e-12);
  const double determinant = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  EXPECT_NEAR(filter.white().log_determinant, determinant, 1e-12);
}

}  // namespace
}  // namespace pcor::internal
