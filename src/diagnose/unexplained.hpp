#pragma once

#include <set>
#include <string>
#include <vector>

#include <pcor/campaign/flight_set.hpp>
#include <pcor/diagnose/diagnose.hpp>
#include "diagnose/analysis.hpp"

namespace pcor::internal {

/// Inputs of chosen effects. A variable that an effect reads is not a rival of it.
struct EffectInputs {
  std::set<Quantity> quantities{};
  std::set<std::string> variables{};
};

/// Structure remaining after base and chosen effects.
struct UnexplainedStructure {
  Unexplained found;
  double left = 0.0;  ///< chi2 of the best variable in addition to base and chosen effects
  /// True if a straight line in one variable of the files is more likely than all chosen effects, with a
  /// probability of 95 %: these are then rejected, and `found` describes the residual of the base alone.
  bool overrules = false;
  std::string rival{};  ///< variable of such a line with a probability above 5 %; otherwise empty
  std::vector<std::vector<double>> traced{};  ///< best variable of each local flight, one value per record
};

/// Tests whether structure remains in any variable of the files.
///
/// @param references in the order of the analysis
/// @param residual_rms, @param noise_rms and @param drift_rms after the chosen effects, hPa
UnexplainedStructure find_unexplained(const Analysis& analysis, const FlightSet& files,
                                      const ModelDefinition& model, const References& references,
                                      const EffectInputs& inputs, const DiagnoseOptions& options,
                                      double residual_rms, double noise_rms, double drift_rms);

}  // namespace pcor::internal
