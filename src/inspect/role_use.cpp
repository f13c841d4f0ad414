#include "inspect/role_use.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include <pcor/effects/catalogue.hpp>

namespace pcor::internal {
namespace {

/// Consequence of a missing series, in addition to the effects that need it.
struct Cost {
  std::string_view series;
  std::string_view text;
};

constexpr std::array<Cost, 14> costs{{
    {"recovery_temperature",
     "no airspeed and no delta-p from LAMS, unless the temperature of the air is recorded"},
    {"dew_point", "the air is assumed dry, unless the vapour pressure is recorded"},
    {"lams_airspeed", "delta-p cannot be measured; use a second system, heights or winds as the reference"},
    {"attack", "the angle between laser beam and wind is unknown, and pitch manoeuvres need the pitch"},
    {"altitude", "no climbs, layers or hydrostatic temperature fit, unless another height is recorded"},
    {"vertical_speed", "it is computed from the altitude"},
    {"pitch", "pitch manoeuvres are found by the angle of attack, if that is recorded"},
    {"roll", "turns, circles and reverse headings are not found"},
    {"heading",
     "circles, reverse headings and yaw manoeuvres are found by the ground track, if that is recorded"},
    {"ground_speed", "winds cannot be compared, unless the ground speed is recorded by components"},
    {"ground_track", "winds cannot be compared, unless the ground speed is recorded by components"},
    {"flaps", "samples with flaps out are found by the lift alone"},
    {"liquid_water", "clouds are not found"},
    {"latitude", "standard gravity is used, and the slope of isobars is unknown"},
}};

/// Quantities from which a quantity is computed if it is not recorded.
std::vector<Quantity> sources_of(Quantity quantity) {
  for (const Rate& each : rates) {
    if (each.rate == quantity) return {each.quantity};
  }
  switch (quantity) {
    case Quantity::wetness:
      return {Quantity::liquid_water};
    case Quantity::attack_ratio:
      return {Quantity::attack_differential_pressure, Quantity::radome_dynamic_pressure};
    case Quantity::sideslip_ratio:
      return {Quantity::sideslip_differential_pressure, Quantity::radome_dynamic_pressure};
    default:
      return {quantity};
  }
}

}  // namespace

std::string cost_of(std::string_view series) {
  const auto found =
      std::find_if(costs.begin(), costs.end(), [&](const Cost& cost) { return cost.series == series; });
  return found == costs.end() ? std::string() : std::string(found->text);
}

std::vector<std::string> effects_that_need(Quantity role) {
  std::vector<std::string> effects;
  for (const EffectInfo& info : effect_info) {
    bool needs = false;
    for (std::size_t i = 0; i < info.need_count(); ++i) {
      const std::vector<Quantity> sources = sources_of(info.needs[i]);
      needs = needs || std::find(sources.begin(), sources.end(), role) != sources.end();
    }
    if (needs) effects.emplace_back(info.id);
  }
  return effects;
}

}  // namespace pcor::internal
