#include "roles/recorded_model.hpp"

#include <algorithm>
#include <array>

#include <pcor/words/error.hpp>

namespace pcor::internal {
namespace {

/// Whether a flight has values of a variable whose unit fits.
bool has_values(const Flight& flight, const std::string& variable, const std::string& unit) {
  if (!flight.has(variable) || !flight.variable(variable).is_series) return false;
  try {
    flight.conversion(variable, unit);
    flight.require_values(variable);
  } catch (const Error&) {
    return false;
  }
  return true;
}

/// Gives the model the first of the variables that has values; false where none has.
bool add_first(const Flight& flight, const std::vector<std::string>& names, Quantity role, ModelFile& model) {
  const auto found = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
    return has_values(flight, name, std::string(facts_of(role).unit));
  });
  if (found == names.end()) return false;
  model.variables[role] = *found;
  return true;
}

bool has_pair(const Flight& flight, const PressurePair& pair) {
  return has_pressure(flight, pair.static_pressure) && has_pressure(flight, pair.dynamic_pressure);
}

}  // namespace

bool has_pressure(const Flight& flight, const std::string& variable) {
  return has_values(flight, variable, "hPa");
}

std::vector<PressurePair> measured_pairs(const Flight& flight) {
  const std::array<PressurePair, 4> known{
      {{"PSFD", "QCF"}, {"PSFRD", "QCFR"}, {"PSF", "QCF"}, {"PS_A", "QC_A"}}};
  std::vector<PressurePair> pairs;
  std::copy_if(known.begin(), known.end(), std::back_inserter(pairs),
               [&](const PressurePair& pair) { return has_pair(flight, pair); });
  return pairs;
}

ModelFile model_of(const PressurePair& pair) {
  ModelFile model;
  model.model.name = pair.name() + " as recorded";
  model.variables[Quantity::static_pressure] = pair.static_pressure;
  model.variables[Quantity::dynamic_pressure] = pair.dynamic_pressure;
  return model;
}

std::optional<ModelFile> recorded_model(const Flight& flight) {
  std::vector<PressurePair> pairs{{"PSXC", "QCXC"}, {"PSX", "QCX"}};
  const std::vector<PressurePair> measured = measured_pairs(flight);
  pairs.insert(pairs.end(), measured.begin(), measured.end());
  const auto pair = std::find_if(pairs.begin(), pairs.end(),
                                 [&](const PressurePair& each) { return has_pair(flight, each); });
  if (pair == pairs.end()) return std::nullopt;
  ModelFile model = model_of(*pair);
  constexpr double usual_recovery = 0.95;
  if (!add_first(flight, {"ATX", "AT_A"}, Quantity::ambient_temperature, model) &&
      add_first(flight, {"TTX", "TTRR", "TTRL", "RTF1", "RTX", "TTHR1", "RTH1"},
                Quantity::recovery_temperature, model)) {
    model.model.recovery = {{usual_recovery, 0.0, 0.0, 0.0}};
  }
  if (!add_first(flight, {"EDPC", "EWX"}, Quantity::vapor_pressure, model) &&
      !add_first(flight, {"DPXC"}, Quantity::dew_point, model)) {
    model.model.moist = false;
  }
  return model;
}

}  // namespace pcor::internal
