#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <limits>
#include <vector>

#include "numerics/binning.hpp"
#include "numerics/noise_model.hpp"

namespace pcor::internal {

/// Binned residual of a flight, with the quantities that determine the variances of sums over its records.
class BinnedResidual {
 public:
  BinnedResidual() = default;  // empty
  /// @param residual one value for each record, NaN where not used; @param time s; @param step s
  /// @param max_bins bins are widened up to `Binning::max_width` until there are about this many, unless
  /// records are lost: enough for sums over whole flights
  BinnedResidual(const std::vector<double>& residual, const std::vector<double>& time, double step,
                 double max_bins = std::numeric_limits<double>::infinity());

  const Binning& bins() const { return bins_; }
  /// The residual in bins.
  const Eigen::VectorXd& means() const { return means_; }

  /// The noise of the residual about its mean.
  NoiseModel noise_about_mean() const;

  /// Covariance matrix of the sums (column . noise) over the records: the covariance of the bin means by the
  /// noise model, plus the covariance of the records about the means of their bins, in which they are
  /// independent. Records outside the bins, such as isolated ones, are independent, with the mean square of
  /// the residual.
  ///
  /// @param columns one value for each record @param flight its number among the levels of the noise
  Eigen::MatrixXd covariance_of_sums(const std::vector<const double*>& columns, const NoiseModel& noise,
                                     std::size_t flight) const;

  /// Variance of the sum of the noise over the given records; NaN if there are no bins.
  /// @param noise with the levels of this flight alone
  double variance_of_sum(const std::vector<std::size_t>& records, const NoiseModel& noise) const;

 private:
  std::vector<std::size_t> outside_{};  ///< used records outside the bins
  double variance_outside_ = 0.0;
  Binning bins_{};
  Eigen::VectorXd means_{};
  std::vector<Eigen::Index> bin_of_{};  ///< bin of each record; -1 outside the bins
  Eigen::VectorXd variance_{};          ///< variance of the records about the mean of each bin
};

}  // namespace pcor::internal
