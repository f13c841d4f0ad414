#pragma once

#include <string>
#include <vector>

#include <pcor/regimes/regimes.hpp>
#include "fit/fit_flights.hpp"
#include "fit/fit_task.hpp"

namespace pcor::internal {

/// The ratio of the largest to the smallest singular value of the derivatives by the wanted parameters, each
/// column of length one, with what offsets explain taken out; infinite where one is the sum of others.
/// @throws Error if the flights cannot tell a coefficient, or, without a prior, cannot tell some apart: the
/// message names them and says which to fix.
double condition_number(const Reduction& reduction, const FitTask& task,
                        const std::vector<std::size_t>& wanted);

/// In words: which coefficients the flights do not determine, and what would.
/// @param covariance of the fitted parameters; @param flown the regimes in the flights
std::vector<std::string> identifiability_notes(const FitTask& task, const Solution& solution,
                                               const Eigen::MatrixXd& covariance,
                                               const std::vector<std::size_t>& fitted, double condition,
                                               const RegimeSet& flown);

/// In words, for each parameter at a bound.
std::vector<std::string> bound_notes(const FitTask& task, const Solution& solution, double condition);

}  // namespace pcor::internal
