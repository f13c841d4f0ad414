#pragma once

#include <Eigen/Dense>
#include <vector>

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
/// @param parameters all of them, and `offsets`, at the fit
/// @param earlier of the first of the wanted parameters, which were found in stages before; what these err by
///        goes on to the others. Empty without stages.
/// @param at_bound of the other wanted parameters: what is at a bound does not vary
/// @param prior_weight of the wanted parameters, in the rows of the fit; empty without
/// @param prior_strength the noise of these rows
FitCovariance fit_covariance(FitFlights& flights, const Eigen::VectorXd& parameters,
                             const Eigen::VectorXd& offsets, const ceres::LossFunction* loss,
                             const Eigen::MatrixXd& earlier, const std::vector<bool>& at_bound,
                             const Eigen::VectorXd& prior_weight, double prior_strength);

}  // namespace pcor::internal
