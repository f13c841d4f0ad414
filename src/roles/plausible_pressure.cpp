#include "roles/plausible_pressure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
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

constexpr std::size_t fewest = 20;    // minimum number of values
constexpr double flown = 20.0;        // hPa, dynamic pressure in flight
constexpr std::size_t a_minute = 60;  // values

/// Median ratio of recorded to expected values; NaN if there are too few values, or if the ratio varies, so
/// that a wrong unit is not the reason.
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

/// Whether the heights, if they are feet, fit the pressures within 10 % at all heights, and better than
/// metres and a pressure of a wrong scale do, which agree with feet near one height only. Level flight agrees
/// with both; the heights are then in feet unless a unit explains the pressure.
bool are_feet(const std::vector<double>& pressure, const std::vector<double>& heights, bool unit_fits) {
  constexpr std::size_t groups = 20;
  constexpr double level = 1000.0;  // range of the values
  std::vector<std::pair<double, double>> pairs;
  for (std::size_t i = 0; i < std::min(pressure.size(), heights.size()); ++i) {
    if (pressure[i] > 0.0 && std::isfinite(standard_pressure(heights[i])))
      pairs.emplace_back(heights[i], pressure[i]);
  }
  if (pairs.size() < fewest) return false;
  std::sort(pairs.begin(), pairs.end());
  // Least and greatest of the medians of groups of increasing height: of the ratio if the values are feet, of
  // the ratio if they are metres, and of the values.
  std::array<double, 3> least{}, greatest{};
  for (std::size_t group = 0; group < groups; ++group) {
    std::array<std::vector<double>, 3> values;
    for (std::size_t i = group * pairs.size() / groups; i < (group + 1) * pairs.size() / groups; ++i) {
      const auto [height, recorded] = pairs[i];
      values[0].push_back(recorded / standard_pressure(0.3048 * height));
      values[1].push_back(recorded / standard_pressure(height));
      values[2].push_back(height);
    }
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double middle = median(values[k]);
      least[k] = group == 0 ? middle : std::min(least[k], middle);
      greatest[k] = group == 0 ? middle : std::max(greatest[k], middle);
    }
  }
  if (least[0] < 0.9 || greatest[0] > 1.1) return false;
  return greatest[2] - least[2] < level ? !unit_fits : greatest[0] / least[0] < greatest[1] / least[1];
}

/// The unit that explains a pressure of `ratio` times the expected one. Empty if no unit does, or only
/// `current_unit`.
std::string unit_that_fits(const std::string& current_unit, double ratio) {
  for (const auto& [unit, within] :
       {std::pair("hPa", 0.1), std::pair("Pa", 0.1), std::pair("kPa", 0.1), std::pair("mmHg", 0.05),
        std::pair("inHg", 0.05), std::pair("psi", 0.05)}) {
    const double scale = UnitConversion::between(unit, current_unit, {}).scale();
    if (std::abs(scale - 1.0) > within && std::abs(ratio * scale - 1.0) < within) return unit;
  }
  return {};
}

/// Holds the pressures of a model against each other, the height and other systems.
class PressureCheck {
 public:
  PressureCheck(const Flight& flight, const ModelDefinition& model)
      : flight_(flight),
        model_(model),
        naming_(naming_of(model, flight)),
        static_pressure_(values_of(Quantity::static_pressure)) {}

  std::optional<ImpossiblePressure> find() const {
    std::optional<ImpossiblePressure> wrong = static_pressure();
    if (!wrong) wrong = dynamic_pressure();
    const std::optional<ImpossiblePressure> below = static_below_dynamic();
    if (!wrong || !below) return wrong ? wrong : below;
    // An exchanged dynamic pressure is the static pressure of the height; a real one is at most 0.83 of it up
    // to Mach 0.97.
    constexpr double least = 1.2;
    const bool are_exchanged =
        wrong->role == Quantity::static_pressure && below->ratio < least * wrong->ratio;
    return are_exchanged ? below : wrong;
  }

  /// Adds a warning for each system that agrees in most of the flight, but not in a part.
  void note_parts(Notes& notes) const {
    if (!is_in_doubt(Quantity::static_pressure)) return;
    const std::string& variable = model_.variables.at(Quantity::static_pressure);
    const auto compare = [&](const PressurePair& pair, bool is_measured, const std::vector<double>& other,
                             double ratio) {
      if (!is_measured || !(std::abs(ratio - 1.0) <= max_of_other)) return;
      std::size_t contradicting = 0;
      for (std::size_t i = 0; i < other.size(); ++i) {
        const bool have_values = static_pressure_[i] > 0.0 && other[i] > 0.0;
        contradicting += have_values && std::abs(static_pressure_[i] / other[i] - 1.0) > max_of_other ? 1 : 0;
      }
      if (contradicting < a_minute) return;
      notes.push_back(warning_note(fmt::format(
          "check {0} and {1}: {0} differs from {1} by more than {2:g} % in {3} of {4} records, so one of the "
          "sensors failed",
          variable, pair.static_pressure, 100.0 * max_of_other, contradicting, other.size())));
    };
    each_other_system(Quantity::static_pressure, compare);
  }

  /// The unit in which a role is read.
  std::string unit_of(Quantity role) const {
    const std::string stated = unit_of_role(model_, naming_, role);
    return stated.empty() ? flight_.variable(model_.variables.at(role)).units : stated;
  }

 private:
  static constexpr double max_of_other = 0.05;
  static constexpr double max_of_dynamic = 0.1;  // includes the errors of two static pressures

  std::optional<ImpossiblePressure> static_pressure() const {
    if (!is_in_doubt(Quantity::static_pressure) || static_pressure_.empty()) return std::nullopt;
    double of_height, max_of_height;
    std::tie(of_height, max_of_height) = by_height();
    bool is_confirmed = false;
    std::optional<ImpossiblePressure> contradicted;
    const auto compare = [&](const PressurePair& pair, bool is_measured, const auto& /*other*/,
                             double ratio) {
      is_confirmed = is_confirmed || (is_measured && std::abs(ratio - 1.0) <= max_of_other);
      const bool other_is_wrong =
          std::abs(of_height - 1.0) <= max_of_height && std::abs(of_height / ratio - 1.0) > max_of_height;
      if (!contradicted && std::abs(ratio - 1.0) > max_of_other && !other_is_wrong)
        contradicted = finding(Quantity::static_pressure, ratio, pair.static_pressure);
    };
    each_other_system(Quantity::static_pressure, compare);
    if (std::abs(of_height - 1.0) > max_of_height) {
      const ImpossiblePressure wrong =
          finding(Quantity::static_pressure, of_height, "the height " + height_variable());
      // Two systems may be wrong by the same unit; by other amounts the height is.
      if (!is_confirmed || !wrong.unit.empty()) return wrong;
    }
    return is_confirmed ? std::nullopt : contradicted;
  }

  std::optional<ImpossiblePressure> dynamic_pressure() const {
    if (!is_in_doubt(Quantity::dynamic_pressure)) return std::nullopt;
    const std::vector<double> recorded = values_of(Quantity::dynamic_pressure);
    bool is_confirmed = false;
    std::optional<ImpossiblePressure> contradicted;
    const auto compare = [&](const PressurePair& pair, bool is_measured, const std::vector<double>& other,
                             double static_ratio) {
      std::vector<double> expected = values_as(Quantity::dynamic_pressure, pair.dynamic_pressure);
      if (!(std::abs(static_ratio - 1.0) <= max_of_other)) return;
      for (std::size_t i = 0; i < expected.size(); ++i)
        expected[i] = expected[i] > flown ? other[i] + expected[i] - static_pressure_[i] : nan;
      const double ratio = ratio_of(recorded, expected);
      is_confirmed = is_confirmed || (is_measured && std::abs(ratio - 1.0) <= max_of_dynamic);
      if (!contradicted && std::abs(ratio - 1.0) > max_of_dynamic)
        contradicted = finding(Quantity::dynamic_pressure, ratio, pair.name());
    };
    each_other_system(Quantity::dynamic_pressure, compare);
    return is_confirmed ? std::nullopt : contradicted;
  }

  /// Also of units that the model states; one that differs from that of the file is then the likely cause. An
  /// exchange or a wrong unit holds in nearly all samples in flight, a failed sensor or a spike does not.
  std::optional<ImpossiblePressure> static_below_dynamic() const {
    constexpr double max_of_static = 1.5;
    const std::vector<double> dynamic_pressure = values_of(Quantity::dynamic_pressure);
    // In a wrong unit taxiing exceeds the absolute limit.
    const double in_flight = std::max(flown, 0.2 * median(dynamic_pressure));
    std::vector<double> ratios;
    for (std::size_t i = 0; i < std::min(static_pressure_.size(), dynamic_pressure.size()); ++i) {
      const double ratio = static_pressure_[i] / dynamic_pressure[i];
      if (dynamic_pressure[i] > in_flight && ratio > 0.0) ratios.push_back(ratio);
    }
    if (ratios.size() < a_minute) return std::nullopt;
    std::sort(ratios.begin(), ratios.end());
    if (!(ratios[ratios.size() * 95 / 100] * max_of_static < 1.0)) return std::nullopt;
    const double ratio = ratios[ratios.size() / 2];
    const std::string& p = model_.variables.at(Quantity::static_pressure);
    const std::string& q = model_.variables.at(Quantity::dynamic_pressure);
    // Factor of the values if they are read in another unit.
    const auto scale = [&](Quantity role, const std::string& unit) {
      const std::string stated = unit_of(role);
      return is_convertible(unit, stated) ? UnitConversion::between(unit, stated, {}).scale() : 1.0;
    };
    const std::string& unit_of_p = flight_.variable(p).units;
    if (ratio * scale(Quantity::static_pressure, unit_of_p) * max_of_static >= 1.0)
      return ImpossiblePressure{Quantity::static_pressure, ratio, q, unit_of_p};
    std::vector<std::string> units{flight_.variable(q).units};
    const auto [of_height, max_of_height] = by_height();
    if (std::abs(of_height - 1.0) <= max_of_height) units.insert(units.end(), {"hPa", "Pa"});
    for (const std::string& unit : units) {
      if (ratio * max_of_static >= scale(Quantity::dynamic_pressure, unit))
        return ImpossiblePressure{Quantity::dynamic_pressure, 1.0 / ratio, p, unit};
    }
    return ImpossiblePressure{Quantity::static_pressure, ratio, q, "", true};
  }

  /// Whether the unit of a role is that of the file, which may be wrong.
  bool is_in_doubt(Quantity role) const {
    const std::string variable = model_.variable_of(role);
    return !variable.empty() && model_.units.count(role) == 0 && naming_.unit_of(variable).empty();
  }

  /// A GPS height; the pressure height would always agree with the pressure.
  std::string height_variable() const {
    const std::string named = model_.variable_of(Quantity::altitude);
    return named.empty() ? first_with_values(flight_, naming_, "altitude") : named;
  }

  /// The values in the unit of the role; empty if the variable cannot be read.
  std::vector<double> values_as(Quantity role, const std::string& variable,
                                const std::string& stated = {}) const {
    const std::string unit = stated.empty() ? naming_.unit_of(variable) : stated;
    const std::string requested(info_of(role).unit);
    if (!has_values(flight_, variable, requested, unit)) return {};
    return read_values(flight_, variable, flight_.conversion(variable, requested, "", unit)).values;
  }

  std::vector<double> values_of(Quantity role) const {
    const std::string variable = model_.variable_of(role);
    if (variable.empty()) return {};
    return values_as(role, variable, unit_of_role(model_, naming_, role));
  }

  /// Ratio of the static pressure to that of the height, NaN if unknown, and its maximum difference from 1.
  std::pair<double, double> by_height() const {
    double max_of_height = 0.1;
    const std::string height = height_variable();
    if (height.empty() || model_.units.count(Quantity::altitude) != 0) return {nan, max_of_height};
    const std::vector<double> heights = values_as(Quantity::altitude, height);
    if (const double middle = median(heights); middle > 11000.0) max_of_height += 1e-5 * (middle - 11000.0);
    std::vector<double> expected(heights.size());
    std::transform(heights.begin(), heights.end(), expected.begin(), standard_pressure);
    const double ratio = ratio_of(static_pressure_, expected);
    if (!(std::abs(ratio - 1.0) > max_of_height)) return {ratio, max_of_height};
    const bool unit_fits = !unit_that_fits(unit_of(Quantity::static_pressure), ratio).empty();
    return {are_feet(static_pressure_, heights, unit_fits) ? nan : ratio, max_of_height};
  }

  ImpossiblePressure finding(Quantity role, double ratio, const std::string& against) const {
    return {role, ratio, "the value expected from " + against, unit_that_fits(unit_of(role), ratio)};
  }

  /// Calls `visit` for each pair of another system: the pair, whether it is as measured (a processed pair may
  /// depend on the pressure in doubt), its static pressure, and the ratio of the model's static pressure to
  /// it.
  template <class Visit>
  void each_other_system(Quantity role, const Visit& visit) const {
    for (const auto* pairs : {&naming_.measured, &naming_.processed}) {
      for (const PressurePair& pair : *pairs) {
        const bool is_static = role == Quantity::static_pressure;
        if ((is_static ? pair.static_pressure : pair.dynamic_pressure) == model_.variable_of(role)) continue;
        const std::vector<double> other = values_as(Quantity::static_pressure, pair.static_pressure);
        visit(pair, pairs == &naming_.measured, other, ratio_of(static_pressure_, other));
      }
    }
  }

  const Flight& flight_;
  const ModelDefinition& model_;
  const VariableNaming& naming_;
  std::vector<double> static_pressure_;
};

}  // namespace

std::optional<ImpossiblePressure> impossible_pressure(const Flight& flight, const ModelDefinition& model) {
  return PressureCheck(flight, model).find();
}

void require_possible_pressure(const Flight& flight, const ModelDefinition& model, Notes& notes) {
  const PressureCheck check(flight, model);
  const std::optional<ImpossiblePressure> wrong = check.find();
  if (!wrong) return check.note_parts(notes);
  const std::string& variable = model.variables.at(wrong->role);
  const std::string unit = check.unit_of(wrong->role);
  const std::string is_wrong = fmt::format("{}: {} in {} is {:.3g} times {}", flight.path().string(),
                                           variable, quote(unit), wrong->ratio, wrong->against);
  if (wrong->are_exchanged) {
    throw Error(
        Error::Code::variable,
        fmt::format("{}; if static_pressure and dynamic_pressure are exchanged in the [variables] of the "
                    "model, set static_pressure = \"{}\", otherwise the right unit in its [units], unless a "
                    "sensor failed",
                    is_wrong, wrong->against));
  }
  if (wrong->unit.empty()) {
    throw Error(Error::Code::variable,
                fmt::format("{}; no unit explains this ratio, so a sensor or its calibration is wrong; name "
                            "another variable for {} in the [variables] of the model",
                            is_wrong, info_of(wrong->role).name));
  }
  throw Error(
      Error::Code::unit,
      fmt::format(
          "{}, as if it were in {}; set the right unit in the [units] of the model, {} = \"{}\", or name "
          "another variable; heights and other systems do not check a unit set there",
          is_wrong, wrong->unit, info_of(wrong->role).name, wrong->unit));
}

}  // namespace pcor::internal
