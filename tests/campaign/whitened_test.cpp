// Sums over whitened columns against generalised least squares with the covariance written out.
#include "campaign/whitened.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "support/thread_communicator.hpp"

using namespace pcor::internal;
using pcor::FlightPartition;

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();
constexpr double step = 4.0;  // s: every record is a bin
constexpr double memory = 0.6;

/// Some bins with gaps, columns and residuals, all at random.
struct Example {
  std::vector<Binning> bins;
  std::vector<Eigen::MatrixXd> columns;
  std::vector<Eigen::VectorXd> residuals;
  NoiseModel noise;

  Example(std::vector<std::size_t> sizes, Eigen::Index width, unsigned seed) {
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> normal;
    const auto draw = [&](Eigen::Index, Eigen::Index) { return normal(engine); };
    for (const std::size_t size : sizes) {
      std::vector<double> given(size, 0.0);
      std::vector<double> time(size);
      for (std::size_t i = 0; i < size; ++i) {
        time[i] = step * static_cast<double>(i);
        if (i % 67 == 40) given[i] = missing;
      }
      const Binning& made = bins.emplace_back(given, time, step);
      const auto rows = static_cast<Eigen::Index>(made.size());
      columns.emplace_back(Eigen::MatrixXd::NullaryExpr(rows, width, draw));
      residuals.emplace_back(Eigen::MatrixXd::NullaryExpr(rows, 1, draw));
      Eigen::VectorXd level(rows);
      for (Eigen::Index i = 0; i < rows; ++i) level[i] = i < rows / 2 ? 0.2 : 0.5;
      noise.level.push_back(level);
    }
    noise.coefficients = {memory};
  }

  WhitenedSystem system() const {
    return whiten_system(FlightPartition(bins.size()), bins, columns, residuals, noise);
  }

  /// The covariance of the noise of a flight.
  Eigen::MatrixXd covariance(std::size_t flight) const {
    const Eigen::VectorXd& level = noise.level[flight];
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(level.size(), level.size());
    for (const pcor::Segment& segment : bins[flight].segments()) {
      for (std::size_t i = 0; i < segment.count; ++i) {
        for (std::size_t j = 0; j < segment.count; ++j) {
          const auto a = static_cast<Eigen::Index>(segment.first + i);
          const auto b = static_cast<Eigen::Index>(segment.first + j);
          result(a, b) = level[a] * level[b] * std::pow(memory, std::abs(static_cast<double>(a - b))) /
                         (1.0 - memory * memory);
        }
      }
    }
    const std::vector<double>& time = bins[flight].time();
    for (Eigen::Index a = 0; a < level.size(); ++a) {
      for (Eigen::Index b = 0; b < level.size(); ++b) {
        const double apart = std::abs(time[static_cast<std::size_t>(a)] - time[static_cast<std::size_t>(b)]);
        for (std::size_t k = 0; k < drift_time_constants.size(); ++k)
          result(a, b) += noise.drift_component_rms[k] * noise.drift_component_rms[k] *
                          std::exp(-apart / drift_time_constants[k]);
      }
    }
    return result;
  }
};

}  // namespace

TEST(WhitenedSystem, EqualsGeneralisedLeastSquares) {
  const auto expected = [](const Example& example) {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(5, 5);
    for (std::size_t f = 0; f < 2; ++f) {
      Eigen::MatrixXd all(example.columns[f].rows(), 5);
      all << example.columns[f], example.residuals[f];
      sum += all.transpose() * example.covariance(f).ldlt().solve(all);
    }
    return sum;
  };
  for (const double drift : {0.0, 0.3, 3.0}) {
    Example example({300, 150}, 4, 1);
    example.noise.drift_component_rms = {0.5 * drift, 0.0, drift, 0.2 * drift};
    const WhitenedSystem scores = example.system();
    // Rounding, of matrices whose condition is 1e5 at most.
    EXPECT_TRUE(scores.information.isApprox(expected(example), 1e-9)) << drift;
    EXPECT_TRUE(scores.information.isApprox(scores.information.transpose(), 1e-14));
    example.noise.drift_component_rms = {};
    EXPECT_TRUE(scores.plain.isApprox(expected(example), 1e-9)) << drift;
    EXPECT_TRUE(scores.plain.isApprox(scores.plain.transpose(), 1e-14));
  }
}

TEST(WhitenedSystem, BlockScoresSumToTotalScore) {
  Example example({300, 150}, 4, 2);
  example.noise.drift_component_rms = {0.0, 0.5, 0.0, 0.0};
  const WhitenedSystem scores = example.system();
  // The residual without coefficients has the score of the input residual.
  const std::vector<Eigen::VectorXd> residuals = scores.residuals_after(Eigen::VectorXd::Zero(4));
  Eigen::VectorXd score = Eigen::VectorXd::Zero(4);
  for (std::size_t f = 0; f < 2; ++f) score += scores.rows[f].leftCols(4).transpose() * residuals[f];
  EXPECT_TRUE(score.isApprox(scores.information.col(4).head(4), 1e-9));
  // 20 and 10 minutes, where gaps of a bin may end a minute late.
  EXPECT_GE(scores.blocks, 28);
  EXPECT_LE(scores.blocks, 31);
  for (std::size_t f = 0; f < 2; ++f) {
    ASSERT_EQ(scores.block[f].size(), example.bins[f].size());
    for (std::size_t i = 1; i < scores.block[f].size(); ++i)
      EXPECT_GE(scores.block[f][i], scores.block[f][i - 1]);
  }
  EXPECT_GT(scores.block[1].front(), scores.block[0].back());
  EXPECT_EQ(scores.row_count, example.bins[0].size() + example.bins[1].size());
}

// Averaging over coefficients of unit variance adds the products of their columns to the covariance of the
// noise.
TEST(WhitenedSystem, MarginalizedColumnsAddToNoiseCovariance) {
  const Example example({200}, 5, 4);
  WhitenedSystem system = example.system();
  marginalize(system, 2);
  const Eigen::MatrixXd uncertain = example.columns[0].rightCols(2);
  const Eigen::MatrixXd covariance = example.covariance(0) + uncertain * uncertain.transpose();
  Eigen::MatrixXd all(example.columns[0].rows(), 4);
  all << example.columns[0].leftCols(3), example.residuals[0];
  // Rounding, of matrices whose condition is 1e5 at most.
  EXPECT_TRUE(system.information.isApprox(all.transpose() * covariance.ldlt().solve(all), 1e-9));
  Example fewer = example;
  fewer.columns[0].conservativeResize(Eigen::NoChange, 3);
  EXPECT_TRUE(system.plain.isApprox(fewer.system().plain, 1e-12));
  EXPECT_EQ(system.rows[0].cols(), 4);
}

// Shapes of drift carry little information: a column that is a drift has little weight, a fast one keeps its
// weight.
TEST(WhitenedSystem, DriftReducesInformationOfSlowColumns) {
  Example example({600}, 2, 3);
  for (Eigen::Index i = 0; i < example.columns[0].rows(); ++i)
    example.columns[0](i, 0) = std::cos(3.0 * M_PI * example.bins[0].time()[static_cast<std::size_t>(i)] /
                                        example.bins[0].time().back());
  const WhitenedSystem without = example.system();
  example.noise.drift_component_rms = {0.0, 0.0, 1.0, 0.0};
  const WhitenedSystem with = example.system();
  // Forty minutes hold a few pieces of a drift of 800 s and 1 hPa: the coefficient of a wave is known to a
  // few tenths of it.
  EXPECT_LT(with.information(0, 0), 20.0);
  EXPECT_GT(without.information(0, 0), 200.0);
  // For a column without correlation a drift that is slower than two minutes hides a tenth at most.
  EXPECT_GT(with.information(1, 1), 0.8 * without.information(1, 1));
  EXPECT_NEAR(with.plain(0, 0), without.information(0, 0), 1e-9 * without.information(0, 0));
}

TEST(RobustDeviation, EqualsThatOfOneListForEachPartition) {
  // For an even count the median is the upper middle value.
  const std::vector<Eigen::VectorXd> of_flights{Eigen::Vector3d(-4.0, missing, 1.0), Eigen::VectorXd(),
                                                Eigen::Vector2d(2.0, -3.0)};
  for (const std::size_t size : {1U, 2U, 3U, 4U}) {
    pcor::test::run_with_communicator(size, [&](pcor::Communicator& comm) {
      std::vector<Eigen::VectorXd> local;
      for (std::size_t flight = comm.rank(); flight < of_flights.size(); flight += size)
        local.push_back(of_flights[flight]);
      // Two roundings: 1.4826 is 1 over the quantile of the normal distribution at 0.75.
      EXPECT_NEAR(robust_deviation(comm, local), 3.0 / 0.674489750196082, 1e-14);
      EXPECT_TRUE(std::isnan(robust_deviation(comm, {})));
    });
  }
}
