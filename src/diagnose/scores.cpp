#include "diagnose/scores.hpp"

#include <cmath>
#include <limits>
#include <utility>

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

void sum_up(Scores& scores) {
  const Eigen::Index width = scores.rows.front().cols();
  scores.information = Eigen::MatrixXd::Zero(width, width);
  for (const Eigen::MatrixXd& rows : scores.rows)
    scores.information.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  scores.information = scores.information.selfadjointView<Eigen::Lower>();
}

void take_out_common_noise(const std::vector<Binning>& bins, std::size_t earlier, std::size_t later,
                           std::vector<Eigen::VectorXd>& noise, Scores& scores) {
  constexpr double same_time = 2.0;  // s: half a bin
  constexpr std::size_t fewest = 60;
  const std::vector<double>& before = bins[earlier].time();
  const std::vector<double>& after = bins[later].time();
  std::vector<std::pair<Eigen::Index, Eigen::Index>> pairs;
  for (std::size_t i = 0, k = 0; i < before.size() && k < after.size();) {
    if (before[i] < after[k] - same_time) {
      ++i;
    } else if (after[k] < before[i] - same_time) {
      ++k;
    } else {
      pairs.emplace_back(as_index(i++), as_index(k++));
    }
  }
  if (pairs.size() < fewest) return;
  double product = 0.0;
  double squares = 0.0;
  double others = 0.0;
  for (const auto& [i, k] : pairs) {
    product += noise[earlier][i] * noise[later][k];
    squares += noise[earlier][i] * noise[earlier][i];
    others += noise[later][k] * noise[later][k];
  }
  const double correlation = product / std::sqrt(squares * others);
  if (!(std::abs(correlation) < 1.0)) return;
  const double scale = 1.0 / std::sqrt(1.0 - correlation * correlation);
  const double slope = product / squares;
  for (const auto& [i, k] : pairs) {
    scores.rows[later].row(k) -= slope * scores.rows[earlier].row(i);
    scores.rows[later].row(k) *= scale;
    noise[later][k] = scale * (noise[later][k] - slope * noise[earlier][i]);
  }
}

Scores find_scores(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                   const std::vector<Eigen::VectorXd>& residuals, const std::vector<NoiseModel>& noise) {
  Scores scores;
  scores.plain = Eigen::MatrixXd::Zero(columns.front().cols() + 1, columns.front().cols() + 1);
  for (std::size_t f = 0; f < bins.size(); ++f) {
    const Eigen::MatrixXd all = joined(columns[f], residuals[f]);
    scores.rows.push_back(whitened(all, bins[f], noise[f], 0));
    NoiseModel still = noise[f];
    still.slow = {};
    scores.plain.selfadjointView<Eigen::Lower>().rankUpdate(
        noise[f].drifts() ? Eigen::MatrixXd(whitened(all, bins[f], still, 0).transpose())
                          : Eigen::MatrixXd(scores.rows.back().transpose()));
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
  sum_up(scores);
  return scores;
}

Scores find_scores(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                   const std::vector<Eigen::VectorXd>& residuals, const NoiseModel& noise) {
  std::vector<NoiseModel> each(bins.size(), noise);
  for (std::size_t f = 0; f < bins.size(); ++f) each[f].level = {noise.level[f]};
  return find_scores(bins, columns, residuals, each);
}

}  // namespace pcor::internal
