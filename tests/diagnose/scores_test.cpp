// Sums over whitened columns against generalised least squares with the covariance written out.
#include "diagnose/scores.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

using namespace pcor::internal;

using pcor::internal::Binning;
using pcor::internal::NoiseModel;
using pcor::internal::Scores;

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

  /// The covariance of noise and drift of a flight.
  Eigen::MatrixXd covariance(std::size_t flight) const {
    const Eigen::VectorXd& level = noise.level[flight];
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(level.size(), level.size());
    for (const pcor::Stretch& stretch : bins[flight].stretches()) {
      for (std::size_t i = 0; i < stretch.count; ++i) {
        for (std::size_t j = 0; j < stretch.count; ++j) {
          const auto a = static_cast<Eigen::Index>(stretch.first + i);
          const auto b = static_cast<Eigen::Index>(stretch.first + j);
          result(a, b) = level[a] * level[b] * std::pow(memory, std::abs(static_cast<double>(a - b))) /
                         (1.0 - memory * memory);
        }
      }
    }
    const Eigen::MatrixXd shapes = pcor::internal::drift_shapes(bins[flight]);
    return result + noise.drift * noise.drift * shapes * shapes.transpose();
  }
};

/// Noise of the model and drift of that size, as the model has them.
Eigen::VectorXd draw_noise(const Example& example, std::size_t flight, double drift,
                           std::mt19937_64& engine) {
  std::normal_distribution<double> normal;
  const Eigen::VectorXd& level = example.noise.level[flight];
  Eigen::VectorXd values(level.size());
  double value = normal(engine) / std::sqrt(1.0 - memory * memory);
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    values[i] = level[i] * value;
    value = memory * value + normal(engine);
  }
  const Eigen::MatrixXd shapes = pcor::internal::drift_shapes(example.bins[flight]);
  for (Eigen::Index k = 0; k < shapes.cols(); ++k) values += drift * normal(engine) * shapes.col(k);
  return values;
}

}  // namespace

TEST(Scores, AreThoseOfGeneralisedLeastSquares) {
  for (const double drift : {0.0, 0.3, 3.0}) {
    Example example({300, 150}, 4, 1);
    example.noise.drift = drift;
    const Scores scores =
        pcor::internal::find_scores(example.bins, example.columns, example.residuals, example.noise);
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(5, 5);
    for (std::size_t f = 0; f < 2; ++f) {
      Eigen::MatrixXd all(example.columns[f].rows(), 5);
      all << example.columns[f], example.residuals[f];
      expected += all.transpose() * example.covariance(f).ldlt().solve(all);
    }
    // Rounding, of matrices whose condition is 1e4 at most.
    EXPECT_TRUE(scores.information.isApprox(expected, 1e-9)) << drift;
    EXPECT_TRUE(scores.information.isApprox(scores.information.transpose(), 1e-14));
  }
}

TEST(Scores, OfBlocksAddUpToTheScore) {
  Example example({300, 150}, 4, 2);
  example.noise.drift = 0.5;
  const Scores scores =
      pcor::internal::find_scores(example.bins, example.columns, example.residuals, example.noise);
  // What is left after no coefficients has the score of the residual.
  Eigen::VectorXd score = Eigen::VectorXd::Zero(4);
  for (std::size_t f = 0; f < 2; ++f)
    score += scores.rows[f].leftCols(4).transpose() * scores.left(f, Eigen::VectorXd::Zero(4));
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
  EXPECT_EQ(scores.row_count(), example.bins[0].size() + example.bins[1].size());
}

// What drift can be says nothing any more: a column that is a drift is worth little, one that is fast is
// worth what it was.
TEST(Scores, WithDriftSlowColumnsAreWorthLittle) {
  Example example({600}, 2, 3);
  const Eigen::MatrixXd shapes = pcor::internal::drift_shapes(example.bins[0]);
  example.columns[0].col(0) = shapes.col(2);
  const Eigen::MatrixXd without =
      pcor::internal::find_scores(example.bins, example.columns, example.residuals, example.noise)
          .information;
  example.noise.drift = 1.0;
  const Eigen::MatrixXd with =
      pcor::internal::find_scores(example.bins, example.columns, example.residuals, example.noise)
          .information;
  // The coefficient of the shape has the variance of the drift: its information is below 1.
  EXPECT_LT(with(0, 0), 1.0);
  EXPECT_GT(without(0, 0), 20.0);
  EXPECT_GT(with(1, 1), 0.9 * without(1, 1));
}

TEST(LikelyDrift, FindsTheSizeOfTheDrift) {
  for (const double size : {0.15, 0.5, 1.5}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      Example example({900, 600}, 2, seed);
      std::mt19937_64 engine(100 + seed);
      for (std::size_t f = 0; f < 2; ++f) example.residuals[f] = draw_noise(example, f, size, engine);
      const pcor::internal::DriftFit fit =
          pcor::internal::likely_drift(example.bins, example.columns, example.residuals, example.noise);
      const double found = fit.size;
      const double gain = fit.gain;
      // From about ten coefficients above the noise; steps of the sizes are up to 1.9.
      EXPECT_GT(found, size / 2.2) << size << " " << seed;
      EXPECT_LT(found, size * 2.2) << size << " " << seed;
      EXPECT_GT(gain, 2.0) << size << " " << seed;
    }
  }
}

TEST(LikelyDrift, IsMostlyNoneWhereThereIsNone) {
  int found = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Example example({450}, 2, seed);
    std::mt19937_64 engine(200 + seed);
    example.residuals[0] = draw_noise(example, 0, 0.0, engine);
    const double gain =
        pcor::internal::likely_drift(example.bins, example.columns, example.residuals, example.noise).gain;
    EXPECT_GE(gain, 0.0);
    found += gain > 2.0 ? 1 : 0;
  }
  // Twice the gain is a chi2 of one degree, of which one half is at no drift: it exceeds 2 in 8 % of the
  // cases. Of 60 more than 12 are that once in 600 times.
  EXPECT_LE(found, 12);
}

TEST(LikelyDrift, IsNotWhatAColumnExplains) {
  Example example({900}, 2, 7);
  std::mt19937_64 engine(300);
  example.columns[0].col(0) = pcor::internal::drift_shapes(example.bins[0]).col(3);
  example.residuals[0] = draw_noise(example, 0, 0.0, engine) + 5.0 * example.columns[0].col(0);
  const pcor::internal::DriftFit fit =
      pcor::internal::likely_drift(example.bins, example.columns, example.residuals, example.noise);
  const double found = fit.size;
  const double gain = fit.gain;
  EXPECT_TRUE(found == 0.0 || gain < 5.0) << found;
}
