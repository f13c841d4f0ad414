#pragma once

#include <string>
#include <vector>

#include <pcor/improve/improve.hpp>

namespace pcor::internal {

/// Effect to add to a model.
struct AddedEffect {
  ModelEffect effect;                ///< the model with the starting coefficients
  std::vector<std::string> fixed{};  ///< parameters that the flights do not determine
  bool is_shared = false;            ///< the reference systems have the same effect
  double probability = 1.0;          ///< posterior probability among the effect and its rivals
};

/// Effect that the loop may add, and the required result.
struct OfferedEffect {
  std::vector<AddedEffect> choices{};  ///< the effect, and rivals that the flights cannot separate from it
  ImproveStep step{};
  bool is_named = true;  ///< the effect or one of its rivals counts as the cause
  bool is_sure = false;  ///< significant on blocks of the fitted flights that were excluded from its estimate
  double impossible_size = 0.0;  ///< size in usual sizes, if it is impossible; 0 otherwise
  std::string caution;           ///< end of the sentence in the summary
};

/// A finding of a diagnosis, with its rivals.
OfferedEffect offered_effect(const Finding& finding, const Diagnosis& diagnosis);

/// A formula of a recorded variable that describes structure without a named cause.
/// @param flights description for the source of the formula
OfferedEffect offered_effect(const EmpiricalPredictor& variable, const std::string& flights);

}  // namespace pcor::internal
