#include "diagnose/scores.hpp"

#include <limits>

#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

constexpr double block_time = 60.0;  // s

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
  return rows[flight].col(columns()) - rows[flight].leftCols(columns()) * coefficients;
}

Scores find_scores(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                   const std::vector<Eigen::VectorXd>& residuals, const NoiseModel& noise) {
  Scores scores;
  NoiseModel still = noise;
  still.slow = {};
  scores.information = Eigen::MatrixXd::Zero(columns.front().cols() + 1, columns.front().cols() + 1);
  scores.plain = scores.information;
  for (std::size_t f = 0; f < bins.size(); ++f) {
    const Eigen::MatrixXd all = joined(columns[f], residuals[f]);
    scores.rows.push_back(whitened(all, bins[f], noise, f));
    scores.information.selfadjointView<Eigen::Lower>().rankUpdate(scores.rows.back().transpose());
    if (noise.drifts())
      scores.plain.selfadjointView<Eigen::Lower>().rankUpdate(whitened(all, bins[f], still, f).transpose());
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
  scores.information = scores.information.selfadjointView<Eigen::Lower>();
  scores.plain = noise.drifts() ? scores.plain.selfadjointView<Eigen::Lower>() : scores.information;
  return scores;
}

}  // namespace pcor::internal
