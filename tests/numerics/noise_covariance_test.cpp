#include "numerics/noise_covariance.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "numerics/whitening.hpp"

using namespace pcor::internal;

namespace {

Binning bins_with_a_gap() {
  constexpr std::size_t records = 4 * 120;
  std::vector<double> residual(records, 0.0);
  std::vector<double> time(records);
  for (std::size_t i = 0; i < records; ++i) time[i] = static_cast<double>(i < records / 2 ? i : i + 300);
  return {residual, time, 1.0};
}

NoiseModel noise_of(const Binning& bins) {
  NoiseModel noise;
  noise.coefficients = {0.5, 0.2};
  noise.level = {Eigen::VectorXd::LinSpaced(static_cast<Eigen::Index>(bins.size()), 0.1, 0.3)};
  noise.drift_component_rms = {0.2, 0.0, 0.3, 0.0, 0.1};
  return noise;
}

}  // namespace

// Whitening divides by the root of the same covariance, so U' C U of U = C^-1 V is V' C^-1 V.
TEST(NoiseCovariance, IsInverseToWhitening) {
  const Binning bins = bins_with_a_gap();
  const NoiseModel noise = noise_of(bins);
  const Whitening whitening(bins, noise, 0);
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd v(static_cast<Eigen::Index>(bins.size()), 3);
  for (double& each : v.reshaped()) each = normal(engine);
  const Eigen::MatrixXd white = whitening(v);
  Eigen::MatrixXd u(v.rows(), v.cols());
  for (Eigen::Index c = 0; c < v.cols(); ++c) u.col(c) = whitening.transposed(white.col(c));
  const Eigen::MatrixXd expected = white.transpose() * white;
  // The tail of the autoregression is cut off after 300 bins; rounding remains.
  EXPECT_LT((noise_covariance(u, bins, noise, 0) - expected).norm(), 1e-9 * expected.norm());
}

TEST(NoiseCovariance, WhiteNoiseGivesTheSumOfSquares) {
  const Binning bins = bins_with_a_gap();
  NoiseModel noise;
  noise.level = {Eigen::VectorXd::Constant(static_cast<Eigen::Index>(bins.size()), 0.5)};
  const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(static_cast<Eigen::Index>(bins.size()), 1);
  EXPECT_NEAR(noise_covariance(ones, bins, noise, 0)(0, 0), 0.25 * static_cast<double>(bins.size()), 1e-9);
}
