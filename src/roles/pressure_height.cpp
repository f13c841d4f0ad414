#include "roles/pressure_height.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <pcor/base/error.hpp>
#include <pcor/physics/standard_atmosphere.hpp>
#include "numerics/median.hpp"
#include "numerics/missing.hpp"
#include "roles/recorded_series.hpp"
#include "roles/resolution.hpp"
#include "roles/usual_variables.hpp"

namespace pcor::internal {
namespace {

using Kind = HeightEvidence::Kind;

constexpr std::size_t min_values = 60;
constexpr double min_range = 30.0;     // hPa, about 250 m: a height of GPS departs by 1 to 5 % of its change
constexpr double same_scatter = 0.15;  // hPa, about 1.2 m: two readings of one pressure
constexpr double same_bias = 1.0;      // hPa; by the weather it is 5 to 12 in four real flights
constexpr double near_bias = 3.0;      // hPa: a pressure that is corrected departs so from the raw one
constexpr double near_scatter = 2.0;   // hPa
constexpr double min_climb = 300.0;    // m, minimum range of pressure altitude for a slope
constexpr double feet_in_metre = 1.0 / 0.3048;

/// Real air is within 20 % of the standard atmosphere.
bool is_possible_slope(double slope) { return slope > 0.75 && slope < 1.25; }

/// Change of the height with the pressure altitude between the medians of the lowest and of the highest fifth
/// of the pressure altitudes, which spikes and jumps hardly change. NaN if these medians differ by less than
/// 300 m.
double slope_of(const std::vector<double>& heights, const std::vector<double>& pressures) {
  std::vector<std::pair<double, double>> pairs;  // pressure altitude and height
  for (std::size_t i = 0; i < heights.size(); ++i)
    pairs.emplace_back(pressure_altitude(pressures[i]), heights[i]);
  std::sort(pairs.begin(), pairs.end());
  const auto fifth = static_cast<std::ptrdiff_t>(pairs.size() / 5);
  const auto medians = [](auto first, auto last) {
    std::vector<double> altitudes;
    std::vector<double> values;
    for (; first != last; ++first) {
      altitudes.push_back(first->first);
      values.push_back(first->second);
    }
    return std::pair(median(std::move(altitudes)), median(std::move(values)));
  };
  const auto low = medians(pairs.begin(), pairs.begin() + fifth);
  const auto high = medians(pairs.end() - fifth, pairs.end());
  const double climb = high.first - low.first;
  return climb > min_climb ? (high.second - low.second) / climb : nan;
}

}  // namespace

std::string HeightEvidence::slope_problem(const std::string& variable) const {
  if (std::isnan(slope) || is_possible_slope(slope)) return "";
  std::string problem =
      fmt::format("{}: values increase {:.2f} times as fast as the pressure altitude, ", variable, slope);
  const bool is_in_feet = is_possible_slope(slope / feet_in_metre);
  if (is_in_feet || is_possible_slope(slope * feet_in_metre))
    return problem +
           fmt::format(R"(so they are in {0}; set [variables] altitude = "{1}" and [units] altitude = )"
                       R"("{2}" in the model, or correct the units attribute in the file)",
                       is_in_feet ? "feet" : "metres", variable, is_in_feet ? "ft" : "m");
  return problem + "impossible in any atmosphere; check both variables";
}

HeightEvidence compare_height(const std::vector<double>& height, const std::vector<double>& pressure) {
  HeightEvidence evidence;
  std::vector<double> differences;
  std::vector<double> pressures;
  std::vector<double> heights;
  for (std::size_t i = 0; i < std::min(height.size(), pressure.size()); ++i) {
    const double difference = standard_pressure(height[i]) - pressure[i];
    if (!std::isfinite(difference)) continue;
    differences.push_back(difference);
    pressures.push_back(pressure[i]);
    heights.push_back(height[i]);
  }
  if (differences.size() < min_values) return evidence;
  evidence.bias = median(differences);
  for (double& each : differences) each = std::abs(each - evidence.bias);
  evidence.scatter = deviation_of_median * median(std::move(differences));
  const auto [minimum, maximum] = std::minmax_element(pressures.begin(), pressures.end());
  evidence.slope = slope_of(heights, pressures);
  // Both are recorded in steps; the gradient converts a step of height to one of pressure.
  const double middle = pressure_altitude(median(pressures));
  const double gradient = standard_pressure(middle) - standard_pressure(middle + 1.0);
  const double rounding =
      std::hypot(rounding_of(resolution_of(pressure)), gradient * rounding_of(resolution_of(height)));
  const double allowed = std::max(same_scatter, 1.5 * rounding);
  const bool is_conclusive = *maximum - *minimum >= min_range || evidence.scatter < 0.1 * same_scatter;
  if (is_conclusive && std::abs(evidence.bias) < same_bias && evidence.scatter < allowed) {
    evidence.kind = Kind::pressure_altitude;
  } else if (std::abs(evidence.bias) < near_bias && evidence.scatter < near_scatter) {
    evidence.kind = Kind::undecided;
  }
  return evidence;
}

HeightEvidence height_evidence(const Flight& flight, const std::vector<double>& height,
                               const std::vector<StatedPressure>& pressures) {
  HeightEvidence closest;
  double slope = nan;  // slope with the first pressure
  for (const auto& [variable, unit] : pressures) {
    try {
      const QuantityInfo& info = info_of(Quantity::static_pressure);
      const UnitConversion conversion = flight.conversion(variable, std::string(info.unit), "", unit);
      HeightEvidence evidence = compare_height(
          height, read_values(flight, variable, within_plausible_range(conversion, info)).values);
      evidence.pressure = variable;
      if (closest.pressure.empty()) slope = evidence.slope;
      const bool is_closer = evidence.kind > closest.kind ||
                             (evidence.kind == closest.kind && evidence.scatter < closest.scatter);
      if (closest.pressure.empty() || is_closer) closest = std::move(evidence);
    } catch (const Error& error) {
      if (error.code() == Error::Code::file) throw;
    }
  }
  closest.slope = slope;
  return closest;
}

std::vector<StatedPressure> static_pressures_of(const Flight& flight, const ModelDefinition& model) {
  std::vector<StatedPressure> pressures;
  const auto add = [&](const std::string& variable, const std::string& unit) {
    const bool is_new = std::none_of(pressures.begin(), pressures.end(),
                                     [&](const StatedPressure& each) { return each.variable == variable; });
    if (is_new && has_values(flight, variable, "hPa", unit)) pressures.push_back({variable, unit});
  };
  const VariableNaming& naming = naming_of(model, flight);
  const auto named = model.variables.find(Quantity::static_pressure);
  if (named != model.variables.end())
    add(named->second, unit_of_role(model, naming, Quantity::static_pressure));
  for (const auto* pairs : {&naming.measured, &naming.processed}) {
    for (const PressurePair& pair : *pairs) add(pair.static_pressure, naming.unit_of(pair.static_pressure));
  }
  return pressures;
}

std::string to_string(const HeightEvidence& evidence) {
  return fmt::format(
      "its pressure in the standard atmosphere agrees with {} within {:.2f} hPa, mean {:+.2f} hPa",
      evidence.pressure, evidence.scatter, evidence.bias);
}

}  // namespace pcor::internal
