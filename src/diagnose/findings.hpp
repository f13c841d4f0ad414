#pragma once

#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include "diagnose/analysis.hpp"

namespace pcor::internal {

/// Findings of an analysis without advice, sorted by decreasing evidence.
std::vector<Finding> findings_of(const Analysis& analysis, const References& references,
                                 const std::vector<Candidate>& candidates);

/// Adds to every finding with aliases the repeated regime that would separate it from them, and the
/// probability of success.
void advise(const Analysis& analysis, const std::vector<Candidate>& candidates,
            std::vector<Finding>& findings);

/// Evidence for each finding in each minute of all flights: the gain in chi2, whose sum is its chi2.
std::vector<Eigen::VectorXd> evidence_of_findings(const Analysis& analysis);

/// Evidence of one finding for each record of a local flight, from the minute that contains the record; NaN
/// if not used.
std::vector<double> evidence_along(const Analysis& analysis, std::size_t flight,
                                   const Eigen::VectorXd& evidence);

/// Candidates that the model coefficients `base` imitate.
std::vector<AbsorbedEffect> absorbed_of(const Analysis& analysis, const std::vector<Candidate>& candidates,
                                        const std::vector<BaseCoefficient>& base);

/// Upper limits of the effects that were not found.
std::vector<UpperLimit> limits_of(const Analysis& analysis, const std::vector<Candidate>& candidates,
                                  const std::vector<Finding>& findings);

/// Probability from which an alias of a finding is considered in the correction.
inline constexpr double min_probability = 0.01;

/// Whether a finding predicts held-out parts: their chi2 decreases by more than three standard errors.
inline bool predicts_held_out_parts(const Finding& finding) {
  return finding.chi2_reduction > 3.0 * finding.chi2_reduction_error;
}

/// Whether a finding is beyond two standard deviations of the widest prior of its size: 20 usual sizes.
inline bool is_of_impossible_size(const Finding& finding) {
  return finding.relative_size > 2.0 * widest_prior;
}

/// An effect of an impossible size may be the image of another error, unless it predicts held-out parts: "an
/// unknown error" becomes its rival, with a note.
void add_rival_by_size(Diagnosis& diagnosis);

/// The size of an effect is estimated together with drift, from its faster variations. A note warns of an
/// effect of more than 0.05 hPa and half of the held-out rms if a refit with it decreases this rms by less
/// than a fifth, and its square by less than half of the square of the size; and of any effect with which
/// this rms increases.
void warn_by_refit(Diagnosis& diagnosis);

/// By GPS alone, variations of the atmosphere beyond their model look like an effect: a finding that does not
/// clearly predict held-out parts may be one. So may a finding that increases their rms: its evidence is in
/// fast variations, which the filter of a receiver changes. So may a finding of an impossible size: a wind
/// that depends on the place is the same in held-out parts.
void add_rival_by_atmosphere(Diagnosis& diagnosis);

}  // namespace pcor::internal
