#pragma once

#include <Eigen/Dense>

#include "fit/fit_flights.hpp"

namespace pcor::internal {

struct FitCovariance {
  Eigen::MatrixXd matrix{};  ///< of the wanted parameters; zero for those at a bound
  double samples_per_independent = 1.0;
};

/// The covariance of what a loss makes of noise with the memory that the residuals have: curvature^-1 times
/// the covariance of the score times curvature^-1, where the score is the sum of derivative times influence
/// (rho' r), and its noise an autoregression fitted to the influence of each flight.
///
/// @param earlier of the first of the wanted parameters, which were found in stages before; what these err by
///        goes on to the others. Empty without stages.
FitCovariance fit_covariance(FitFlights& flights, const Solution& solution, const Eigen::MatrixXd& earlier);

}  // namespace pcor::internal
