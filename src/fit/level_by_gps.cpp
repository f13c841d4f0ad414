#include <pcor/fit/refit.hpp>

#include <algorithm>
#include <iterator>
#include <string>

#include <pcor/effects/catalogue.hpp>
#include <pcor/roles/add_effects.hpp>
#include "fit/gps_fit.hpp"

namespace pcor {

using namespace internal;

std::optional<LevelByGps> level_by_gps(const FlightSet& flights, const ModelDefinition& model,
                                       const References& references, const MaskOptions& mask) {
  References gps;
  std::copy_if(references.begin(), references.end(), std::back_inserter(gps),
               [](const auto& reference) { return is_by_gps(*reference); });
  if (gps.empty()) return std::nullopt;
  const std::string constant = "static-constant";
  ModelDefinition with = has_effect(model, constant) ? model : add_effects(model, {neutral_effect(constant)});
  // GPS alone is used, without the result of an earlier fit.
  with.covariance = {};
  for (EffectFit& fit : with.fits) {
    for (ParameterFit& parameter : fit) parameter.standard_error.reset();
  }
  RefitOptions options;
  options.mask = mask;
  for (const ModelEffect& effect : model.model.effects) {
    if (effect.id != constant) options.fix.push_back(effect.id);
  }
  options.free.push_back(constant);
  const RefitResult found = refit(flights, with, gps, options);
  for (const FittedParameter& parameter : found.parameters) {
    if (!parameter.fitted || !(parameter.standard_error > 0.0)) continue;
    const double pressure = found.defect_error / parameter.standard_error;
    return LevelByGps{pressure * (parameter.value - parameter.start), found.defect_error};
  }
  return std::nullopt;
}

}  // namespace pcor
