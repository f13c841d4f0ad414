#include "checks/manoeuvre_segment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <pcor/base/utc.hpp>
#include <pcor/physics/constants.hpp>
#include "numerics/missing.hpp"

namespace pcor::internal {

std::vector<double> ManoeuvreSegment::of(const std::vector<double>& series) const {
  std::vector<double> values(records.size(), nan);
  if (series.empty()) return values;
  for (std::size_t i = 0; i < records.size(); ++i) values[i] = series[records[i]];
  return values;
}

double ManoeuvreSegment::mean(const std::vector<double>& series) const { return mean_of(of(series)); }

LeastSquares ManoeuvreSegment::regression(const std::vector<double>& y,
                                          const std::vector<std::vector<double>>& x) const {
  std::vector<std::vector<double>> columns{std::vector<double>(y.size(), 1.0), subtract_mean(time())};
  for (const std::vector<double>& series : x) columns.push_back(subtract_mean(series));
  return least_squares(columns, y, time(), step());
}

std::string ManoeuvreSegment::location() const {
  return fmt::format("{}, {} to {}", flight->air.samples->name, utc_text(interval.begin),
                     utc_text(interval.end, "%H:%M:%S"));
}

std::string ManoeuvreSegment::label() const {
  return flight->air.samples->name + utc_text(interval.begin, " %H:%M");
}

std::vector<ManoeuvreSegment> segments_of_regime(const CheckedFlights& flights, Regime regime) {
  std::vector<ManoeuvreSegment> all;
  for (const CheckedFlight& flight : flights) {
    const std::vector<double>& time = flight.air.time();
    for (const Interval& interval : flight.air.samples->intervals) {
      if (interval.regime != regime) continue;
      ManoeuvreSegment flown{&flight, interval, {}};
      const auto first = std::lower_bound(time.begin(), time.end(), interval.begin);
      for (auto at = first; at != time.end() && *at < interval.end; ++at) {
        const auto record = static_cast<std::size_t>(at - time.begin());
        if (flight.air.flying[record]) flown.records.push_back(record);
      }
      if (!flown.records.empty()) all.push_back(std::move(flown));
    }
  }
  return all;
}

std::pair<double, double> range_of(const std::vector<double>& values) {
  std::pair<double, double> range{nan, nan};
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    if (!(value >= range.first)) range.first = value;
    if (!(value <= range.second)) range.second = value;
  }
  return range;
}

std::vector<double> squares_of(std::vector<double> values) {
  for (double& value : values) value *= value;
  return values;
}

double standard_deviation(const std::vector<double>& values) {
  return std::sqrt(mean_of(squares_of(subtract_mean(values))));
}

std::vector<double> difference(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

double direction_of(double east, double north) {
  const double direction = std::atan2(east, north) / constants::radians_per_degree;
  return direction < 0.0 ? direction + 360.0 : direction;
}

std::vector<double> subtract_mean(std::vector<double> values) {
  const double mean = mean_of(values);
  for (double& value : values) value -= mean;
  return values;
}

std::string missing_for_tail_wind(const CheckedFlights& flights) {
  const auto lacking = [&](const auto& series) {
    return std::none_of(flights.begin(), flights.end(),
                        [&](const CheckedFlight& flight) { return has_value(series(flight.air)); });
  };
  if (!lacking([](const FlightAir& air) { return air.tail_wind; })) return "";
  if (lacking([](const FlightAir& air) { return air.samples->motion.heading; }))
    return "has a heading (THDG; [variables] heading names another)";
  if (lacking([](const FlightAir& air) { return air.east_speed; }))
    return "has a ground speed and track (GGSPD and GGTRK, or GGVEW and GGVNS; [variables] ground_speed and "
           "ground_track name others)";
  if (lacking([](const FlightAir& air) { return air.airspeed; }))
    return "has a true airspeed: it needs a thermometer (ATX; [variables] recovery_temperature or "
           "ambient_temperature name one)";
  return "has heading, ground velocity and true airspeed together";
}

CheckResult regime_not_found(const CheckedFlights& flights, Regime regime, const Notes& notes) {
  if (!notes.empty())
    return not_run(fmt::format("no {} can be used: {}", info_of(regime).name, notes.front().text));
  const std::string& aircraft = flights.front().air.samples->aircraft;
  const RegimeCriteria criteria = RegimeCriteria::of(aircraft).value_or(RegimeCriteria::c130());
  return not_run(fmt::format("no {} was found in the flights ({}); --intervals adds one",
                             info_of(regime).name, criterion_of(regime, criteria)));
}

ReportColumn column_of(const CheckedFlights& flights, std::string name, std::string title, std::string unit,
                       const std::function<std::vector<double>(const CheckedFlight&)>& series) {
  ReportColumn column{std::move(name), std::move(title), std::move(unit), {}};
  for (const CheckedFlight& flight : flights) {
    std::vector<double> values = series(flight);
    values.resize(flight.air.size(), nan);
    column.values.insert(column.values.end(), values.begin(), values.end());
  }
  return column;
}

std::vector<double> masked(std::vector<double> series, const std::vector<bool>& used) {
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (!used[i]) series[i] = nan;
  }
  return series;
}

double usual_step(const CheckedFlights& flights,
                  const std::function<std::vector<double>(const CheckedFlight&)>& series) {
  std::map<double, std::ptrdiff_t> values;  // number by interval
  for (const CheckedFlight& flight : flights) {
    const std::vector<double> here = series(flight);
    const auto known = std::count_if(here.begin(), here.end(), [](double x) { return std::isfinite(x); });
    if (known == 0) continue;
    const auto same_step = std::find_if(values.begin(), values.end(),
                                        [&](const auto& each) { return has_step(flight, each.first); });
    (same_step == values.end() ? values[flight.air.step()] : same_step->second) += known;
  }
  const auto most = std::max_element(values.begin(), values.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == values.end() ? nan : most->first;
}

void note_other_steps(const CheckedFlights& flights, double step,
                      const std::function<bool(const CheckedFlight&)>& has_values, Notes& notes) {
  const auto others = std::count_if(flights.begin(), flights.end(), [&](const CheckedFlight& flight) {
    return !has_step(flight, step) && has_values(flight);
  });
  if (others == 0) return;
  notes.push_back(fmt::format("{} of {} flights are not used: record interval differs from {:g} s", others,
                              flights.size(), step));
}

CheckResult not_run(std::string reason) {
  CheckResult result;
  result.reason = std::move(reason);
  return result;
}

}  // namespace pcor::internal
