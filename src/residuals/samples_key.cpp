#include <fmt/format.h>
#include <fmt/ranges.h>

#include <pcor/residuals/reference.hpp>
#include "parallel/digest.hpp"
#include "residuals/samples.hpp"
#include "roles/model_inputs.hpp"

namespace pcor::internal {
namespace {

std::string text_of(const UserIntervals& intervals) {
  std::string text = intervals.flight;
  for (const Interval& each : intervals.add)
    text += fmt::format("|+{},{},{},{},{}", static_cast<int>(each.regime), each.begin, each.end, each.pair,
                        each.note);
  for (const Veto& each : intervals.veto)
    text +=
        fmt::format("|-{},{},{}", each.regime ? static_cast<int>(*each.regime) : -1, each.begin, each.end);
  return text;
}

}  // namespace

std::string inputs_of(const ModelDefinition& file, bool with_laser) {
  const Model& model = file.model;
  const Chain chain = chain_of(model, roles_of(file, with_laser));
  std::string text = fmt::format("{}|{}|{}|{}|{}|{}|", with_laser, model.aircraft, file.law.valid_from,
                                 file.law.valid_to, file.roles_from, fmt::join(chain.extra_names(), ","));
  for (std::size_t i = 0; i < state_capacity; ++i) text += chain.needs(static_cast<Quantity>(i)) ? '1' : '0';
  for (const auto& [role, variable] : file.variables)
    text += fmt::format("|{}={}", static_cast<int>(role), variable);
  for (const auto& [role, unit] : file.units) text += fmt::format("|{}:{}", static_cast<int>(role), unit);
  if (!chain.derives(Quantity::airspeed_rate) && !chain.derives(Quantity::wetness)) return text;
  // The column depends on the law.
  text += fmt::format("|{},{}|{}|{}|{},{},{},{}", model.lams.elevation, model.lams.azimuth, model.moist,
                      fmt::join(model.recovery.coefficients, ","), model.policy.taper_below,
                      model.policy.taper_power, model.policy.minimum, model.policy.min_dynamic_pressure);
  for (const RadomeCalibration& radome : {model.attack_radome, model.sideslip_radome})
    text += fmt::format("|{},{},{}", radome.offset, radome.slope, radome.slope_mach);
  for (const ModelEffect& effect : model.effects) {
    text += fmt::format("|{}:{}:{}:{}:{},{}:{}", effect.id, effect.formula,
                        fmt::join(effect.parameter_names, ","), static_cast<int>(effect.location),
                        effect.scaling.static_pressure, effect.scaling.dynamic_pressure,
                        fmt::join(effect.parameters, ","));
  }
  return text;
}

std::uint64_t samples_key(const ModelDefinition& model, const Reference& reference, const MaskOptions& mask) {
  std::string text = fmt::format("{}\n{}\n{}", inputs_of(model, reference.reads_laser()), reference.inputs(),
                                 mask.min_airspeed);
  if (mask.intervals) text += "\n" + text_of(*mask.intervals);
  return digest_of(text);
}

}  // namespace pcor::internal
