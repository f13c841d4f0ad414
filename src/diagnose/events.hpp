#pragma once

#include <Eigen/Dense>
#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include "diagnose/analysis.hpp"

namespace pcor::internal {

/// Consecutive minutes with evidence for an effect, with the sum of their evidence as the share.
/// @param evidence gain in chi2 in each minute of all flights
std::vector<Evidence> events_of(const Analysis& analysis, const Eigen::VectorXd& evidence);

/// Equivalent number of events of equal weight.
double count_of(const std::vector<Evidence>& events);

}  // namespace pcor::internal
