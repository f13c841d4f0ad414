#pragma once

#include <Eigen/Dense>

#include "campaign/gps_rows.hpp"
#include "numerics/latent_filter.hpp"

namespace pcor::internal {

/// Prior of coefficients and nuisances: normal, independent.
struct GpsPrior {
  Eigen::VectorXd mean;
  Eigen::VectorXd deviation;
};

/// Variation of the atmosphere and of GPS that is not an error of the aircraft: latent processes.
///
/// Wind, each component: three Ornstein-Uhlenbeck processes of 2, 8 and 32 s, gusts of a -5/3 cascade whose
/// strength follows the flight; one of minutes; a random walk on the height; and a drift of the heading.
/// Height: the D-value, a random walk on time and height; the error of GPS; the difference of measured and
/// actual temperature, a few tenths of a kelvin, which changes slowly; and the noise of the static pressure,
/// a few hundredths of an hPa in one sample. Without the last one that noise is mistaken for a random walk of
/// the D-value, the differences of heights from sample to sample get too much weight, and the noise that the
/// law's columns share with them biases the level.
///
/// Their sizes maximize the likelihood on the flight without the coefficients (`maximise`), with a prior for
/// each: minutes of flight hardly determine the drift of the wind.
class GpsNoise {
 public:
  explicit GpsNoise(GpsKind kind);

  /// Whitened rows without excluded samples. @param more variance of outliers, of each row
  WhiteRows white(const GpsRows& rows, const Eigen::VectorXd& more) const;

  /// Estimates the sizes by Fisher scoring. @param prior of the columns of the rows
  void maximise(const GpsRows& rows, const Eigen::VectorXd& more, const GpsPrior& prior);

  const Eigen::VectorXd& logarithms() const { return logarithms_; }

 private:
  Eigen::VectorXd logarithms_;  // logarithms of the sizes
};

/// An effect of the user's own has no usual size (a deviation of zero): its prior becomes wide.
void widen(GpsPrior& prior, const WhiteRows& white);

/// Adds variance for outliers, white residuals of more than 4.5 after a fit of all columns. True if one was
/// found.
bool find_outliers(const WhiteRows& white, const GpsPrior& prior, Eigen::VectorXd& more);

}  // namespace pcor::internal
