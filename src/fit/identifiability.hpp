#pragma once

#include <string>
#include <vector>

#include <pcor/regimes/regimes.hpp>
#include "fit/fit_flights.hpp"
#include "fit/fit_task.hpp"

namespace pcor::internal {

/// Ratio of the largest to the smallest singular value of the derivatives by the requested parameters, with
/// columns of unit length and without the part explained by offsets; infinite if one column is a sum of
/// others.
/// @throws Error if a coefficient is not identifiable or, without a prior, some are not separable: the
/// message names them and recommends which to fix.
double condition_number(const Reduction& reduction, const FitTask& task,
                        const std::vector<std::size_t>& requested);

/// Warnings that name undetermined coefficients and the manoeuvres that would determine them.
/// @param covariance of the fitted parameters; @param flown the regimes in the flights
std::vector<std::string> identifiability_notes(const FitTask& task, const Solution& solution,
                                               const Eigen::MatrixXd& covariance,
                                               const std::vector<std::size_t>& fitted, double condition,
                                               const RegimeSet& flown);

/// Warning for each parameter at a bound.
std::vector<std::string> bound_notes(const FitTask& task, const Solution& solution, double condition);

}  // namespace pcor::internal
