#pragma once

#include <Eigen/Dense>
#include <vector>

#include "numerics/binning.hpp"
#include "numerics/noise_model.hpp"

namespace pcor::internal {

/// Autocovariance at the lags 0 ... count-1 of a stationary autoregression whose innovations have variance
/// one.
std::vector<double> autocovariance(const std::vector<double>& coefficients, std::size_t count);

/// Inverse root of the covariance of the noise of one flight, applied to columns: the innovations of a Kalman
/// filter whose state is the autoregression and the drift components, each divided by its standard deviation
/// (Harvey 1989, Forecasting, structural time series models and the Kalman filter, section 3.4). Exact at the
/// beginning of stretches; a gap restarts the autoregression, and the drift components continue.
class Whitening {
 public:
  Whitening(const Binning& bins, const NoiseModel& noise, std::size_t flight);

  /// @param columns one row for each bin
  Eigen::MatrixXd operator()(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;

  /// Transpose of the whitening of columns: `transposed(whitening(y))` is the inverse of the covariance times
  /// y.
  Eigen::VectorXd transposed(const Eigen::VectorXd& values) const;

  /// The slow parts together that are most likely for residuals: their covariance times the inverse of that
  /// of the whole noise times the residuals.
  Eigen::VectorXd slow_parts(const Eigen::VectorXd& residuals) const;

  /// Log determinant of the covariance of the noise.
  double log_determinant() const { return log_determinant_; }

 private:
  std::size_t order_ = 0;  // order of the autoregression, at least one
  std::vector<double> coefficients_{};
  Eigen::VectorXd level_{};
  Eigen::Array<bool, Eigen::Dynamic, 1> begins_{};  // whether a stretch begins at each bin
  Eigen::VectorXd slow_variance_{};                 // variance of each drift component
  Eigen::MatrixXd decay_{};      // decay of each drift component since the previous bin; one column per bin
  Eigen::MatrixXd gain_{};       // gain of the state; one column per bin
  Eigen::VectorXd deviation_{};  // standard deviation of the innovations
  double log_determinant_ = 0.0;
};

}  // namespace pcor::internal
