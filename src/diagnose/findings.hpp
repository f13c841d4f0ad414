#pragma once

#include <string>
#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include "diagnose/analysis.hpp"
#include "diagnose/candidates.hpp"

namespace pcor::internal {

/// The findings of an analysis, the strongest first, without advice.
std::vector<Finding> findings_of(const Analysis& analysis, const std::vector<Candidate>& candidates);

/// The evidence for each finding, of each minute of all flights: the gain in chi2.
std::vector<Eigen::VectorXd> evidence_of_findings(const Analysis& analysis);

/// That of one finding along an own flight: of the minute that a record lies in; NaN where not used.
std::vector<double> evidence_along(const Analysis& analysis, std::size_t flight,
                                   const Eigen::VectorXd& evidence);

/// Candidates that the model's own coefficients imitate. @param base these
std::vector<AbsorbedEffect> absorbed_of(const Analysis& analysis, const std::vector<Candidate>& candidates,
                                        const std::vector<BaseCoefficient>& base);

/// What the effects that were not found may amount to.
std::vector<UpperLimit> limits_of(const Analysis& analysis, const std::vector<Candidate>& candidates,
                                  const std::vector<Finding>& findings);

/// What is flown between two times, e.g. "level, yaw manoeuvre".
std::string regimes_between(const FlightSamples& samples, double begin, double end);

}  // namespace pcor::internal
