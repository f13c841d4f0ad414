#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <pcor/model_io/model_definition.hpp>
#include <pcor/residuals/reference.hpp>

namespace pcor::internal {

/// A parameter of a candidate that is tested.
struct CandidateParameter {
  std::size_t place = 0;  ///< among the parameters of its effect
  std::string name;
  std::string unit;
  double typical = 0.0;  ///< 0 where nobody knows
  Bounds bounds{};       ///< of what physics allows, as a change from the neutral value
};

/// An effect that the model may lack, or that of the system which it is held against.
struct Candidate {
  ModelEffect effect;      ///< with its neutral parameters, and shapes as they are tried
  std::string id;          ///< as that of a finding
  std::size_t number = 0;  ///< of the effect in the extended model
  /// On the system of each reference: the number of the effect in its extended model, nothing where it has
  /// none. Empty for an effect on the own system.
  std::vector<std::optional<std::size_t>> numbers_in_others{};
  std::string system{};  ///< which other system, where the references have several: "PSFRD+QCFR"; else empty
  /// The time over which its need is found that it remembers (`EffectInfo::memory`), s.
  double memory = 0.0;
  /// The same on the other system, built alike: what holds the two against each other does not see it.
  bool is_shared = false;
  std::string title;
  std::vector<CandidateParameter> tested{};
  bool is_variant = false;  ///< the same effect as a candidate before it, in another shape

  bool is_of_reference() const { return !numbers_in_others.empty(); }
  /// Whether it acts on what a reference is made of: an effect on the own system in the first of them, which
  /// tells all figures; one on another system in those that have that system.
  bool is_measured_by(std::size_t reference) const {
    return is_of_reference() ? numbers_in_others[reference].has_value() : reference == 0;
  }
};

/// A coefficient that is fitted beside every candidate.
struct BaseCoefficient {
  std::string name;  ///< like "static-qp.a2" and "reference:static-qp.a2"
  std::string unit;
  double value = 0.0;  ///< in its model
  Bounds bounds{};
  bool of_reference = false;
  double usual = 0.0;  ///< the size it usually has, in its unit; 0 where nobody knows
};

/// Candidates, and the models that have them.
struct CandidateModels {
  /// The model with every candidate besides, and the variables of all roles that these need.
  ModelDefinition extended;
  /// The references, each with what candidates on its own system need.
  References references{};
  /// The model of each reference, with every candidate on its system besides; nothing where it has none.
  std::vector<std::optional<ModelDefinition>> others{};
  std::vector<std::size_t> effects_of_others{};  ///< how many effects the law of each has without candidates
  std::vector<BaseCoefficient> base{};
  /// Where those of each reference's own model begin.
  std::vector<std::size_t> base_of_others{};
  std::vector<Candidate> candidates{};

  /// The first column of a candidate among those of all, one for each tested parameter. @param candidate its
  /// number; that of all: how many columns there are
  std::size_t first_column(std::size_t candidate) const {
    std::size_t first = 0;
    for (std::size_t c = 0; c < candidate; ++c) first += candidates[c].tested.size();
    return first;
  }
};

}  // namespace pcor::internal
