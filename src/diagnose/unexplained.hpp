#pragma once

#include <set>
#include <string>
#include <vector>

#include <pcor/campaign/flight_set.hpp>
#include <pcor/diagnose/diagnose.hpp>
#include "diagnose/analysis.hpp"

namespace pcor::internal {

/// What chosen effects read. A variable that one of them reads is no rival of it.
struct EffectInputs {
  std::set<Quantity> quantities{};
  std::set<std::string> variables{};
};

/// Structure that base and chosen effects leave.
struct UnexplainedStructure {
  Unexplained found;
  double left = 0.0;  ///< chi2 of the best variable beside base and chosen effects
  /// True where a straight line in one variable of the files explains more than all chosen effects: then
  /// these are not what is missing, and `found` is what the base alone leaves.
  bool overrules = false;
  std::vector<std::vector<double>>
      traced{};  ///< the best variable, of each own flight, one value for each record
};

/// Tests whether something is left, in any variable of the files.
///
/// @param references in the order of the analysis
/// @param residual_rms and @param noise_rms after the chosen effects, hPa
UnexplainedStructure find_unexplained(const Analysis& analysis, const FlightSet& files,
                                      const ModelDefinition& model, const References& references,
                                      const EffectInputs& inputs, const DiagnoseOptions& options,
                                      double residual_rms, double noise_rms);

}  // namespace pcor::internal
