// Noise of binned residuals: whitening against the covariance of the process, written out.
#include "numerics/noise_model.hpp"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "support/bins.hpp"
#include "support/constants.hpp"

using namespace pcor::internal;
using pcor::test::bin_step;
using pcor::test::bins_of;
using pcor::test::missing;

namespace {

/// A process of second order with poles 0.5 +- 0.5i whose innovations have the deviation `level(i)`.
template <class Level>
Eigen::VectorXd second_order(std::size_t count, unsigned seed, const Level& level) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  double before = 0.0;
  double before_that = 0.0;
  Eigen::VectorXd values(static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count + 100; ++i) {
    const double value = before - 0.5 * before_that + normal(engine);
    before_that = before;
    before = value;
    if (i >= 100) values[static_cast<Eigen::Index>(i - 100)] = level(i - 100) * value;
  }
  return values;
}

/// The autocovariance of an autoregression with innovations of variance 1, from its impulse response.
std::vector<double> by_impulse_response(const std::vector<double>& coefficients, std::size_t lags) {
  constexpr std::size_t length = 2000;
  std::vector<double> response(length + lags, 0.0);
  response[0] = 1.0;
  for (std::size_t j = 1; j < response.size(); ++j) {
    for (std::size_t k = 0; k < std::min(j, coefficients.size()); ++k)
      response[j] += coefficients[k] * response[j - 1 - k];
  }
  std::vector<double> covariance(lags, 0.0);
  for (std::size_t lag = 0; lag < lags; ++lag) {
    for (std::size_t j = 0; j < length; ++j) covariance[lag] += response[j] * response[j + lag];
  }
  return covariance;
}

double autocorrelation(const Eigen::VectorXd& series, Eigen::Index lag) {
  const Eigen::Index n = series.size() - lag;
  return series.head(n).dot(series.tail(n)) / series.squaredNorm();
}

std::vector<NoiseFlight> flights(std::size_t count) {
  std::vector<NoiseFlight> all;
  for (std::size_t f = 0; f < count; ++f)
    all.push_back({86400.0 * static_cast<double>(f), f % 2 == 0 ? 900U : 2U});
  return all;
}

}  // namespace

// W C W' = 1: whitening is the inverse root of the covariance, also in stretches shorter than the order.
TEST(Whitening, CovarianceBecomesTheIdentity) {
  std::vector<double> residual(23, 1.0);
  residual[2] = residual[5] = residual[14] = missing;  // stretches of 2, 2, 8 and 8
  const Binning bins = bins_of(residual);
  ASSERT_EQ(bins.segments().size(), 4U);
  for (const std::vector<double>& coefficients :
       {std::vector<double>{}, {0.7}, {1.0, -0.5}, {0.4, 0.1, -0.3, 0.2}}) {
    NoiseModel noise;
    noise.coefficients = coefficients;
    Eigen::VectorXd level(static_cast<Eigen::Index>(bins.size()));
    for (Eigen::Index i = 0; i < level.size(); ++i) level[i] = 0.3 + 0.1 * static_cast<double>(i % 5);
    noise.level = {level};
    const std::vector<double> lags = by_impulse_response(coefficients, bins.size());
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(level.size(), level.size());
    for (const pcor::Segment& segment : bins.segments()) {
      for (std::size_t i = 0; i < segment.count; ++i) {
        for (std::size_t j = 0; j < segment.count; ++j) {
          covariance(static_cast<Eigen::Index>(segment.first + i),
                     static_cast<Eigen::Index>(segment.first + j)) = lags[i > j ? i - j : j - i];
        }
      }
    }
    covariance = level.asDiagonal() * covariance * level.asDiagonal();
    const Eigen::MatrixXd white =
        whitened(Eigen::MatrixXd::Identity(level.size(), level.size()), bins, noise, 0);
    const Eigen::MatrixXd whitened_covariance = white * covariance * white.transpose();
    // Rounding; the sums of the autocovariance are cut off at negligible terms.
    EXPECT_LT(
        (whitened_covariance - Eigen::MatrixXd::Identity(level.size(), level.size())).cwiseAbs().maxCoeff(),
        1e-10)
        << coefficients.size();
  }
}

TEST(Whitening, EstimatedNoiseBecomesWhiteWithUnitVariance) {
  constexpr std::size_t count = 3600;
  const auto level = [](std::size_t i) { return i < count / 2 ? 0.2 : 0.4; };
  const Eigen::VectorXd residual = second_order(count, 11, level);
  const std::vector<Binning> bins{bins_of(std::vector<double>(count, 0.0))};
  const NoiseModel noise = estimate_noise(bins, {residual});
  const Eigen::VectorXd white = whitened(residual, bins[0], noise, 0);
  // Of white noise an autocorrelation has the deviation 1/sqrt(n); one of eight is beyond 3 of them once in
  // fifty, and this seed is not.
  for (Eigen::Index lag = 1; lag <= 8; ++lag)
    EXPECT_LT(std::abs(autocorrelation(white, lag)), 3.0 / std::sqrt(static_cast<double>(count))) << lag;
  // A level is brought by 15 % of its logarithm towards that of the whole, a factor between 1 and 2 away:
  // (2^0.15)^2 = 1.23 at most, and the robust level of 75 innovations adds some percent.
  const Eigen::Index half = count / 2;
  EXPECT_NEAR(white.head(half).squaredNorm() / static_cast<double>(half), 1.0, 0.25);
  EXPECT_NEAR(white.tail(half).squaredNorm() / static_cast<double>(half), 1.0, 0.25);
}

TEST(NoiseModel, EstimatesCoefficientsAndLevels) {
  constexpr std::size_t count = 3600;
  const auto level = [](std::size_t i) { return i < count / 2 ? 0.2 : 0.4; };
  const std::vector<Binning> bins{bins_of(std::vector<double>(count, 0.0))};
  const NoiseModel noise = estimate_noise(bins, {second_order(count, 12, level)});
  ASSERT_GE(noise.coefficients.size(), 2U);
  // Standard errors sqrt((1 - 0.25)/3600) = 0.015; the slow noise removed by drift shapes adds the same
  // amount.
  EXPECT_NEAR(noise.coefficients[0], 1.0, 0.08);
  EXPECT_NEAR(noise.coefficients[1], -0.5, 0.08);
  const Eigen::Index half = count / 2;
  // Levels 0.2 and 0.4, brought towards one between them by up to 2^0.15 = 1.11.
  EXPECT_NEAR(noise.level[0].head(half).mean(), 0.2 * 1.055, 0.02);
  EXPECT_NEAR(noise.level[0].tail(half).mean(), 0.4 / 1.055, 0.03);
}

TEST(NoiseModel, SlowDriftDoesNotChangeTheEstimate) {
  constexpr std::size_t count = 1800;
  const std::vector<Binning> bins{bins_of(std::vector<double>(count, 0.0))};
  const auto level = [](std::size_t) { return 0.2; };
  const Eigen::VectorXd residual = second_order(count, 13, level);
  Eigen::VectorXd drifting = residual;
  for (Eigen::Index i = 0; i < drifting.size(); ++i)
    drifting[i] += 2.0 * std::sin(2.0 * M_PI * static_cast<double>(i) * bin_step / 1500.0);
  const NoiseModel without = estimate_noise(bins, {residual});
  const NoiseModel with = estimate_noise(bins, {drifting});
  ASSERT_GE(with.coefficients.size(), 2U);
  // The drift is ten times the noise; what its shapes leave of it is below a twentieth of the noise.
  EXPECT_NEAR(with.coefficients[0], without.coefficients[0], 0.03);
  EXPECT_NEAR(with.coefficients[1], without.coefficients[1], 0.03);
  EXPECT_NEAR(with.level[0].mean(), without.level[0].mean(), 0.01);
}

// A zero differs from flight to flight. The differences became a memory of many bins of the noise, so that
// the slow parts were too small. A flight may have no bin.
TEST(NoiseModel, DifferencesOfMeansDoNotChangeTheEstimate) {
  const std::vector<Binning> bins{bins_of(std::vector<double>(600, 0.0)), Binning(),
                                  bins_of(std::vector<double>(900, 0.0))};
  const auto level = [](std::size_t) { return 0.2; };
  std::vector<Eigen::VectorXd> residuals{second_order(600, 14, level), Eigen::VectorXd(),
                                         second_order(900, 15, level)};
  const NoiseModel without = estimate_noise(bins, residuals);
  residuals[0].array() += 0.9;  // the mean of all bins remains
  residuals[2].array() -= 0.6;
  const NoiseModel with = estimate_noise(bins, residuals);
  ASSERT_EQ(with.coefficients.size(), without.coefficients.size());
  constexpr double rounding = 1e-12;
  for (std::size_t k = 0; k < with.coefficients.size(); ++k)
    EXPECT_NEAR(with.coefficients[k], without.coefficients[k], rounding);
  for (const std::size_t f : {0U, 2U}) {
    EXPECT_LT((with.level[f] - without.level[f]).cwiseAbs().maxCoeff(), rounding);
    EXPECT_EQ(noise_levels(bins[f], residuals[f], with), with.level[f]);
  }
}

TEST(NoiseModel, EachFlightHasItsOwnLevel) {
  const std::vector<Binning> bins{bins_of(std::vector<double>(600, 0.0)),
                                  bins_of(std::vector<double>(900, 0.0))};
  const NoiseModel noise = estimate_noise(bins, {second_order(600, 14, [](std::size_t) { return 0.1; }),
                                                 second_order(900, 15, [](std::size_t) { return 0.3; })});
  ASSERT_EQ(noise.level.size(), 2U);
  EXPECT_EQ(noise.level[0].size(), 600);
  EXPECT_EQ(noise.level[1].size(), 900);
  // Same rule as above: 3^0.15 = 1.18, and 8 % of error.
  EXPECT_NEAR(noise.level[0].mean(), 0.11, 0.02);
  EXPECT_NEAR(noise.level[1].mean(), 0.29, 0.04);
}

TEST(NoiseModel, LevelsOfAFlightFollowFromTheSharedModel) {
  const std::vector<Binning> bins{bins_of(std::vector<double>(600, 0.0)),
                                  bins_of(std::vector<double>(900, 0.0)),
                                  bins_of(std::vector<double>(450, 0.0))};
  const auto level = [](std::size_t i) { return i % 300 < 150 ? 0.1 : 0.3; };
  const std::vector<Eigen::VectorXd> residuals{second_order(600, 14, level), second_order(900, 15, level),
                                               second_order(450, 16, level)};
  std::vector<Eigen::MatrixXd> columns;
  for (const Eigen::VectorXd& each : residuals) columns.emplace_back(Eigen::VectorXd::Ones(each.size()));
  const NoiseModel noise = find_noise(bins, columns, residuals).model;
  for (std::size_t f = 0; f < bins.size(); ++f)
    EXPECT_EQ(noise_levels(bins[f], residuals[f], noise), noise.level[f]);
  EXPECT_EQ(noise_levels(Binning(), Eigen::VectorXd(), noise).size(), 0);
}

TEST(NoiseFlights, FewFlightsAreAllUsed) {
  EXPECT_THAT(flights_for_noise(flights(3)), ::testing::ElementsAre(0, 1, 2));
  EXPECT_EQ(flights_for_noise(flights(16)).size(), 16U);
}

TEST(NoiseFlights, InformativeFlightsAreChosenFromMany) {
  for (const std::size_t count : {17U, 34U, 200U}) {
    const std::vector<NoiseFlight> all = flights(count);
    const std::vector<std::size_t> chosen = flights_for_noise(all);
    EXPECT_LE(chosen.size(), 16U);
    EXPECT_GE(chosen.size(), 8U);
    for (const std::size_t f : chosen) EXPECT_EQ(all[f].bins, 900U);
  }
}

TEST(NoiseFlights, FlightsWithoutBinsAreLeftOut) {
  std::vector<NoiseFlight> all = flights(7);
  for (const std::size_t f : {0U, 2U, 4U, 6U}) all[f].bins = 0;
  EXPECT_THAT(flights_for_noise(all, 6), ::testing::ElementsAre(1, 3, 5));
}

TEST(NoiseFlights, FewLongFlightsArePreferredToManyShortOnes) {
  std::vector<NoiseFlight> all = flights(12);
  for (const std::size_t f : {0U, 2U, 6U, 8U}) all[f].bins = 2;
  EXPECT_THAT(flights_for_noise(all, 6), ::testing::ElementsAre(4, 10));
}

TEST(NoiseFlights, LongFlightsAreFewer) {
  const auto chosen_of = [](std::size_t count, std::size_t bins, std::size_t short_flights) {
    std::vector<NoiseFlight> all = flights(count + short_flights);
    for (std::size_t f = 0; f < all.size(); ++f) all[f].bins = f < count ? bins : 10;
    std::size_t sum = 0;
    const std::vector<std::size_t> chosen = flights_for_noise(all);
    for (const std::size_t f : chosen) sum += all[f].bins;
    return std::pair(chosen.size(), sum);
  };
  EXPECT_EQ(chosen_of(16, 3000, 0), std::pair(std::size_t{16}, std::size_t{48000}));
  EXPECT_EQ(chosen_of(16, 3200, 0), std::pair(std::size_t{15}, std::size_t{48000}));
  EXPECT_EQ(chosen_of(6, 9000, 0), std::pair(std::size_t{5}, std::size_t{45000}));
  EXPECT_EQ(chosen_of(10, 20000, 0), std::pair(std::size_t{4}, std::size_t{80000}));
  EXPECT_EQ(chosen_of(3, 20000, 0), std::pair(std::size_t{3}, std::size_t{60000}));
  EXPECT_EQ(chosen_of(16, 7200, 40), std::pair(std::size_t{6}, std::size_t{43200}));
  EXPECT_EQ(chosen_of(17, 900, 0), std::pair(std::size_t{16}, std::size_t{14400}));
}

TEST(NoiseFlights, ChoiceIsIndependentOfFlightOrder) {
  std::vector<NoiseFlight> all = flights(50);
  std::mt19937 chance(1);
  std::vector<double> begins;
  for (int order = 0; order < 5; ++order) {
    std::vector<double> now;
    for (const std::size_t f : flights_for_noise(all)) now.push_back(all[f].begin);
    std::sort(now.begin(), now.end());
    if (order > 0) {
      EXPECT_EQ(now, begins);
    }
    begins = now;
    std::shuffle(all.begin(), all.end(), chance);
  }
}
