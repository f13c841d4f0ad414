#pragma once

#include <optional>
#include <string>
#include <vector>

#include <pcor/campaign/flight_set.hpp>
#include <pcor/diagnose/diagnose.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/residuals/reference.hpp>
#include "campaign/candidate.hpp"

namespace pcor::internal {

/// What can be tested on some flights, and what cannot.
struct CandidateSet : CandidateModels {
  std::vector<NotTestable> not_testable{};
};

/// The effects of the catalogue that are not in the model, and the formulas. An effect whose inputs some
/// flight lacks is not testable, and told so. @throws Error if the model cannot be used.
/// @param dates on which a step is tried, as the role date has them
CandidateSet find_candidates(const ModelDefinition& model, const std::vector<ModelEffect>& formulas,
                             const FlightSet& flights, const References& references,
                             const std::vector<double>& dates = {}, bool trust_reference = false);

}  // namespace pcor::internal
