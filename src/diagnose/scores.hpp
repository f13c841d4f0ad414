#pragma once

#include <Eigen/Dense>
#include <vector>

#include "numerics/noise_model.hpp"

namespace pcor::internal {

/// Whitened columns and residuals of all flights, and the sums that a search needs. Slow drift is
/// marginalised: sums are those of a generalised least-squares problem whose noise holds the drift too.
struct Scores {
  std::vector<Eigen::MatrixXd> rows{};  ///< of each flight, whitened columns and last the residual
  std::vector<Eigen::MatrixXd>
      drift{};  ///< of each flight, whitened shapes of drift; no columns without drift
  std::vector<Eigen::VectorXd> shares{};           ///< of each shape: by how much it is taken off
  std::vector<std::vector<Eigen::Index>> block{};  ///< of each flight, the number of the minute of each row
  Eigen::Index blocks = 0;                         ///< minutes of all flights
  Eigen::MatrixXd information{};                   ///< columns and residual with columns and residual
  Eigen::MatrixXd plain{};                         ///< the same as if there were no drift

  Eigen::Index columns() const { return information.cols() - 1; }
  std::size_t row_count() const;

  /// What is left of the whitened residual of a flight after the columns with these coefficients, and after
  /// the drift that is then likely.
  Eigen::VectorXd left(std::size_t flight, const Eigen::VectorXd& coefficients) const;
};

/// @param columns of each flight, in bins; @param residuals likewise, hPa
Scores find_scores(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                   const std::vector<Eigen::VectorXd>& residuals, const NoiseModel& noise);

/// The slow drift of residuals after a fit of columns.
struct DriftFit {
  double size = 0.0;        ///< that makes the residuals most likely, hPa; 0 where none is needed
  double gain = 0.0;        ///< twice the gain in log-likelihood over no drift
  double likelihood = 0.0;  ///< twice the log-likelihood with columns and drift at their best
};

DriftFit likely_drift(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                      const std::vector<Eigen::VectorXd>& residuals, const NoiseModel& noise);

}  // namespace pcor::internal
