#include "diagnose/structure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "diagnose/scores.hpp"
#include "numerics/chi_squared.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/median.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

constexpr std::size_t most_columns = 6;
constexpr std::size_t bins_per_column = 40;
constexpr double most_missing = 0.1;
constexpr double least_left = 1e-3;  // of a direction, by the model

}  // namespace

StructureTest::StructureTest(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                             const std::vector<Eigen::VectorXd>& residuals, const NoiseModel& noise)
    : bins_(&bins), noise_(&noise) {
  const Scores scores = find_scores(bins, columns, residuals, noise);
  const Eigen::Index width = scores.columns();
  scale_ = scores.information.diagonal().head(width).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  inverse_ = pseudo_inverse(
      scale_.asDiagonal() * scores.information.topLeftCorner(width, width) * scale_.asDiagonal(), 1e-12);
  const Eigen::VectorXd right = scale_.asDiagonal() * scores.information.col(width).head(width);
  const Eigen::VectorXd solution = scale_.asDiagonal() * (inverse_ * right);
  squares_ = scores.information(width, width) - right.dot(inverse_ * right);
  variance_ = squares_ / std::max(1.0, static_cast<double>(scores.row_count()) - static_cast<double>(width));
  block_ = scores.block;
  blocks_ = scores.blocks;
  for (std::size_t f = 0; f < bins.size(); ++f) {
    model_.emplace_back(scores.rows[f].leftCols(width));
    left_.push_back(scores.left(f, solution));
  }
}

Smooth StructureTest::smooth_of(const std::vector<const double*>& values) const {
  std::vector<double> all;
  std::size_t rows = 0;
  for (std::size_t f = 0; f < bins_->size(); ++f) {
    for (const std::size_t record : (*bins_)[f].records()) all.push_back(values[f][record]);
    rows += (*bins_)[f].size();
  }
  const auto missing = std::count_if(all.begin(), all.end(), [](double x) { return !std::isfinite(x); });
  if (static_cast<double>(missing) > most_missing * static_cast<double>(all.size())) all.clear();
  return {std::move(all), std::clamp(rows / bins_per_column, std::size_t{1}, most_columns)};
}

std::vector<Eigen::MatrixXd> StructureTest::columns_of(const std::vector<const double*>& values) const {
  return columns_of(smooth_of(values), values);
}

std::vector<Eigen::MatrixXd> StructureTest::columns_of(const Smooth& smooth,
                                                       const std::vector<const double*>& values) const {
  const Eigen::Index count = as_index(smooth.columns());
  std::vector<double> functions(smooth.columns());
  std::vector<Eigen::MatrixXd> columns;
  for (std::size_t f = 0; f < bins_->size(); ++f) {
    const Binning& bins = (*bins_)[f];
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(as_index(bins.size()), count);
    Eigen::VectorXd counts = Eigen::VectorXd::Zero(as_index(bins.size()));
    double last = smooth.centre();
    for (std::size_t k = 0; k < bins.records().size(); ++k) {
      const double value = values[f][bins.records()[k]];
      if (std::isfinite(value)) last = value;
      smooth.evaluate(last, functions.data());
      sums.row(bins.bins()[k]) += Eigen::Map<const Eigen::RowVectorXd>(functions.data(), count);
      counts[bins.bins()[k]] += 1.0;
    }
    columns.emplace_back(counts.cwiseInverse().asDiagonal() * sums);
  }
  return columns;
}

bool StructureTest::add(const std::string& name, const std::vector<const double*>& values) {
  const Smooth smooth = smooth_of(values);
  const Eigen::Index count = as_index(smooth.columns());
  if (count == 0) return false;
  const std::vector<Eigen::MatrixXd> columns = columns_of(smooth, values);

  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(count, count);
  Eigen::MatrixXd with_model = Eigen::MatrixXd::Zero(scale_.size(), count);
  Eigen::VectorXd score = Eigen::VectorXd::Zero(count);
  Eigen::MatrixXd block_scores = Eigen::MatrixXd::Zero(blocks_, count);
  std::vector<Eigen::MatrixXd> whites;
  for (std::size_t f = 0; f < bins_->size(); ++f) {
    const Eigen::MatrixXd white = whitened(columns[f], (*bins_)[f], *noise_, f);
    own += white.transpose() * white;
    with_model += model_[f].transpose() * white;
    score += white.transpose() * left_[f];
    whites.push_back(white);
  }
  const Eigen::MatrixXd solution = scale_.asDiagonal() * (inverse_ * (scale_.asDiagonal() * with_model));
  const Eigen::VectorXd before = own.diagonal();
  own -= with_model.transpose() * solution;
  for (std::size_t f = 0; f < bins_->size(); ++f) {
    const Eigen::MatrixXd left = whites[f] - model_[f] * solution;
    for (Eigen::Index i = 0; i < left.rows(); ++i)
      block_scores.row(block_[f][static_cast<std::size_t>(i)]) += left_[f][i] * left.row(i);
  }

  Structure structure;
  structure.name = name;
  structure.centre = smooth.centre();
  if (own(0, 0) > least_left * before[0]) {
    structure.line_chi2 = score[0] * score[0] / own(0, 0) / variance_;
    structure.slope = score[0] / own(0, 0) / smooth.deviation();
    structure.slope_error = std::sqrt(variance_ / own(0, 0)) / smooth.deviation();
  }
  const Eigen::VectorXd scale = before.cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const SymmetricEigen solver = symmetric_eigen(scale.asDiagonal() * own * scale.asDiagonal());
  Eigen::MatrixXd turn(count, count);
  Eigen::Index kept = 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    if (!(solver.eigenvalues()[k] > least_left)) continue;
    turn.col(kept++) = scale.asDiagonal() * solver.eigenvectors().col(k) / std::sqrt(solver.eigenvalues()[k]);
  }
  if (kept == 0) return false;
  const Eigen::VectorXd normal = turn.leftCols(kept).transpose() * score / std::sqrt(variance_);
  structure.chi2 = normal.squaredNorm();
  structure.freedom = static_cast<double>(kept);
  structure.equivalent = one_degree_equivalent(structure.chi2, structure.freedom);
  structure.share = std::max(0.0, structure.chi2 - structure.freedom) * variance_ / squares_;
  structures_.push_back(structure);
  block_scores_.emplace_back(block_scores * turn.leftCols(kept) / std::sqrt(variance_));
  return true;
}

double StructureTest::threshold(double probability) const {
  const double each = probability / std::max<double>(1.0, static_cast<double>(structures_.size()));
  return chi_squared_value(each, 1.0);
}

std::optional<std::size_t> StructureTest::strongest() const {
  if (structures_.empty()) return std::nullopt;
  const auto found =
      std::max_element(structures_.begin(), structures_.end(),
                       [](const Structure& a, const Structure& b) { return a.equivalent < b.equivalent; });
  return static_cast<std::size_t>(found - structures_.begin());
}

double StructureTest::effective_blocks(std::size_t number) const {
  const Eigen::MatrixXd& scores = block_scores_[number];
  // Along the direction in which it scores.
  const Eigen::VectorXd along = scores * scores.colwise().sum().transpose();
  const double squares = along.squaredNorm();
  return squares > 0.0 ? along.cwiseAbs().sum() * along.cwiseAbs().sum() / squares : 0.0;
}

double StructureTest::chance_of(double score, std::size_t flips, std::uint64_t seed) const {
  std::mt19937_64 engine(seed);
  const Eigen::MatrixXd signs = Eigen::MatrixXd::NullaryExpr(
      as_index(flips), blocks_,
      [&](Eigen::Index, Eigen::Index) { return (engine() & 1U) != 0 ? 1.0 : -1.0; });
  std::vector<bool> above(flips, false);
  for (const Eigen::MatrixXd& scores : block_scores_) {
    const Eigen::VectorXd chi2 = (signs * scores).rowwise().squaredNorm();
    const auto freedom = static_cast<double>(scores.cols());
    for (std::size_t flip = 0; flip < flips; ++flip) {
      // The equivalent of one degree is never above chi2 itself.
      if (above[flip] || chi2[as_index(flip)] < score) continue;
      above[flip] = one_degree_equivalent(chi2[as_index(flip)], freedom) >= score;
    }
  }
  const auto count = std::count(above.begin(), above.end(), true);
  return static_cast<double>(count + 1) / static_cast<double>(flips + 1);
}

bool shares_noise(const std::vector<std::vector<double>>& residuals,
                  const std::vector<const double*>& values) {
  constexpr std::size_t window = 300;
  constexpr std::size_t fewest = 60;
  constexpr double level = 0.12;
  std::vector<double> correlations;
  for (std::size_t f = 0; f < residuals.size(); ++f) {
    const std::vector<double>& residual = residuals[f];
    for (std::size_t first = 1; first < residual.size(); first += window) {
      double rr = 0.0;
      double vv = 0.0;
      double rv = 0.0;
      std::size_t count = 0;
      for (std::size_t i = first; i < std::min(first + window, residual.size()); ++i) {
        const double change = residual[i] - residual[i - 1];
        const double other = values[f][i] - values[f][i - 1];
        if (!std::isfinite(change) || !std::isfinite(other)) continue;
        rr += change * change;
        vv += other * other;
        rv += change * other;
        ++count;
      }
      if (count < fewest) continue;
      correlations.push_back(rr > 0.0 && vv > 0.0 ? rv / std::sqrt(rr * vv) : 0.0);
    }
  }
  if (correlations.empty()) return false;
  return std::abs(median(std::move(correlations))) > level;
}

}  // namespace pcor::internal
