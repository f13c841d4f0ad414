#pragma once

#include <Eigen/Dense>
#include <vector>

#include "numerics/binning.hpp"
#include "numerics/noise_model.hpp"

namespace pcor::internal {

/// The inverse root of the covariance of the noise of one flight, applied to columns: the innovations of a
/// Kalman filter whose state is the autoregression and the slow parts, each over its standard deviation
/// (Harvey 1989, Forecasting, structural time series models and the Kalman filter, section 3.4). Exact at the
/// beginning of stretches; over a gap the autoregression forgets itself and the slow parts go on.
class Whitening {
 public:
  Whitening(const Binning& bins, const NoiseModel& noise, std::size_t flight);

  /// @param columns one row for each bin
  Eigen::MatrixXd operator()(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;

  /// The transpose of what is applied to columns: `transposed(whitening(y))` is the inverse of the covariance
  /// times y.
  Eigen::VectorXd transposed(const Eigen::VectorXd& values) const;

  /// The slow parts together that are most likely for residuals: their covariance times the inverse of that
  /// of the whole noise times the residuals.
  Eigen::VectorXd slow_parts(const Eigen::VectorXd& residuals) const;

  /// Of the covariance of the noise.
  double log_determinant() const { return log_determinant_; }

 private:
  std::size_t order_ = 0;  // of the autoregression, one at least
  std::vector<double> coefficients_{};
  Eigen::VectorXd level_{};
  std::vector<Eigen::Index> begins_{};  // bins at which a stretch begins
  Eigen::VectorXd slow_variance_{};     // of each slow part
  Eigen::MatrixXd decay_{};             // of each slow part since the bin before, by columns of bins
  Eigen::MatrixXd gain_{};              // of the state, by columns of bins
  Eigen::VectorXd deviation_{};         // of the innovations
  double log_determinant_ = 0.0;
};

}  // namespace pcor::internal
