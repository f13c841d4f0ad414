#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <pcor/physics/constants.hpp>
#include "checks/leg_pair.hpp"
#include "checks/manoeuvre_segment.hpp"

namespace pcor::internal {
namespace {

/// Smallest relevant error of the airspeed, m/s: the error of the GV in the memo's tests with manoeuvres,
/// about 0.3 hPa.
constexpr double min_airspeed_error = 0.3;

/// Pilots aim at headings opposite within five degrees.
constexpr double aimed_heading = 5.0;  // deg
/// Legs with a larger deviation are not a reverse heading.
constexpr double max_heading = 30.0;  // deg

/// Weight of the assumed change of the wind, in pairs, relative to the observed scatter.
constexpr double pairs_of_assumption = 2.0;

/// With fewer pairs the assumption dominates the error, and a note reports it.
constexpr std::size_t min_for_scatter = 3;

struct Leg {
  ManoeuvreSegment flown;
  LegMean mean{};
};

struct Pair {
  Leg first;
  Leg second;
  LegPair result{};
};

/// Mean direction of angles, deg.
double mean_direction(const std::vector<double>& angles) {
  double east = 0.0;
  double north = 0.0;
  for (const double angle : angles) {
    if (!std::isfinite(angle)) continue;
    east += std::sin(angle * constants::radians_per_degree);
    north += std::cos(angle * constants::radians_per_degree);
  }
  return direction_of(east, north);
}

LegMean mean_of_leg(const ManoeuvreSegment& leg, const std::vector<double>& tail_wind) {
  const FlightAir& air = leg.flight->air;
  const LeastSquares wind = mean_of(leg.of(tail_wind), leg.time(), leg.step());
  LegMean mean;
  mean.tail_wind = wind.coefficients.front();
  mean.scatter = wind.rms;
  mean.heading = mean_direction(leg.of(air.samples->motion.heading));
  const double angle = mean.heading * constants::radians_per_degree;
  mean.cross_speed = leg.mean(air.east_speed) * std::cos(angle) - leg.mean(air.north_speed) * std::sin(angle);
  mean.airspeed = leg.mean(air.airspeed);
  mean.pressure = leg.mean(air.pressure);
  mean.mach = leg.mean(air.mach);
  mean.temperature = leg.mean(air.temperature);
  return mean;
}

/// Pairs of legs; legs without a partner are reported in the notes.
std::vector<std::pair<ManoeuvreSegment, ManoeuvreSegment>> pairs_of(const CheckedFlights& flights,
                                                                    Notes& notes) {
  std::map<std::pair<const CheckedFlight*, int>, std::vector<ManoeuvreSegment>> legs;
  std::vector<std::pair<ManoeuvreSegment, ManoeuvreSegment>> pairs;
  for (ManoeuvreSegment& leg : segments_of_regime(flights, Regime::reverse_heading)) {
    std::vector<ManoeuvreSegment>& group = legs[{leg.flight, leg.interval.pair}];
    group.push_back(std::move(leg));
  }
  for (auto& [key, group] : legs) {
    if (group.size() == 2) {
      pairs.emplace_back(std::move(group[0]), std::move(group[1]));
    } else {
      notes.push_back(
          fmt::format("{}: {} of a pair instead of two; give both the same number with 'pair' in --intervals",
                      group.front().location(),
                      group.size() == 1 ? "a single leg" : std::to_string(group.size()) + " legs"));
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) {
    return std::make_pair(a.first.flight, a.first.interval.begin) <
           std::make_pair(b.first.flight, b.first.interval.begin);
  });
  return pairs;
}

/// Error of the airspeed over all pairs. Its variance combines the assumed change of the wind and the scatter
/// of the pairs, which dominates for many pairs:
///
///     s^2 = (n0 assumed^2 + sum (value - mean)^2)/(n0 + n - 1),  error = s/sqrt(n)
struct Mean {
  Estimate airspeed{};
  double from_assumption = 0.0;  ///< error from the assumed change of the wind alone
  double from_scatter = 0.0;     ///< error from the scatter alone; NaN for fewer than three pairs
};

Mean mean_over(const std::vector<Pair>& pairs) {
  constexpr double between_legs = 0.5 * change_of_wind;
  Mean mean;
  double squares = 0.0;
  std::vector<double> values;
  for (const Pair& pair : pairs) {
    const Estimate& each = pair.result.airspeed_error;
    values.push_back(each.value);
    squares += each.error * each.error + between_legs * between_legs;
  }
  const auto count = static_cast<double>(pairs.size());
  mean.airspeed.value = mean_of(values);
  mean.from_assumption = std::sqrt(squares) / count;
  const double deviation = pairs.size() > 1 ? standard_deviation(values) : 0.0;
  const double scatter = deviation * deviation * count;
  mean.from_scatter = pairs.size() < min_for_scatter ? std::nan("") : deviation / std::sqrt(count - 1.0);
  const double variance =
      (pairs_of_assumption * squares / count + scatter) / (pairs_of_assumption + count - 1.0);
  mean.airspeed.error = std::sqrt(variance / count);
  return mean;
}

ReportTable table_of_legs(const std::vector<Leg>& legs) {
  ReportTable table{"Legs of reverse headings",
                    "Tail wind: ground speed along the heading minus true airspeed, with its scatter.",
                    {"leg", "heading, deg", "track, deg", "airspeed, m/s", "tail wind, m/s"}};
  for (const auto& [flown, mean] : legs) {
    const FlightAir& air = flown.flight->air;
    const double track = direction_of(flown.mean(air.east_speed), flown.mean(air.north_speed));
    table.rows.push_back({flown.location(), fmt::format("{:.1f}", mean.heading), fmt::format("{:.1f}", track),
                          fmt::format("{:.1f}", mean.airspeed),
                          fmt::format("{:+.2f} +- {:.2f}", mean.tail_wind.value, mean.scatter)});
  }
  return table;
}

ReportTable table_of_pairs(const std::vector<Pair>& pairs) {
  ReportTable table{
      "Reverse headings",
      "Without errors the sum of the tail winds of both legs is zero. After subtraction of the part due to "
      "headings that are not opposite, the sum is minus twice the error of the airspeed; delta-p and "
      "temperature are the errors that alone would cause it. Errors of the pairs exclude changes of the wind "
      "between the legs.",
      {"first leg", "sum, m/s", "due to headings", "airspeed, m/s", "delta-p, hPa", "temperature, K"}};
  for (const Pair& pair : pairs) {
    const LegPair& result = pair.result;
    table.rows.push_back({pair.first.flown.location(), format_number(result.sum, ""),
                          fmt::format("{:+.2f}", result.heading_share),
                          format_number(result.airspeed_error, ""), format_number(result.pressure_error, ""),
                          format_number(result.temperature_error, "", 1)});
  }
  return table;
}

Pair evaluated(ManoeuvreSegment first, ManoeuvreSegment second, const std::vector<double>& tail_wind) {
  Pair pair{{std::move(first)}, {std::move(second)}};
  for (Leg* const leg : {&pair.first, &pair.second}) leg->mean = mean_of_leg(leg->flown, tail_wind);
  pair.result = pair_of(pair.first.mean, pair.second.mean);
  return pair;
}

/// Pairs evaluated with the airspeed of the laser.
std::vector<Pair> with_laser(const std::vector<Pair>& pairs) {
  std::vector<Pair> result;
  for (const Pair& pair : pairs) {
    const FlightAir& air = pair.first.flown.flight->air;
    if (!air.laser) continue;
    std::vector<double> wind = air.tail_wind;
    for (std::size_t i = 0; i < wind.size(); ++i) wind[i] += air.airspeed[i] - air.laser->airspeed[i];
    Pair by_laser = evaluated(pair.first.flown, pair.second.flown, wind);
    if (std::isfinite(by_laser.result.airspeed_error.value)) result.push_back(std::move(by_laser));
  }
  return result;
}

}  // namespace

CheckResult check_reverse_heading(const CheckedFlights& flights) {
  if (const std::string missing = missing_for_tail_wind(flights); !missing.empty())
    return not_run("no flight " + missing);
  CheckResult result;
  std::vector<Pair> pairs;
  for (auto& [first, second] : pairs_of(flights, result.notes)) {
    const FlightAir& air = first.flight->air;
    Pair pair = evaluated(std::move(first), std::move(second), air.tail_wind);
    const std::string location = pair.first.flown.location();
    const double off = std::abs(pair.result.heading_error);
    if (!std::isfinite(pair.result.airspeed_error.value)) {
      result.notes.push_back(location + ": the tail wind has too few values on a leg of this pair");
    } else if (off > max_heading) {
      result.notes.push_back(
          fmt::format("{}: headings differ from opposite by {:.0f} deg; not used as a reverse-heading pair",
                      location, off));
    } else {
      if (off > aimed_heading)
        result.notes.push_back(
            fmt::format("{}: headings differ from opposite by {:.1f} deg; the wind component of {:+.2f} m/s "
                        "was subtracted, with an error due to the sideslip",
                        location, off, pair.result.heading_share));
      pairs.push_back(std::move(pair));
    }
  }
  if (pairs.empty()) return regime_not_found(flights, Regime::reverse_heading, result.notes);
  const Mean mean = mean_over(pairs);
  const Estimate& error = mean.airspeed;
  const auto as_other = [&](double LegPair::*factor) {
    return mean_of(each_of(pairs, [=](const Pair& pair) { return pair.result.*factor; })) * error;
  };
  const Estimate hpa = as_other(&LegPair::pressure_per_airspeed);
  const Estimate kelvin = as_other(&LegPair::temperature_per_airspeed);
  set_verdict({test_statistic(error, min_airspeed_error, "m/s", "airspeed")}, result);
  result.finding = fmt::format(
      "Over {} pair{} the tail winds of both legs add up to {} instead of zero: the true airspeed is too {} "
      "by {:.2f} +- {:.2f} m/s, as if delta-p were off by {} or the temperature by {}.",
      pairs.size(), pairs.size() == 1 ? "" : "s",
      format_number({-2.0 * error.value, 2.0 * error.error}, "m/s"), error.value < 0.0 ? "low" : "high",
      std::abs(error.value), error.error, format_number(hpa, "hPa"), format_number(kelvin, "K", 1));
  result.limitations =
      "The check cannot separate errors of pressure, temperature and laser: it depends on the airspeed only. "
      "If pressures were corrected sample by sample with LAMS, or the model was fitted to LAMS, the airspeed "
      "is the LAMS airspeed for any temperature, and the check tests LAMS alone. An error of the airspeed "
      "that has opposite signs on the two legs cancels.";
  result.numbers = {{"pairs", static_cast<double>(pairs.size())}};
  add_number("sum", "_m_s", {-2.0 * error.value, 2.0 * error.error}, result);
  result.numbers.emplace_back("sum_stderr_assumed_m_s", 2.0 * mean.from_assumption);
  result.numbers.emplace_back("sum_stderr_scatter_m_s", 2.0 * mean.from_scatter);
  add_number("airspeed_error", "_m_s", error, result);
  add_number("delta_p_error", "_hpa", hpa, result);
  add_number("temperature_error", "_k", kelvin, result);
  if (const std::vector<Pair> lasers = with_laser(pairs); !lasers.empty()) {
    const Estimate laser = mean_over(lasers).airspeed;
    add_number("laser_airspeed_error", "_m_s", laser, result);
    result.notes.push_back(
        "Error of the airspeed from the laser, equivalent to a correction of each sample with LAMS: " +
        format_number(laser, "m/s"));
  }
  if (pairs.size() < min_for_scatter)
    result.notes.push_back(
        fmt::format("With fewer than {} pairs the error depends on an assumed change of the wind of {} m/s "
                    "between the legs; about 18 pairs reach +-0.2 m/s in the sum",
                    min_for_scatter, change_of_wind));
  std::vector<Leg> legs;
  for (const Pair& pair : pairs) {
    legs.insert(legs.end(), {pair.first, pair.second});
    const Estimate& of_pair = pair.result.airspeed_error;
    result.bars.push_back(
        {pair.first.flown.label(), of_pair.value, std::hypot(of_pair.error, 0.5 * change_of_wind)});
  }
  result.tables = {table_of_pairs(pairs), table_of_legs(legs)};
  result.columns = {column_in(flights, "reverse-heading tail wind", "tail wind", "m/s", legs,
                              [](const Leg& leg) { return leg.flown.of(leg.flown.flight->air.tail_wind); })};
  return result;
}

}  // namespace pcor::internal
