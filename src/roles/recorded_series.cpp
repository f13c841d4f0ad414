#include "roles/recorded_series.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <pcor/base/error.hpp>
#include "roles/role_evidence.hpp"

namespace pcor::internal {
namespace {

/// Uses `variable` for an empty series if the variable exists, has values and a convertible unit.
/// @param stated the unit that the model states
void try_variable(const Flight& flight, const std::string& variable, const std::string& stated,
                  const QuantityInfo& info, RecordedSeries& series) {
  if (!series.values.empty() || !flight.has(variable) || !flight.variable(variable).is_series) return;
  const std::string unit = stated.empty() ? flight.variable(variable).units : stated;
  if (unit.empty() && series.without_unit.empty()) series.without_unit = variable;
  try {
    const UnitConversion conversion =
        UnitConversion::between(unit, std::string(info.unit), {variable, flight.path().string(), ""});
    std::vector<double> values =
        read_values(flight, variable, within_plausible_range(conversion, info)).values;
    if (std::all_of(values.begin(), values.end(), [](double x) { return std::isnan(x); })) return;
    series.variable = variable;
    series.values = std::move(values);
  } catch (const Error& error) {
    if (error.code() == Error::Code::file) throw;
    return;  // a variable with this name and another unit is a different quantity
  }
}

bool has_role(const Flight& flight, const VariableNaming& naming, const std::string& variable,
              Quantity role) {
  return has_values(flight, variable, std::string(info_of(role).unit), naming.unit_of(variable));
}

}  // namespace

ReadValues read_values(const Flight& flight, const std::string& variable, const UnitConversion& conversion,
                       int rate) {
  ReadValues read;
  read.values.resize(flight.records() * static_cast<std::size_t>(rate));
  read.excluded = flight.read_at_rate(rate, variable, conversion, read.values.data());
  return read;
}

std::vector<double> some_values(const Flight& flight, const std::string& variable,
                                const UnitConversion& conversion) {
  std::vector<double> values;
  const std::vector<RecordBlock> blocks = flight.blocks();
  for (const std::size_t k : std::set<std::size_t>{0, blocks.size() / 2, blocks.size() - 1}) {
    values.resize(values.size() + blocks[k].count);
    flight.read_at_rate(1, variable, blocks[k], conversion,
                        values.data() + (values.size() - blocks[k].count));
  }
  return values;
}

std::vector<double> record_times(const Flight& flight) {
  std::vector<double> times(flight.records());
  for (const RecordBlock block : blocks_of(flight.records()))
    flight.read_sample_times(block, 1, times.data() + block.first);
  return times;
}

RecordedSeries read_usual(const Flight& flight, const VariableNaming& naming, std::string_view name) {
  RecordedSeries series;
  for (const std::string& variable : naming.names_of(name))
    try_variable(flight, variable, naming.unit_of(variable), *series_named(name), series);
  return series;
}

RecordedSeries read_longitude(const Flight& flight, const ModelDefinition& model) {
  constexpr std::string_view name = "longitude";
  RecordedSeries series = read_usual(flight, naming_of(model, flight), name);
  if (series.values.empty())
    try_variable(flight, sure_variable(flight, name), "", *series_named(name), series);
  return series;
}

RecordedSeries read_role(const Flight& flight, const ModelDefinition& model, Quantity role) {
  const QuantityInfo& info = info_of(role);
  const VariableNaming& naming = naming_of(model, flight);
  RecordedSeries series;
  const auto given = model.variables.find(role);
  if (given != model.variables.end())
    try_variable(flight, given->second, unit_of_role(model, naming, role), info, series);
  for (const std::string& name : usual_variables(naming, role)) {
    if (given == model.variables.end() || name != given->second)
      try_variable(flight, name, naming.unit_of(name), info, series);
  }
  return series;
}

bool has_values(const Flight& flight, const std::string& variable, const std::string& unit,
                const std::string& stated) {
  if (!flight.has(variable) || !flight.variable(variable).is_series) return false;
  try {
    flight.conversion(variable, unit, "", stated);
    flight.require_values(variable);
  } catch (const Error& error) {
    if (error.code() == Error::Code::file) throw;
    return false;
  }
  return true;
}

bool has_values(const Flight& flight, const VariableNaming& naming, const PressurePair& pair) {
  return has_role(flight, naming, pair.static_pressure, Quantity::static_pressure) &&
         has_role(flight, naming, pair.dynamic_pressure, Quantity::dynamic_pressure);
}

bool has_values(const Flight& flight, const VariableNaming& naming, const Thermometer& thermometer) {
  return has_role(flight, naming, thermometer.variable, Quantity::recovery_temperature);
}

std::string first_with_values(const Flight& flight, const VariableNaming& naming, std::string_view name) {
  const std::string unit(series_named(name)->unit);
  for (const std::string& variable : naming.names_of(name)) {
    if (has_values(flight, variable, unit, naming.unit_of(variable))) return variable;
  }
  return "";
}

std::string processed_static_pressure(const Flight& flight, const VariableNaming& naming) {
  for (const PressurePair& pair : naming.processed) {
    if (has_role(flight, naming, pair.static_pressure, Quantity::static_pressure))
      return pair.static_pressure;
  }
  return "";
}

}  // namespace pcor::internal
