#pragma once

#include <vector>

#include <pcor/campaign/flight_set.hpp>
#include <pcor/diagnose/diagnose.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/residuals/reference.hpp>
#include "campaign/candidate.hpp"

namespace pcor::internal {

/// Testable and untestable candidates for some flights.
struct CandidateSet : CandidateModels {
  std::vector<NotTestable> not_testable{};
};

/// Effects of the catalogue that are not in the model, and the formulas. An effect whose inputs are missing
/// in some flight is listed as not testable. @throws Error if the model cannot be used.
/// @param dates on which a step is tried, as the role date has them
CandidateSet find_candidates(const ModelDefinition& model, const std::vector<ModelEffect>& formulas,
                             const FlightSet& flights, const References& references,
                             const std::vector<double>& dates = {}, bool trust_reference = false);

}  // namespace pcor::internal
