#include "temperature/dry_air.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "roles/aircraft_family.hpp"
#include "roles/recorded_series.hpp"
#include "roles/usual_variables.hpp"

namespace pcor::internal {
namespace {

constexpr double dry_above = 5000.0;  // m; above it vapour makes less than 0.2 K of virtual temperature
/// The part of a thickness that vapour makes in the driest air below: 0.03 hPa at 600 hPa.
constexpr double min_part = 1e-5;

constexpr std::array humidities{Quantity::vapor_pressure, Quantity::dew_point, Quantity::frost_point};

/// [variables] and [humidity] that would make the air moist.
std::string remedy(const ModelDefinition& model, const Flight& flight) {
  for (const Quantity role : humidities) {
    const auto named = model.variables.find(role);
    if (named == model.variables.end()) continue;
    if (!model.model.moist) return "give the model [humidity] moist = true";
    return fmt::format("{} contains no water vapour: name another humidity in the model's [variables]",
                       named->second);
  }
  const VariableNaming& family = family_of(model, flight);
  for (const Quantity role : humidities) {
    for (const std::string& variable : family.names_of(info_of(role).name)) {
      if (has_values(flight, variable, std::string(info_of(role).unit), family.unit_of(variable)))
        return fmt::format(
            "give the model [variables] {} = \"{}\", which the flight records, and [humidity] "
            "moist = true",
            info_of(role).name, variable);
    }
  }
  return "name the flight's vapor_pressure, dew_point or frost_point in the model's [variables], and give it "
         "[humidity] moist = true";
}

}  // namespace

std::string trouble_with_dry_air(const HeightRecord& record, const ModelDefinition& model,
                                 const Flight& flight) {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  double by_vapor = 0.0;
  for (const HeightBlock& block : record.blocks) {
    lowest = std::min(lowest, block.height);
    highest = std::max(highest, block.height);
    by_vapor = std::max(by_vapor, std::abs(block.errors[with_vapor]));
  }
  if (lowest > dry_above || by_vapor > min_part * (highest - lowest)) return "";
  return fmt::format(
      "{}: it climbs or descends down to {:.0f} m in air assumed dry; below {:.0f} m neglected vapour "
      "resembles a thermometer error of up to 3 K; {}",
      record.name, lowest, dry_above, remedy(model, flight));
}

}  // namespace pcor::internal
