#pragma once

#include <Eigen/Dense>
#include <vector>

#include "fit/fit_flights.hpp"

namespace pcor::internal {

/// States of the flights in the bins of each local flight, NaN if unknown.
std::vector<Eigen::MatrixXd> binned_states(FitFlights& flights);

/// The bumps of the misfit at given states.
class MisfitBasis {
 public:
  MisfitBasis() = default;
  /// Finds mean and deviation of each state over all flights. @param states of the local flights, in bins
  MisfitBasis(const FlightPartition& partition, const std::vector<Eigen::MatrixXd>& states);

  static Eigen::Index count();
  /// One row for each bin. @param states in these bins
  Eigen::MatrixXd operator()(const Eigen::MatrixXd& states) const;

 private:
  Eigen::VectorXd mean_{};
  Eigen::VectorXd deviation_{};  // zero if a state is not recorded or constant
};

/// Misfit of the law as a smooth function of the flight state: a sum of functions of attack ratio, sideslip
/// ratio, q/p, climb rate, load factor and static pressure, the same on all flights. Each state is
/// standardised over the flights, cut off at +-3 and has seven bumps, exp(-((z - c)/0.75)^2/2) with c = -3
/// ... 3, whose heights are normal with one variance for each state. The variances are the most likely ones
/// by restricted likelihood, given the noise (Patterson and Thompson 1971, Biometrika 58, 545). States that
/// are not recorded are omitted. In addition each flight has an offset.
struct Misfit {
  MisfitBasis bumps{};
  Eigen::VectorXd variance{};    ///< height of each bump, hPa^2; empty if unknown
  Eigen::VectorXd height{};      ///< most likely height of each bump, hPa
  double between_flights = 0.0;  ///< variance of the zero of each flight, hPa^2
  double rms = 0.0;  ///< rms of the misfit that the law does not absorb, with its uncertainty, hPa

  /// Most likely misfit in bins with these states, hPa; zero if unknown.
  Eigen::VectorXd at(const Eigen::MatrixXd& flown) const;
};

/// Estimates misfit and noise of the flights of a fit alternately: each from the residual after the other,
/// the misfit against the first reference. The flights then have that noise, without the misfit also against
/// further static pressures.
Misfit find_misfit(FitFlights& flights, const Solution& solution);

}  // namespace pcor::internal
