#include "numerics/binned_residual.hpp"

#include <algorithm>
#include <cmath>

#include "numerics/missing.hpp"
#include "numerics/noise_covariance.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

/// Short series have shorter bins: at least this number of bins, but each at least as long as a record.
constexpr double usual_bins = 200.0;

double used_records(const std::vector<double>& residual) {
  return static_cast<double>(
      std::count_if(residual.begin(), residual.end(), [](double r) { return !std::isnan(r); }));
}

Binning bins_of(const std::vector<double>& residual, const std::vector<double>& time, double step,
                double max_bins) {
  constexpr double min_kept = 0.95;  // share of the records in bins of the usual width
  const double length = used_records(residual) * step;
  Binning bins(residual, time, step, std::min(Binning::usual_width, length / usual_bins));
  const double width = std::min(length / max_bins, Binning::max_width);
  if (width <= bins.width()) return bins;
  Binning wide(residual, time, step, width);
  const auto records = [](const Binning& of) { return static_cast<double>(of.records().size()); };
  return records(wide) < min_kept * records(bins) ? bins : wide;
}

}  // namespace

BinnedResidual::BinnedResidual(const std::vector<double>& residual, const std::vector<double>& time,
                               double step, double max_bins)
    : bins_(bins_of(residual, time, step, max_bins)) {
  means_ = bins_.means(residual);
  const std::vector<std::size_t>& records = bins_.records();
  variance_ = Eigen::VectorXd::Zero(means_.size());
  bin_of_.assign(residual.size(), -1);
  for (std::size_t k = 0; k < records.size(); ++k) {
    const Eigen::Index bin = bins_.bins()[k];
    bin_of_[records[k]] = bin;
    variance_[bin] +=
        std::pow(residual[records[k]] - means_[bin], 2) / std::max(bins_.counts()[bin] - 1.0, 1.0);
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (std::isnan(residual[i])) continue;
    squares += residual[i] * residual[i];
    if (bin_of_[i] < 0) outside_.push_back(i);
  }
  variance_outside_ = squares / std::max(used_records(residual), 1.0);
}

Eigen::MatrixXd BinnedResidual::covariance_of_sums(const std::vector<const double*>& columns,
                                                   const NoiseModel& noise, std::size_t flight) const {
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(means_.size(), as_index(columns.size()));
  Eigen::MatrixXd within = Eigen::MatrixXd::Zero(sums.cols(), sums.cols());
  const std::vector<std::size_t>& records = bins_.records();
  Eigen::VectorXd row(sums.cols());
  for (std::size_t k = 0; k < records.size(); ++k) {
    const Eigen::Index bin = bins_.bins()[k];
    for (Eigen::Index c = 0; c < row.size(); ++c) row[c] = columns[static_cast<std::size_t>(c)][records[k]];
    sums.row(bin) += row.transpose();
    within += variance_[bin] * row * row.transpose();
  }
  // Only the deviations of the columns from their bin means.
  within -= sums.transpose() * variance_.cwiseQuotient(bins_.counts()).asDiagonal() * sums;
  for (const std::size_t record : outside_) {
    for (Eigen::Index c = 0; c < row.size(); ++c) row[c] = columns[static_cast<std::size_t>(c)][record];
    within += variance_outside_ * row * row.transpose();
  }
  return within + noise_covariance(sums, bins_, noise, flight);
}

double BinnedResidual::variance_of_sum(const std::vector<std::size_t>& records,
                                       const NoiseModel& noise) const {
  if (bins_.size() == 0) return nan;
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(means_.size());
  for (const std::size_t record : records) {
    if (bin_of_[record] >= 0) sums[bin_of_[record]] += 1.0;
  }
  if (sums.sum() == 0.0) sums[0] = 1.0;  // treated as one bin
  const double scale = static_cast<double>(records.size()) / sums.sum();
  const double within =
      (variance_.array() * sums.array() * (1.0 - sums.array() / bins_.counts().array())).sum();
  return scale * scale * (within + noise_covariance(sums, bins_, noise, 0)(0, 0));
}

NoiseModel BinnedResidual::noise_about_mean() const {
  const double mean = means_.sum() / static_cast<double>(means_.size());
  return expected_noise({bins_}, {Eigen::MatrixXd::Ones(means_.size(), 1)}, {means_.array() - mean}, 1);
}

}  // namespace pcor::internal
