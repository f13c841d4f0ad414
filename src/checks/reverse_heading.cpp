#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <pcor/base/utc.hpp>
#include <pcor/physics/constants.hpp>
#include "checks/flown.hpp"
#include "checks/leg_pair.hpp"

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

struct Pair {
  Flown first;
  Flown second;
  LegMean means[2];
  LegPair result;
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
  const double direction = std::atan2(east, north) / constants::radians_per_degree;
  return direction < 0.0 ? direction + 360.0 : direction;
}

/// Mean direction of the ground velocity, deg.
double track_of(const Flown& leg) {
  const FlightAir& air = leg.flight->air;
  const double direction =
      std::atan2(leg.mean(air.east_speed), leg.mean(air.north_speed)) / constants::radians_per_degree;
  return direction < 0.0 ? direction + 360.0 : direction;
}

LegMean mean_of_leg(const Flown& leg, const std::vector<double>& tail_wind) {
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
std::vector<std::pair<Flown, Flown>> pairs_of(const CheckedFlights& flights, Notes& notes) {
  std::map<std::pair<const CheckedFlight*, int>, std::vector<Flown>> legs;
  std::vector<std::pair<Flown, Flown>> pairs;
  for (Flown& leg : all_flown(flights, Regime::reverse_heading)) {
    std::vector<Flown>& group = legs[{leg.flight, leg.interval.pair}];
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
  Estimated airspeed{};
  double from_assumption = 0.0;  ///< error from the assumed change of the wind alone
  double from_scatter = 0.0;     ///< error from the scatter alone; NaN for fewer than three pairs
};

Mean mean_over(const std::vector<Pair>& pairs) {
  constexpr double between_legs = 0.5 * change_of_wind;
  Mean mean;
  double squares = 0.0;
  std::vector<double> values;
  for (const Pair& pair : pairs) {
    const Estimated& each = pair.result.airspeed_error;
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

ReportTable table_of_legs(const std::vector<Pair>& pairs) {
  ReportTable table;
  table.title = "Legs of reverse headings";
  table.caption = "Tail wind: ground speed along the heading minus true airspeed, with its scatter.";
  table.headers = {"leg", "heading, deg", "track, deg", "airspeed, m/s", "tail wind, m/s"};
  const auto add = [&](const Flown& flown, const LegMean& mean) {
    table.rows.push_back({flown.location(), fmt::format("{:.1f}", mean.heading),
                          fmt::format("{:.1f}", track_of(flown)), fmt::format("{:.1f}", mean.airspeed),
                          fmt::format("{:+.2f} +- {:.2f}", mean.tail_wind.value, mean.scatter)});
  };
  for (const Pair& pair : pairs) {
    add(pair.first, pair.means[0]);
    add(pair.second, pair.means[1]);
  }
  return table;
}

ReportTable table_of_pairs(const std::vector<Pair>& pairs) {
  ReportTable table;
  table.title = "Reverse headings";
  table.caption =
      "Without errors the sum of the tail winds of both legs is zero. After subtraction of the part due to "
      "headings that are not opposite, the sum is minus twice the error of the airspeed; delta-p and "
      "temperature are the errors that alone would cause it. Errors of the pairs exclude changes of the wind "
      "between the legs.";
  table.headers = {"first leg",     "sum, m/s",     "due to headings",
                   "airspeed, m/s", "delta-p, hPa", "temperature, K"};
  for (const Pair& pair : pairs) {
    const LegPair& result = pair.result;
    table.rows.push_back({pair.first.location(), with_error(result.sum, ""),
                          fmt::format("{:+.2f}", result.heading_share), with_error(result.airspeed_error, ""),
                          with_error(result.pressure_error, ""),
                          with_error(result.temperature_error, "", 1)});
  }
  return table;
}

/// Legs evaluated with the airspeed of the laser.
std::vector<Pair> with_laser(std::vector<Pair> pairs) {
  std::vector<Pair> result;
  for (Pair& pair : pairs) {
    const FlightAir& air = pair.first.flight->air;
    if (!air.laser) continue;
    std::vector<double> wind = air.tail_wind;
    for (std::size_t i = 0; i < wind.size(); ++i) wind[i] += air.airspeed[i] - air.laser->airspeed[i];
    pair.means[0] = mean_of_leg(pair.first, wind);
    pair.means[1] = mean_of_leg(pair.second, wind);
    pair.result = pair_of(pair.means[0], pair.means[1]);
    if (std::isfinite(pair.result.airspeed_error.value)) result.push_back(std::move(pair));
  }
  return result;
}

void add_pictures(const CheckedFlights& flights, const std::vector<Pair>& pairs, CheckResult& result) {
  std::vector<Flown> legs;
  BarPanel bars;
  bars.title = "Error of the airspeed from each reverse heading";
  bars.caption = "Error bars include the typical change of the wind between two legs.";
  bars.axis = "airspeed minus airspeed of the headings";
  bars.unit = "m/s";
  for (const Pair& pair : pairs) {
    legs.push_back(pair.first);
    legs.push_back(pair.second);
    bars.bars.push_back({fmt::format("{} {}", pair.first.flight->air.samples->name,
                                     utc_text(pair.first.interval.begin, "%H:%M")),
                         pair.result.airspeed_error.value,
                         std::hypot(pair.result.airspeed_error.error, 0.5 * change_of_wind)});
  }
  result.pictures.emplace_back(std::move(bars));
  result.columns.push_back(
      column_of(flights, "reverse-heading tail wind", "tail wind", "m/s",
                [&](const CheckedFlight& flight) { return only_in(flight, legs, flight.air.tail_wind); }));
  TimePanel time;
  time.title = "Tail wind on the legs";
  time.caption =
      "Wind along the aircraft's axis. It has opposite signs on the two legs of a pair; an error of the "
      "airspeed has the same sign.";
  time.columns = {"reverse-heading tail wind"};
  result.pictures.emplace_back(std::move(time));
}

}  // namespace

CheckResult check_reverse_heading(const CheckedFlights& flights) {
  if (const std::string missing = missing_for_tail_wind(flights); !missing.empty())
    return not_run("no flight " + missing);
  CheckResult result;
  std::vector<Pair> pairs;
  for (auto& [first, second] : pairs_of(flights, result.notes)) {
    Pair pair{std::move(first), std::move(second), {}, {}};
    pair.means[0] = mean_of_leg(pair.first, pair.first.flight->air.tail_wind);
    pair.means[1] = mean_of_leg(pair.second, pair.second.flight->air.tail_wind);
    pair.result = pair_of(pair.means[0], pair.means[1]);
    const double off = std::abs(pair.result.heading_error);
    if (!std::isfinite(pair.result.airspeed_error.value)) {
      result.notes.push_back(pair.first.location() +
                             ": the tail wind has too few values on a leg of this pair");
    } else if (off > max_heading) {
      result.notes.push_back(
          fmt::format("{}: headings differ from opposite by {:.0f} deg; not used as a reverse-heading pair",
                      pair.first.location(), off));
    } else {
      if (off > aimed_heading)
        result.notes.push_back(
            fmt::format("{}: headings differ from opposite by {:.1f} deg; the wind component of {:+.2f} m/s "
                        "was subtracted, with an error due to the sideslip",
                        pair.first.location(), off, pair.result.heading_share));
      pairs.push_back(std::move(pair));
    }
  }
  if (pairs.empty()) {
    return not_run(result.notes.empty() ? not_flown(flights, Regime::reverse_heading)
                                        : "no pair of legs can be used: " + result.notes.front().text);
  }
  const Mean mean = mean_over(pairs);
  const Estimated& error = mean.airspeed;
  const auto as_other = [&](double LegPair::*factor) {
    std::vector<double> factors;
    for (const Pair& pair : pairs) factors.push_back(pair.result.*factor);
    const double usual = mean_of(factors);
    return Estimated{usual * error.value, std::abs(usual) * error.error};
  };
  const Estimated hpa = as_other(&LegPair::pressure_per_airspeed);
  const Estimated kelvin = as_other(&LegPair::temperature_per_airspeed);
  decide({judged(error, min_airspeed_error, "m/s", "airspeed")}, result);
  result.finding = fmt::format(
      "Over {} pair{} the tail winds of both legs add up to {} instead of zero: the true airspeed is too {} "
      "by {:.2f} +- {:.2f} m/s, as if delta-p were off by {} or the temperature by {}.",
      pairs.size(), pairs.size() == 1 ? "" : "s", with_error({-2.0 * error.value, 2.0 * error.error}, "m/s"),
      error.value < 0.0 ? "low" : "high", std::abs(error.value), error.error, with_error(hpa, "hPa"),
      with_error(kelvin, "K", 1));
  result.cannot_see =
      "The check cannot separate errors of pressure, temperature and laser: it depends on the airspeed only. "
      "If pressures were corrected sample by sample with LAMS, or the model was fitted to LAMS, the airspeed "
      "is the LAMS airspeed for any temperature, and the check tests LAMS alone. An error of the airspeed "
      "that has opposite signs on the two legs cancels.";
  result.numbers = {{"pairs", static_cast<double>(pairs.size())},
                    {"sum_m_s", -2.0 * error.value},
                    {"sum_stderr_m_s", 2.0 * error.error},
                    {"sum_stderr_assumed_m_s", 2.0 * mean.from_assumption},
                    {"sum_stderr_scatter_m_s", 2.0 * mean.from_scatter},
                    {"airspeed_error_m_s", error.value},
                    {"airspeed_error_stderr_m_s", error.error},
                    {"delta_p_error_hpa", hpa.value},
                    {"delta_p_error_stderr_hpa", hpa.error},
                    {"temperature_error_k", kelvin.value},
                    {"temperature_error_stderr_k", kelvin.error}};
  if (const std::vector<Pair> lasers = with_laser(pairs); !lasers.empty()) {
    const Estimated laser = mean_over(lasers).airspeed;
    result.numbers.emplace_back("laser_airspeed_error_m_s", laser.value);
    result.numbers.emplace_back("laser_airspeed_error_stderr_m_s", laser.error);
    result.notes.push_back(
        "With the airspeed of the laser, equivalent to a correction sample by sample with LAMS, the airspeed "
        "is off by " +
        with_error(laser, "m/s"));
  }
  if (pairs.size() < min_for_scatter)
    result.notes.push_back(
        fmt::format("With fewer than {} pairs the error depends on an assumed change of the wind of {} m/s "
                    "between the legs; about 18 pairs reach +-0.2 m/s in the sum",
                    min_for_scatter, change_of_wind));
  result.tables = {table_of_pairs(pairs), table_of_legs(pairs)};
  add_pictures(flights, pairs, result);
  return result;
}

}  // namespace pcor::internal
