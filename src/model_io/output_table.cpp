#include "model_io/output_table.hpp"

#include <algorithm>
#include <utility>

#include <pcor/realtime/result_uncertainty.hpp>

namespace pcor::internal {
namespace {

using Q = Quantity;

Quantities humidity(const Correction& correction) {
  return correction.chain.counts_vapor() ? Quantities{Q::vapor_pressure, Q::dew_point, Q::frost_point}
                                         : Quantities{};
}

Quantities thermometer(const Correction& correction) {
  return {correction.chain.derives_temperature() ? Q::recovery_temperature : Q::ambient_temperature};
}

Quantities beam(const Correction&) {
  return {Q::radome_dynamic_pressure,
          Q::attack_differential_pressure,
          Q::sideslip_differential_pressure,
          Q::attack,
          Q::sideslip,
          Q::lams_airspeed};
}

Quantities delta_p(const Correction& correction) {
  return correction.with == CorrectWith::lams ? Quantities{Q::static_defect, Q::lams_static_defect}
                                              : Quantities{Q::static_defect};
}

/// Quantities from which the given ones are measured or computed.
Quantities sources_of(const Correction& correction, const Quantities& quantities) {
  Quantities recorded;
  for (const Quantity read : quantities) {
    const Quantities sources = MeasuredQuantities::sources(correction.chain, read);
    recorded.insert(recorded.end(), sources.begin(), sources.end());
  }
  std::sort(recorded.begin(), recorded.end());
  return recorded;
}

Quantities law(const Correction& correction) {
  return sources_of(correction, StaticDefect::reads(correction));
}

/// Inputs of the effects that act before the ports.
Quantities read_before_ports(const Correction& correction, const std::vector<EffectLocation>& locations) {
  Quantities read;
  for (const EffectLocation location : locations) read = joined({read, correction.chain.read_at(location)});
  return sources_of(correction, read);
}

Quantities ambient_temperature(const Correction& correction) {
  return correction.chain.derives_temperature()
             ? joined({thermometer(correction), {Q::corrected_mach}, humidity(correction)})
             : thermometer(correction);
}

/// Adds the uncertainties of the results. CF marks the standard error of a quantity by a modifier after its
/// standard name.
std::vector<OutputRow> with_uncertainties(std::vector<OutputRow> table) {
  for (const UncertainResult& each : uncertain_results) {
    OutputRow row = *std::find_if(table.begin(), table.end(),
                                  [&each](const OutputRow& other) { return other.quantity == each.result; });
    row.name += uncertainty_ending;
    row.quantity = each.uncertainty;
    row.long_name = "Standard uncertainty of " + row.long_name;
    if (!row.standard_name.empty()) row.standard_name += " standard_error";
    row.from = [](const Correction&) { return Quantities{}; };
    row.uncertainty_of = each.result;
    table.push_back(std::move(row));
  }
  return table;
}

}  // namespace

const std::vector<OutputRow>& output_table() {
  static const std::vector<OutputRow> table = with_uncertainties(
      {{"PCOR", Q::static_defect, "Static defect (delta-p) of the model", "", "Aircraft State", law},
       {"PCOR_LAMS", Q::lams_static_defect, "Static defect (delta-p) from LAMS", "", "Aircraft State",
        [](const Correction& c) {
          return joined({{Q::static_pressure, Q::dynamic_pressure}, beam(c), thermometer(c), humidity(c)});
        }},
       {"PSXC", Q::corrected_static_pressure, "Corrected Static Pressure", "air_pressure", "Atmos. State",
        [](const Correction& c) {
          return joined(
              {{Q::static_pressure},
               delta_p(c),
               read_before_ports(c, {EffectLocation::static_transducer, EffectLocation::static_line})});
        }},
       {"QCXC", Q::corrected_dynamic_pressure, "Corrected Dynamic Pressure", "", "Aircraft State",
        [](const Correction& c) {
          return joined(
              {{Q::dynamic_pressure},
               delta_p(c),
               read_before_ports(c, {EffectLocation::dynamic_transducer, EffectLocation::static_line,
                                     EffectLocation::total_line, EffectLocation::pitot})});
        }},
       {"MACHX", Q::corrected_mach, "Aircraft Mach Number", "", "Aircraft State",
        [](const Correction& c) {
          return joined({{Q::corrected_static_pressure, Q::corrected_dynamic_pressure}, humidity(c)});
        }},
       {"ATX", Q::ambient_temperature, "Ambient Temperature", "air_temperature", "Atmos. State",
        ambient_temperature},
       {"TASX", Q::corrected_airspeed, "Aircraft True Airspeed", "platform_speed_wrt_air", "Aircraft State",
        [](const Correction& c) {
          return joined({{Q::corrected_mach, Q::ambient_temperature}, humidity(c)});
        }},
       {"ATLAMS", Q::lams_temperature, "Ambient Temperature from LAMS", "air_temperature", "Atmos. State",
        [](const Correction& c) {
          return joined({beam(c), {Q::corrected_mach}, humidity(c)});
        }},
       {"ATLAMSF", Q::filtered_lams_temperature, "Ambient Temperature from LAMS, without periods under 3 s",
        "air_temperature", "Atmos. State", [](const Correction&) { return Quantities{Q::lams_temperature}; },
        true},
       {"QCLAMS", Q::lams_dynamic_pressure, "Dynamic Pressure from LAMS", "", "Aircraft State",
        [](const Correction& c) {
          return joined({beam(c), {Q::corrected_static_pressure, Q::ambient_temperature}, humidity(c)});
        }},
       {"HYDSTEP", Q::height_step, "Hydrostatic height step per kelvin, -(R_a/g0) ln(p_i/p_(i-1))", "",
        "Atmos. State", [](const Correction& c) {
          return joined({{Q::corrected_static_pressure}, humidity(c)});
        }}});
  return table;
}

std::vector<std::string> output_names() {
  std::vector<std::string> names;
  for (const OutputRow& row : output_table()) names.push_back(row.name);
  names.emplace_back(quality_output);
  return names;
}

}  // namespace pcor::internal
