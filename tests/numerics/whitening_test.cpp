// Whitening of noise with slow parts, against the covariance of the process written out; and what is found of
// slow noise in residuals that columns were fitted to.
#include "numerics/whitening.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

#include "numerics/median.hpp"
#include "support/bins.hpp"
#include "support/constants.hpp"

using namespace pcor::internal;
using pcor::test::bin_step;
using pcor::test::bins_of;
using pcor::test::missing;

namespace {

/// White noise of the given deviation and a first-order process of `slow` hPa with a correlation time of
/// `memory` s.
Eigen::VectorXd drifting(std::size_t count, unsigned seed, double white, double slow, double memory) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  const double keep = std::exp(-bin_step / memory);
  double drift = slow * normal(engine);
  Eigen::VectorXd values(static_cast<Eigen::Index>(count));
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    values[i] = drift + white * normal(engine);
    drift = keep * drift + std::sqrt(1.0 - keep * keep) * slow * normal(engine);
  }
  return values;
}

}  // namespace

TEST(Whitening, SlowNoiseCovarianceBecomesTheIdentity) {
  std::vector<double> residual(40, 1.0);
  residual[2] = residual[5] = missing;
  for (std::size_t i = 20; i < 30; ++i) residual[i] = missing;
  const Binning bins = bins_of(residual);
  const auto count = static_cast<Eigen::Index>(bins.size());
  for (const double coefficient : {0.0, 0.6, -0.4}) {
    NoiseModel noise;
    if (coefficient != 0.0) noise.coefficients = {coefficient};
    noise.level = {Eigen::VectorXd::LinSpaced(count, 0.3, 0.5)};
    noise.drift_component_rms = {0.4, 0.0, 0.7, 0.2};
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(count, count);
    for (const pcor::Segment& segment : bins.segments()) {
      for (std::size_t i = 0; i < segment.count; ++i) {
        for (std::size_t j = 0; j < segment.count; ++j) {
          const auto a = static_cast<Eigen::Index>(segment.first + i);
          const auto b = static_cast<Eigen::Index>(segment.first + j);
          covariance(a, b) = noise.level[0][a] * noise.level[0][b] *
                             std::pow(coefficient, std::abs(static_cast<double>(a - b))) /
                             (1.0 - coefficient * coefficient);
        }
      }
    }
    Eigen::MatrixXd slow = Eigen::MatrixXd::Zero(count, count);
    for (std::size_t k = 0; k < drift_time_constants.size(); ++k) {
      for (std::size_t i = 0; i < bins.size(); ++i) {
        for (std::size_t j = 0; j < bins.size(); ++j) {
          slow(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) +=
              noise.drift_component_rms[k] * noise.drift_component_rms[k] *
              std::exp(-std::abs(bins.time()[i] - bins.time()[j]) / drift_time_constants[k]);
        }
      }
    }
    covariance += slow;
    const Whitening whitening(bins, noise, 0);
    const Eigen::MatrixXd white = whitening(Eigen::MatrixXd::Identity(count, count));
    // Rounding of forty steps.
    EXPECT_LT((white * covariance * white.transpose() - Eigen::MatrixXd::Identity(count, count))
                  .cwiseAbs()
                  .maxCoeff(),
              1e-12);
    EXPECT_NEAR(whitening.log_determinant(), std::log(covariance.determinant()), 1e-9);
    const Eigen::VectorXd values = drifting(bins.size(), 3, 1.0, 1.0, 60.0);
    EXPECT_LT((whitening.transposed(values) - white.transpose() * values).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((whitening.slow_parts(values) - slow * covariance.ldlt().solve(values)).cwiseAbs().maxCoeff(),
              1e-12);
  }
}

TEST(Autocovariance, FollowsTheAutoregressionBeyondItsOrder) {
  const double phi = 0.7;
  const std::vector<double> first = autocovariance({phi}, 6);
  for (std::size_t lag = 0; lag < first.size(); ++lag)
    EXPECT_NEAR(first[lag], std::pow(phi, static_cast<double>(lag)) / (1.0 - phi * phi), 1e-14) << "rounding";
  // Yule and Walker's equations to rounding, with an innovation of variance one at lag zero.
  const std::vector<double> second = autocovariance({0.5, 0.3}, 5);
  EXPECT_NEAR(second[0], 0.5 * second[1] + 0.3 * second[2] + 1.0, 1e-13);
  for (std::size_t lag = 1; lag < second.size(); ++lag)
    EXPECT_NEAR(second[lag], 0.5 * second[lag - 1] + 0.3 * second[lag > 1 ? lag - 2 : 1], 1e-13) << lag;
  EXPECT_EQ(autocovariance({}, 3), (std::vector<double>{1.0, 0.0, 0.0}));
}

TEST(Whitening, PureAutoregressionIsLimitOfVanishingDrift) {
  std::vector<double> residual(60, 1.0);
  residual[2] = residual[5] = missing;  // a stretch that is shorter than the autoregression
  for (std::size_t i = 20; i < 30; ++i) residual[i] = missing;
  const Binning bins = bins_of(residual);
  const auto count = static_cast<Eigen::Index>(bins.size());
  NoiseModel noise;
  noise.coefficients = {0.5, -0.3, 0.2, 0.1};
  noise.level = {Eigen::VectorXd::LinSpaced(count, 0.3, 0.5)};
  const Whitening alone(bins, noise, 0);
  noise.drift_component_rms = {1e-7};  // share of the level, squared: 1e-13
  const Whitening vanishing(bins, noise, 0);
  // More columns than the filter takes at a time, and not a multiple of them.
  const Eigen::MatrixXd columns = Eigen::MatrixXd::Random(count, 11);
  EXPECT_LT((alone(columns) - vanishing(columns)).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_NEAR(alone.log_determinant(), vanishing.log_determinant(), 1e-9);
  const Eigen::VectorXd one = columns.col(9);
  EXPECT_EQ(alone(one), alone(columns).col(9));
  EXPECT_LT((alone.transposed(one) - vanishing.transposed(one)).cwiseAbs().maxCoeff(), 1e-9);
}

// The error of a mean under drift: what generalised least squares states is what it does, over many flights.
TEST(SlowNoise, ErrorOfAFlightMeanEqualsItsScatter) {
  constexpr std::size_t count = 1800;  // two hours
  const std::vector<Binning> bins{bins_of(std::vector<double>(count, 0.0))};
  const std::vector<Eigen::MatrixXd> columns{Eigen::MatrixXd::Ones(count, 1)};
  struct Case {
    double slow;    // hPa
    double memory;  // s
  };
  for (const Case& each : {Case{0.0, 600.0}, {0.1, 100.0}, {0.1, 300.0}, {0.1, 600.0}, {0.1, 900.0}}) {
    double squares = 0.0;
    constexpr unsigned flights = 40;
    for (unsigned seed = 1; seed <= flights; ++seed) {
      const std::vector<Eigen::VectorXd> residual{drifting(count, seed, 0.1, each.slow, each.memory)};
      const Eigen::VectorXd centred = residual[0].array() - residual[0].mean();
      const NoiseModel noise = find_noise(bins, columns, {centred}).model;
      const Whitening whitening(bins[0], noise, 0);
      const Eigen::VectorXd one = whitening(columns[0]);
      const double information = one.squaredNorm();
      const double mean = one.dot(whitening(residual[0]).col(0)) / information;
      squares += mean * mean * information;
    }
    // Forty scores determine their rms to 11 %. The time of a drift is known to a factor of two if a flight
    // holds a dozen pieces of it, and the error of a mean varies with its root.
    EXPECT_NEAR(std::sqrt(squares / flights), 1.0, 0.35) << each.slow << " hPa, " << each.memory << " s";
  }
}

// A flight of two hours holds some dozen pieces of a drift, and in some flights a long memory of the
// autoregression describes it as well: it is the flight in the middle that has its size, to a factor of 1.5.
TEST(SlowNoise, EstimatesTheSizeOfTheDrift) {
  constexpr std::size_t count = 1800;
  const std::vector<Binning> bins{bins_of(std::vector<double>(count, 0.0))};
  const std::vector<Eigen::MatrixXd> columns{Eigen::MatrixXd::Ones(count, 1)};
  for (const double memory : {100.0, 400.0}) {
    std::vector<double> sizes;
    std::vector<double> gains;
    for (unsigned seed = 1; seed <= 9; ++seed) {
      const FoundNoise found = find_noise(bins, columns, {drifting(count, seed, 0.1, 0.2, memory)});
      sizes.push_back(Eigen::Map<const Eigen::Vector4d>(found.model.drift_component_rms.data()).norm());
      gains.push_back(found.drift_gain);
      EXPECT_EQ(found.model.has_drift(), sizes.back() > 0.0);
    }
    EXPECT_NEAR(std::log(median(sizes) / 0.2), 0.0, std::log(1.5)) << memory;
    EXPECT_GT(median(gains), 30.0) << memory;
  }
}

// More than 6,000 bins are searched in wider bins. A few bins more do not change the noise, but the parts
// that these flights determine poorly differ, and with them the error of a single mean by up to a third: the
// mean over eight campaigns is known to a tenth.
TEST(SlowNoise, SearchInWideBinsStatesTheSameErrors) {
  constexpr std::size_t flights = 4;
  const auto noise_of = [](const std::vector<Eigen::VectorXd>& residuals, Eigen::Index count, double& error) {
    const Binning bins = bins_of(std::vector<double>(static_cast<std::size_t>(count), 0.0));
    const Eigen::MatrixXd column = Eigen::MatrixXd::Ones(count, 1);
    std::vector<Eigen::VectorXd> used;
    for (const Eigen::VectorXd& residual : residuals) used.emplace_back(residual.head(count));
    FoundNoise found =
        find_noise(std::vector<Binning>(flights, bins), std::vector<Eigen::MatrixXd>(flights, column), used);
    double information = 0.0;
    for (std::size_t f = 0; f < flights; ++f)
      information += Whitening(bins, found.model, f)(column).squaredNorm();
    error = 1.0 / std::sqrt(information);
    return found;
  };
  for (const double fast : {0.0, 0.1}) {
    double ratio = 0.0;
    double gain = 0.0;
    constexpr unsigned campaigns = 8;
    for (unsigned campaign = 1; campaign <= campaigns; ++campaign) {
      std::vector<Eigen::VectorXd> residuals;
      for (unsigned f = 0; f < flights; ++f) {
        const unsigned seed = 100 * campaign + f;
        residuals.emplace_back(drifting(1503, seed, 0.05, 0.1, 400.0) +
                               drifting(1503, seed + 50, 0.0, fast, 20.0));
      }
      double error = 0.0;
      double wide_error = 0.0;
      const FoundNoise narrow = noise_of(residuals, 1500, error);
      const FoundNoise wide = noise_of(residuals, 1503, wide_error);
      gain += std::log(wide.drift_gain / narrow.drift_gain) / campaigns;
      ratio += std::log(wide_error / error) / campaigns;
    }
    EXPECT_NEAR(std::exp(ratio), 1.0, 0.1) << fast;
    EXPECT_NEAR(std::exp(gain), 1.0, 0.05) << fast;
  }
}

// Twice the gain by four parts that are at their bound is below a chi2 of four degrees, of which 13 is one
// percent.
TEST(SlowNoise, GainIsSmallWithoutSlowNoise) {
  constexpr std::size_t count = 900;
  const std::vector<Binning> bins{bins_of(std::vector<double>(count, 0.0))};
  const std::vector<Eigen::MatrixXd> columns{Eigen::MatrixXd::Ones(count, 1)};
  int beyond = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const FoundNoise found = find_noise(bins, columns, {drifting(count, seed, 0.1, 0.0, 100.0)});
    EXPECT_GE(found.drift_gain, 0.0);
    beyond += found.drift_gain > 13.0 ? 1 : 0;
  }
  EXPECT_LE(beyond, 2);
}

// A wave that a column explains is not a drift; without the column it is one, and less likely.
TEST(SlowNoise, ExcludesVariationExplainedByAColumn) {
  constexpr std::size_t count = 900;
  const std::vector<Binning> bins{bins_of(std::vector<double>(count, 0.0))};
  Eigen::MatrixXd columns = Eigen::MatrixXd::Ones(count, 2);
  for (Eigen::Index i = 0; i < columns.rows(); ++i)
    columns(i, 1) = std::cos(4.0 * M_PI * static_cast<double>(i) / static_cast<double>(count));
  const Eigen::VectorXd noise = drifting(count, 7, 0.1, 0.0, 100.0);
  const FoundNoise with = find_noise(bins, {columns}, {noise + 2.0 * columns.col(1)});
  const FoundNoise without = find_noise(bins, {columns.leftCols(1)}, {noise + 2.0 * columns.col(1)});
  EXPECT_LT(with.drift_gain, 13.0);
  EXPECT_GT(without.drift_gain, 100.0);
  EXPECT_GT(with.likelihood, without.likelihood);
}
