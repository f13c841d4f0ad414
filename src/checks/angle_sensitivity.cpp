#include "checks/angle_sensitivity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include <pcor/base/utc.hpp>
#include <pcor/physics/constants.hpp>
#include <pcor/physics/geodesy.hpp>
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

/// Smallest relevant change of the residual over the swing of an angle, hPa.
constexpr double min_swing_change = 0.3;

/// Peak-to-peak range of a sine in standard deviations.
const double ends_of_sine = 2.0 * std::sqrt(2.0);

std::vector<double> difference(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

std::vector<double> from_height(const Flown& flown) {
  const FlightAir& air = flown.flight->air;
  const std::vector<double> pressure = flown.of(air.pressure);
  std::vector<double> residual = flown.of(air.geopotential_height);
  const double scale =
      flown.mean(air.gas_constant) * flown.mean(air.temperature) / constants::standard_gravity;  // m
  const double mean_pressure = mean_of(pressure);
  const double mean_height = mean_of(residual);
  for (std::size_t i = 0; i < residual.size(); ++i) {
    const double height = mean_height - scale * std::log(pressure[i] / mean_pressure);
    residual[i] = -pressure[i] / scale * (residual[i] - height);
  }
  return residual;
}

std::optional<AngleReference> witness_of(const CheckedFlight& flight,
                                         const std::vector<AngleReference>& witnesses) {
  const auto found = std::find_if(witnesses.begin(), witnesses.end(),
                                  [&](AngleReference witness) { return has(flight, witness); });
  return found == witnesses.end() ? std::nullopt : std::optional<AngleReference>(*found);
}

/// Combined result of all manoeuvres.
struct Totals {
  Estimated slope, across, bend, bent;
};

Estimated all_of(const std::vector<AngleSensitivity>& manoeuvres, Estimated AngleSensitivity::*number) {
  std::vector<Estimated> estimates;
  for (const AngleSensitivity& each : manoeuvres) estimates.push_back(each.*number);
  return combined(estimates);
}

Totals totals_of(const std::vector<AngleSensitivity>& manoeuvres) {
  Totals totals;
  totals.slope = all_of(manoeuvres, &AngleSensitivity::slope);
  totals.bend = all_of(manoeuvres, &AngleSensitivity::bend);
  std::vector<double> swings;
  std::vector<double> squares;
  for (const AngleSensitivity& each : manoeuvres) {
    swings.push_back(ends_of_sine * each.swing);
    squares.push_back(each.greatest * each.greatest);
  }
  const auto times = [](const Estimated& number, double factor) {
    return Estimated{factor * number.value, factor * number.error};
  };
  totals.across = times(totals.slope, mean_of(swings));
  totals.bent = times(totals.bend, mean_of(squares));
  return totals;
}

ReportTable table_of(const std::vector<AngleSensitivity>& manoeuvres, const AngleCheck& check) {
  ReportTable table;
  table.title = fmt::format("Each {}", info_of(check.regime).name);
  table.caption = fmt::format(
      "Slope of the residual against the {}, fitted with a drift in time, and its effect from one end of the "
      "swing to the other.",
      check.angle);
  const bool with_ratio = std::any_of(manoeuvres.begin(), manoeuvres.end(),
                                      [](const auto& each) { return std::isfinite(each.per_ratio.value); });
  table.headers = {"manoeuvre", "compared with", "swing, deg", "slope, hPa/deg"};
  if (with_ratio) table.headers.emplace_back("per ratio, hPa");
  if (check.with_square) table.headers.emplace_back("square, hPa/deg2");
  table.headers.insert(table.headers.end(), {"across, hPa", "scatter, hPa"});
  for (const AngleSensitivity& each : manoeuvres) {
    std::vector<std::string> row{
        each.flown.location(), std::string(to_string(*witness_of(*each.flown.flight, check.witnesses))),
        fmt::format("{:.1f}", 0.5 * ends_of_sine * each.swing), with_error(each.slope, "", 3)};
    if (with_ratio)
      row.push_back(std::isfinite(each.per_ratio.value) ? with_error(each.per_ratio, "", 1) : "not recorded");
    if (check.with_square) row.push_back(with_error(each.bend, "", 4));
    row.insert(row.end(), {with_error(each.across(), ""), fmt::format("{:.2f}", each.scatter)});
    table.rows.push_back(std::move(row));
  }
  return table;
}

void add_pictures(const CheckedFlights& flights, const std::vector<AngleSensitivity>& manoeuvres,
                  const AngleCheck& check, CheckResult& result) {
  const std::string residual = check.name + " residual";
  const std::string angle = check.name + " angle";
  const auto residuals = [&](const CheckedFlight& flight) {
    std::vector<double> values(flight.air.size(), nan);
    for (const AngleSensitivity& each : manoeuvres) {
      if (each.flown.flight != &flight) continue;
      for (std::size_t i = 0; i < each.residual.size(); ++i) values[each.flown.places[i]] = each.residual[i];
    }
    return values;
  };
  std::vector<Flown> all;
  for (const AngleSensitivity& each : manoeuvres) all.push_back(each.flown);
  result.columns.push_back(column_of(flights, residual, "residual minus its mean", "hPa", residuals));
  result.columns.push_back(column_of(flights, angle, check.angle, "deg", [&](const CheckedFlight& flight) {
    return only_in(flight, all, check.angle_of(flight.air));
  }));
  BinnedPanel binned;
  binned.title = fmt::format("Residual against the {} in {}s", check.angle, info_of(check.regime).name);
  binned.caption =
      "Static pressure implied by the manoeuvre minus static pressure of the model. A slope indicates a "
      "wrong or missing term of the model.";
  binned.y = {residual};
  binned.x_choices = {angle};
  binned.autocorrelation_time = 3.0;
  result.pictures.emplace_back(std::move(binned));
}

}  // namespace

std::string_view to_string(AngleReference witness) {
  switch (witness) {
    case AngleReference::laser:
      return "LAMS";
    case AngleReference::height:
      return "GPS height";
    case AngleReference::second_system:
      return "second system";
  }
  return "";
}

bool has(const CheckedFlight& flight, AngleReference witness) {
  switch (witness) {
    case AngleReference::laser:
      return flight.air.laser && has_value(flight.air.laser->static_defect);
    case AngleReference::height:
      return has_value(flight.air.geopotential_height) && has_value(flight.air.temperature) &&
             height_problem(flight.air).empty();
    case AngleReference::second_system:
      return flight.second && has_value(flight.second->pressure);
  }
  return false;
}

std::vector<double> residual_of(const Flown& flown, AngleReference witness) {
  const CheckedFlight& flight = *flown.flight;
  switch (witness) {
    case AngleReference::laser:
      return difference(flown.of(flight.air.laser->static_defect), flown.of(flight.air.static_defect));
    case AngleReference::height:
      return from_height(flown);
    case AngleReference::second_system:
      return difference(flown.of(flight.second->pressure), flown.of(flight.air.pressure));
  }
  return {};
}

Estimated AngleSensitivity::across() const {
  return {ends_of_sine * swing * slope.value, ends_of_sine * swing * slope.error};
}

AngleSensitivity sensitivity_of(const Flown& flown, AngleReference witness, const std::vector<double>& angle,
                                const std::vector<double>& ratio, bool with_square) {
  AngleSensitivity result;
  result.flown = flown;
  const std::vector<double> time = flown.time();
  const std::vector<double> angles = flown.of(angle);
  const std::vector<double> residual = residual_of(flown, witness);
  result.residual = less_mean(residual);
  result.swing = standard_deviation(angles);
  result.bend = result.per_ratio = {nan, nan};
  const auto fit = [&](const std::vector<double>& x, bool squared) {
    std::vector<std::vector<double>> columns{std::vector<double>(x.size(), 1.0), less_mean(time),
                                             less_mean(x)};
    if (squared) {
      std::vector<double> squares = x;
      for (double& value : squares) value *= value;
      columns.push_back(less_mean(squares));
    }
    return least_squares(columns, residual, time, flown.step());
  };
  const LeastSquares against_angle = fit(angles, with_square);
  result.slope = against_angle.coefficients[2];
  result.scatter = against_angle.rms;
  if (with_square) result.bend = against_angle.coefficients[3];
  for (const double each : angles) result.greatest = std::fmax(result.greatest, std::abs(each));
  if (!ratio.empty()) result.per_ratio = fit(flown.of(ratio), false).coefficients[2];
  return result;
}

CheckResult run_angle_check(const CheckedFlights& flights, const AngleCheck& check) {
  const bool has_angle = std::any_of(flights.begin(), flights.end(), [&](const CheckedFlight& flight) {
    return has_value(check.angle_of(flight.air));
  });
  if (!has_angle) return not_run(fmt::format("no flight has the {} ({})", check.angle, check.variables));
  const std::vector<Flown> flown = all_flown(flights, check.regime);
  if (flown.empty()) return not_run(not_flown(flights, check.regime));
  CheckResult result;
  std::vector<AngleSensitivity> manoeuvres;
  bool has_witness = false;
  for (const Flown& each : flown) {
    const std::optional<AngleReference> witness = witness_of(*each.flight, check.witnesses);
    if (!witness) continue;
    has_witness = true;
    AngleSensitivity one = sensitivity_of(each, *witness, check.angle_of(each.flight->air),
                                          check.ratio_of(each.flight->air), check.with_square);
    if (std::isfinite(one.slope.value)) {
      manoeuvres.push_back(std::move(one));
    } else {
      result.notes.push_back(each.location() + ": too few values in this manoeuvre");
    }
  }
  if (!has_witness) {
    const std::string height = height_problem(flown.front().flight->air);
    return not_run(
        fmt::format("a {} was flown, but no reference is available: no laser (lams_airspeed), no second "
                    "static system (--reference static:OTHER.toml) and no GPS height with a temperature{}",
                    info_of(check.regime).name, height.empty() ? "" : " (" + height + ")"));
  }
  if (manoeuvres.empty()) return not_run(result.notes.front().text);
  const Totals totals = totals_of(manoeuvres);
  const AngleReference witness = *witness_of(*manoeuvres.front().flown.flight, check.witnesses);
  std::vector<TestStatistic> numbers{
      judged(totals.across, min_swing_change, "hPa", "change across the swing")};
  result.finding = fmt::format(
      "Over {} {}{} the residual against {} changes by {} of {}, {} from one end of the swing to the other.",
      manoeuvres.size(), info_of(check.regime).name, manoeuvres.size() == 1 ? "" : "s", to_string(witness),
      with_error(totals.slope, "hPa/deg", 3), check.angle, with_error(totals.across, "hPa"));
  if (check.with_square) {
    numbers.push_back(judged(totals.bent, min_swing_change, "hPa", "quadratic part at the end of the swing"));
    result.finding += fmt::format(" With its square the residual changes by {}, {} at the end of the swing.",
                                  with_error(totals.bend, "hPa/deg2", 4), with_error(totals.bent, "hPa"));
  }
  decide(std::move(numbers), result);
  if (witness == AngleReference::second_system && !manoeuvres.front().flown.flight->second_corrected) {
    if (result.verdict == CheckVerdict::inconsistent)
      withhold("the second system is uncorrected, and the slope may be its error", result);
    result.notes.push_back(
        fmt::format("{} is uncorrected, and the slope may be its error; --reference static:OTHER.toml gives "
                    "its correction",
                    manoeuvres.front().flown.flight->second_name));
  }
  result.cannot_see = check.cannot_see;
  result.numbers = {{"manoeuvres", static_cast<double>(manoeuvres.size())},
                    {"slope_hpa_deg", totals.slope.value},
                    {"slope_stderr_hpa_deg", totals.slope.error},
                    {"across_hpa", totals.across.value},
                    {"across_stderr_hpa", totals.across.error}};
  if (const Estimated ratio = all_of(manoeuvres, &AngleSensitivity::per_ratio); std::isfinite(ratio.value)) {
    result.numbers.emplace_back("per_ratio_hpa", ratio.value);
    result.numbers.emplace_back("per_ratio_stderr_hpa", ratio.error);
  }
  if (check.with_square) {
    result.numbers.emplace_back("square_hpa_deg2", totals.bend.value);
    result.numbers.emplace_back("square_stderr_hpa_deg2", totals.bend.error);
    result.numbers.emplace_back("square_at_end_hpa", totals.bent.value);
    result.numbers.emplace_back("square_at_end_stderr_hpa", totals.bent.error);
  }
  result.tables.push_back(table_of(manoeuvres, check));
  add_pictures(flights, manoeuvres, check, result);
  return result;
}

}  // namespace pcor::internal
