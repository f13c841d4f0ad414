#pragma once

#include <string>
#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/laws/model_file.hpp>

namespace pcor::internal {

/// A parameter of a candidate that is tested.
struct CandidateParameter {
  std::size_t place = 0;  ///< among the parameters of its effect
  std::string name;
  std::string unit;
  double typical = 0.0;  ///< 0 where nobody knows
  Bounds bounds{};       ///< of what physics allows, as a change from the neutral value
};

/// An effect that the model may lack.
struct Candidate {
  ModelEffect effect;      ///< with its neutral parameters, and shapes as they are tried
  std::size_t number = 0;  ///< of the effect in the extended model
  std::string title;
  std::vector<CandidateParameter> tested{};
  bool is_variant = false;  ///< the same effect as a candidate before it, in another shape
};

/// What can be tested on some flights.
struct CandidateSet {
  /// The model with every candidate besides, and the variables of all roles that these need.
  ModelFile extended;
  std::vector<Candidate> candidates{};
  std::vector<NotTestable> not_testable{};
};

/// The effects of the catalogue that are not in the model, and the formulas. An effect whose inputs some
/// flight lacks is not testable, and told so. @throws Error if the model cannot be used.
CandidateSet find_candidates(const ModelFile& model, const std::vector<ModelEffect>& formulas,
                             const std::vector<const Flight*>& flights, const Reference& reference);

}  // namespace pcor::internal
