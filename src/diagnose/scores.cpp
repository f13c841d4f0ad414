#include "diagnose/scores.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "numerics/decompositions.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

constexpr double block_time = 60.0;  // s

/// Whitened drift of a flight, its shapes turned so that they do not overlap.
struct WhitenedDrift {
  Eigen::MatrixXd shapes;
  Eigen::VectorXd squares;  // of each turned shape

  explicit WhitenedDrift(const Binning& bins, const NoiseModel& noise, std::size_t flight) {
    const Eigen::MatrixXd white = whitened(drift_shapes(bins), bins, noise, flight);
    if (white.cols() == 0) {  // too short for any
      shapes = white;
      return;
    }
    const SymmetricEigen solver = symmetric_eigen(white.transpose() * white);
    shapes = white * solver.eigenvectors();
    squares = solver.eigenvalues().cwiseMax(0.0);
  }

  /// By how much each shape is taken off for a drift of that variance.
  Eigen::VectorXd shares(double variance) const {
    return (variance / (1.0 + variance * squares.array())).matrix();
  }
};

Eigen::MatrixXd joined(const Eigen::MatrixXd& columns, const Eigen::VectorXd& residual) {
  Eigen::MatrixXd all(columns.rows(), columns.cols() + 1);
  all << columns, residual;
  return all;
}

}  // namespace

std::size_t Scores::row_count() const {
  std::size_t count = 0;
  for (const Eigen::MatrixXd& part : rows) count += static_cast<std::size_t>(part.rows());
  return count;
}

Eigen::VectorXd Scores::left(std::size_t flight, const Eigen::VectorXd& coefficients) const {
  Eigen::VectorXd result = rows[flight].col(columns()) - rows[flight].leftCols(columns()) * coefficients;
  if (drift[flight].cols() > 0)
    result -= drift[flight] * (shares[flight].asDiagonal() * (drift[flight].transpose() * result)).eval();
  return result;
}

Scores find_scores(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                   const std::vector<Eigen::VectorXd>& residuals, const NoiseModel& noise) {
  Scores scores;
  const Eigen::Index width = columns.front().cols() + 1;
  scores.information = Eigen::MatrixXd::Zero(width, width);
  scores.plain = Eigen::MatrixXd::Zero(width, width);
  for (std::size_t f = 0; f < bins.size(); ++f) {
    scores.rows.push_back(whitened(joined(columns[f], residuals[f]), bins[f], noise, f));
    const Eigen::MatrixXd& rows = scores.rows.back();
    scores.plain.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
    if (noise.drift > 0.0) {
      WhitenedDrift drift(bins[f], noise, f);
      scores.shares.push_back(drift.shares(noise.drift * noise.drift));
      const Eigen::MatrixXd overlap = drift.shapes.transpose() * rows;
      scores.information -= overlap.transpose() * scores.shares.back().asDiagonal() * overlap;
      scores.drift.push_back(std::move(drift.shapes));
    } else {
      scores.drift.emplace_back(rows.rows(), 0);
      scores.shares.emplace_back(0);
    }
    std::vector<Eigen::Index>& block = scores.block.emplace_back();
    double begin = -std::numeric_limits<double>::infinity();
    for (const double time : bins[f].time()) {
      if (time >= begin + block_time) {
        begin = time;
        ++scores.blocks;
      }
      block.push_back(scores.blocks - 1);
    }
  }
  scores.plain = scores.plain.selfadjointView<Eigen::Lower>();
  scores.information += scores.plain;
  return scores;
}

DriftFit likely_drift(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                      const std::vector<Eigen::VectorXd>& residuals, const NoiseModel& noise) {
  constexpr std::array<double, 13> sizes{0.0, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15,
                                         0.2, 0.3,  0.5,  0.8,  1.5,  3.0};
  const Eigen::Index width = columns.front().cols();
  std::vector<Eigen::MatrixXd> rows;
  std::vector<WhitenedDrift> drifts;
  std::vector<Eigen::MatrixXd> overlaps;
  Eigen::MatrixXd plain = Eigen::MatrixXd::Zero(width + 1, width + 1);
  double count = 0.0;
  for (std::size_t f = 0; f < bins.size(); ++f) {
    const Eigen::MatrixXd part = whitened(joined(columns[f], residuals[f]), bins[f], noise, f);
    drifts.emplace_back(bins[f], noise, f);
    overlaps.push_back(drifts.back().shapes.transpose() * part);
    plain += part.transpose() * part;
    count += static_cast<double>(part.rows());
  }
  double best = -std::numeric_limits<double>::infinity();
  double none = 0.0;
  DriftFit result;
  for (const double size : sizes) {
    Eigen::MatrixXd information = plain;
    double log_determinant = 0.0;
    for (std::size_t f = 0; f < bins.size(); ++f) {
      information -= overlaps[f].transpose() * drifts[f].shares(size * size).asDiagonal() * overlaps[f];
      log_determinant += (1.0 + size * size * drifts[f].squares.array()).log().sum();
    }
    // The square root of the diagonal makes columns of any unit alike.
    const Eigen::VectorXd scale =
        information.diagonal().head(width).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    double explained = 0.0;
    double restricted = 0.0;
    if (width > 0) {
      const Eigen::MatrixXd normal =
          scale.asDiagonal() * information.topLeftCorner(width, width) * scale.asDiagonal();
      const Eigen::LDLT<Eigen::MatrixXd> solver(normal);
      const Eigen::VectorXd right = scale.asDiagonal() * information.col(width).head(width);
      explained = right.dot(solver.solve(right));
      restricted = solver.vectorD().cwiseMax(1e-12).array().log().sum() - 2.0 * scale.array().log().sum();
    }
    const double squares = information(width, width) - explained;
    const double freedom = count - static_cast<double>(width);
    const double likelihood = -freedom * std::log(squares / count) - log_determinant - restricted;
    if (size == 0.0) none = likelihood;
    if (likelihood > best) {
      best = likelihood;
      result.size = size;
      result.likelihood = -count * std::log(squares / count) - log_determinant;
    }
  }
  result.gain = best - none;
  return result;
}

}  // namespace pcor::internal
