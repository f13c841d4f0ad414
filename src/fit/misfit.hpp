#pragma once

#include <Eigen/Dense>

#include "fit/fit_flights.hpp"

namespace pcor::internal {

/// What the law lacks as a smooth function of the flight state: a sum of functions of attack ratio, sideslip
/// ratio, q/p, climb rate, load factor and static pressure, the same on all flights. Each state is
/// standardised over the flights, cut off at +-3 and has seven bumps, exp(-((z - c)/0.75)^2/2) with c = -3
/// ... 3, whose heights are normal with one variance for each state. The variances are the most likely ones
/// by restricted likelihood, given the noise (Patterson and Thompson 1971, Biometrika 58, 545). States that
/// are not recorded are left out. Beside it each flight has a zero of its own.
struct Misfit {
  Eigen::VectorXd variance{};    ///< of the height of each bump, hPa^2; empty where none is known
  Eigen::VectorXd height{};      ///< of each bump, the most likely one, hPa
  double between_flights = 0.0;  ///< variance of a zero of each flight, hPa^2
  double left = 0.0;  ///< rms of the misfit that the law does not take up, with its uncertainty, hPa
};

/// The bumps at the bins of flights.
class MisfitBasis {
 public:
  /// Finds mean and deviation of each state over all flights.
  explicit MisfitBasis(FitFlights& flights);

  static Eigen::Index count();
  /// One row for each bin.
  Eigen::MatrixXd operator()(const FitFlight& fit) const;

 private:
  Eigen::VectorXd mean_{};
  Eigen::VectorXd deviation_{};  // zero where a state is not recorded, or does not vary
};

/// Finds misfit and noise of the flights of a fit in turn: each is what the other leaves. The flights have
/// that noise after that.
Misfit find_misfit(FitFlights& flights, const MisfitBasis& columns, const Solution& solution);

}  // namespace pcor::internal
