#include "roles/plausible_pressure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/physics/standard_atmosphere.hpp>
#include "base/quoting.hpp"
#include "numerics/median.hpp"
#include "numerics/missing.hpp"
#include "roles/recorded_series.hpp"

namespace pcor::internal {
namespace {

constexpr std::size_t fewest = 20;  // values that tell

std::string stated_unit(const Flight& flight, const VariableNaming& family, const std::string& variable) {
  const std::string stated = family.unit_of(variable);
  return stated.empty() ? flight.variable(variable).units : stated;
}

/// Some thousand values from the begin, the middle and the end, in the unit of the role; empty where it
/// cannot be read.
std::vector<double> some_values(const Flight& flight, const VariableNaming& family,
                                const std::string& variable, Quantity role) {
  std::vector<double> values;
  if (!has_values(flight, variable, std::string(info_of(role).unit), family.unit_of(variable))) return values;
  const UnitConversion conversion =
      flight.conversion(variable, std::string(info_of(role).unit), "", family.unit_of(variable));
  const std::vector<RecordBlock> blocks = flight.blocks();
  for (const std::size_t k : std::set<std::size_t>{0, blocks.size() / 2, blocks.size() - 1}) {
    values.resize(values.size() + blocks[k].count);
    flight.read_at_rate(1, variable, blocks[k], conversion,
                        values.data() + (values.size() - blocks[k].count));
  }
  return values;
}

/// The median of what is recorded over what is expected; NaN where too little tells, or where it is not about
/// the same all the time, so that a wrong unit is not the reason.
double ratio_of(const std::vector<double>& pressure, const std::vector<double>& expected) {
  constexpr double steady = 0.05;
  std::vector<double> ratios;
  for (std::size_t i = 0; i < std::min(pressure.size(), expected.size()); ++i) {
    const double ratio = pressure[i] / expected[i];
    if (std::isfinite(ratio)) ratios.push_back(ratio);
  }
  if (ratios.size() < fewest) return nan;
  const double middle = median(ratios);
  for (double& each : ratios) each = std::abs(each / middle - 1.0);
  return median(std::move(ratios)) > steady ? nan : middle;
}

/// Whether the heights fit the pressures if they are feet.
bool are_feet(const std::vector<double>& pressure, std::vector<double> heights) {
  for (double& height : heights) height = standard_pressure(0.3048 * height);
  return std::abs(ratio_of(pressure, heights) - 1.0) < 0.1;
}

/// The unit in which a pressure that is `ratio` of what it should be would be right.
std::string unit_that_fits(const std::string& own, double ratio) {
  const auto in_hpa = [](const std::string& unit) {
    return UnitConversion::between(unit, "hPa", {}).scale();
  };
  for (const char* const unit : {"hPa", "Pa", "kPa"}) {
    if (std::abs(ratio * in_hpa(unit) / in_hpa(own) - 1.0) < 0.1) return unit;
  }
  return {};
}

/// A height of GPS; that of the pressure says what the pressure does.
std::string height_of(const Flight& flight, const ModelDefinition& model, const VariableNaming& family) {
  const auto named = model.variables.find(Quantity::altitude);
  if (named != model.variables.end()) return named->second;
  for (const std::string& name : family.names_of("altitude")) {
    if (has_values(flight, name, "m", family.unit_of(name))) return name;
  }
  return {};
}

}  // namespace

std::optional<ImpossiblePressure> impossible_pressure(const Flight& flight, const ModelDefinition& model) {
  const auto named = model.variables.find(Quantity::static_pressure);
  if (named == model.variables.end() || model.units.count(Quantity::static_pressure) != 0)
    return std::nullopt;
  const std::string& variable = named->second;
  const VariableNaming& family = family_of(model, flight);
  if (!family.unit_of(variable).empty()) return std::nullopt;
  const std::vector<double> pressure = some_values(flight, family, variable, Quantity::static_pressure);
  if (pressure.empty()) return std::nullopt;
  const auto finding = [&](double ratio, const std::string& against) {
    return ImpossiblePressure{ratio, against, unit_that_fits(stated_unit(flight, family, variable), ratio)};
  };
  const std::string height = height_of(flight, model, family);
  if (!height.empty() && model.units.count(Quantity::altitude) == 0) {
    std::vector<double> expected = some_values(flight, family, height, Quantity::altitude);
    double most = 0.1;
    if (const double middle = median(expected); middle > 11000.0) most += 1e-5 * (middle - 11000.0);
    const bool is_wrong_height = are_feet(pressure, expected);
    std::transform(expected.begin(), expected.end(), expected.begin(), standard_pressure);
    const double ratio = ratio_of(pressure, expected);
    if (std::abs(ratio - 1.0) > most && !is_wrong_height) return finding(ratio, "the height " + height);
  }
  for (const auto* pairs : {&family.measured, &family.processed}) {
    for (const PressurePair& pair : *pairs) {
      if (pair.static_pressure == variable) continue;
      const double ratio =
          ratio_of(pressure, some_values(flight, family, pair.static_pressure, Quantity::static_pressure));
      if (std::abs(ratio - 1.0) > 0.05) return finding(ratio, pair.static_pressure);
    }
  }
  return std::nullopt;
}

void require_possible_pressure(const Flight& flight, const ModelDefinition& model) {
  const std::optional<ImpossiblePressure> wrong = impossible_pressure(flight, model);
  // Where no unit fits, the other sensor may be the one that is wrong: inspect lists it.
  if (!wrong || wrong->unit.empty()) return;
  const std::string& variable = model.variables.at(Quantity::static_pressure);
  const std::string unit = flight.variable(variable).units;
  throw Error(
      Error::Code::unit,
      fmt::format(
          "{}: {} in {} is {:.3g} times what {} says{}; state the right unit in the [units] of the model, "
          "static_pressure = {}, or name another variable there; the unit that a model states is believed",
          flight.path().string(), variable, quote(unit), wrong->ratio, wrong->against,
          wrong->unit.empty() ? "" : fmt::format(", as if it were in {}", wrong->unit),
          wrong->unit.empty() ? quote(unit) : fmt::format("\"{}\"", wrong->unit)));
}

}  // namespace pcor::internal
