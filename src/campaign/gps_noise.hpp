#pragma once

#include <Eigen/Dense>

#include "campaign/gps_rows.hpp"
#include "numerics/latent_filter.hpp"

namespace pcor::internal {

/// What a fit knows of coefficients and nuisances before it reads a flight: normal, independent.
struct GpsPrior {
  Eigen::VectorXd mean;
  Eigen::VectorXd deviation;
};

/// What varies in the atmosphere and in GPS, and is no error of the aircraft: latent processes.
///
/// Wind, each component: three Ornstein-Uhlenbeck processes of 2, 8 and 32 s, gusts of a -5/3 cascade whose
/// strength follows the flight; one of minutes; a random walk on the height; and the heading wanders. Height:
/// the D-value, a random walk on time and height; the error of GPS; and the temperature between flight and
/// air, some tenths of a kelvin, which changes slowly.
///
/// Their sizes are the most likely ones on the flight, by the likelihood without the coefficients
/// (`maximise`), with a prior for each: minutes of flight hardly tell how the wind drifts.
class GpsNoise {
 public:
  explicit GpsNoise(GpsKind kind);

  /// The rows, white, without the samples that take no part. @param more variance of outliers, of each row
  WhiteRows white(const GpsRows& rows, const Eigen::VectorXd& more) const;

  /// Finds the sizes. @param prior of the columns of the rows
  void maximise(const GpsRows& rows, const Eigen::VectorXd& more, const GpsPrior& prior);

  /// Twice the negative logarithm of the likelihood, with the priors, up to a constant.
  double cost(const Eigen::VectorXd& logarithms, const GpsRows& rows, const Eigen::VectorXd& more,
              const GpsPrior& prior) const;

  const Eigen::VectorXd& logarithms() const { return logarithms_; }

 private:
  WhiteRows white_at(const Eigen::VectorXd& logarithms, const GpsRows& rows,
                     const Eigen::VectorXd& more) const;

  GpsKind kind_;
  Eigen::VectorXd logarithms_;  // of the sizes
};

/// An effect of the user's own has no usual size (a deviation of zero): its prior becomes wide.
void widen(GpsPrior& prior, const WhiteRows& white);

/// Adds variance for outliers, white residuals of more than 4.5 after a fit of all columns. True if one was
/// found.
bool find_outliers(const WhiteRows& white, const GpsPrior& prior, Eigen::VectorXd& more);

}  // namespace pcor::internal
