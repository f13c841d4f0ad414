#include "diagnose/manoeuvres/flown.hpp"

#include <algorithm>
#include <cmath>

#include <pcor/physics/air_data.hpp>
#include <pcor/physics/humidity.hpp>
#include <pcor/physics/moist_air.hpp>
#include <pcor/physics/recovery_factor.hpp>
#include <pcor/physics/standard_atmosphere.hpp>
#include "diagnose/manoeuvres/statistics.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal::manoeuvres {
namespace {

const std::vector<double> nothing;

const std::vector<double>& series_of(const FlightSamples& flight, Quantity quantity) {
  for (const ModelSamples* samples : {&flight.model, &flight.reference}) {
    if (const std::vector<double>* column = samples->find(quantity)) return *column;
  }
  return nothing;
}

/// The load factor of every sample: from the accelerometer, whose median is that of level flight, else from
/// vertical speed and roll.
std::vector<double> load_of(const FlightSamples& flight) {
  std::vector<double> load(flight.time.size(), 1.0);
  const std::vector<double>& recorded = series_of(flight, Quantity::normal_acceleration);
  if (!recorded.empty()) {
    const double level = median(recorded);
    for (std::size_t i = 0; i < load.size(); ++i)
      load[i] += (recorded[i] - level) / constants::standard_gravity;
    return load;
  }
  const std::vector<double>& climb = flight.motion.vertical_speed;
  const std::vector<double>& roll = flight.motion.roll;
  if (!climb.empty()) {
    load.front() = load.back() = nan;
    for (std::size_t i = 1; i + 1 < load.size(); ++i) {
      const double across = flight.time[i + 1] - flight.time[i - 1];
      load[i] = across <= 2.5 * flight.step
                    ? 1.0 + (climb[i + 1] - climb[i - 1]) / (across * constants::standard_gravity)
                    : nan;
    }
  }
  if (!roll.empty()) {
    for (std::size_t i = 0; i < load.size(); ++i)
      load[i] /= std::cos(constants::radians_per_degree * roll[i]);
  }
  return load;
}

double humidity_at(double vapor, double dew_point, double frost_point, double pressure) {
  if (std::isnan(vapor)) vapor = vapor_pressure_from_dew_point(dew_point, pressure);
  if (std::isnan(vapor)) vapor = vapor_pressure_from_frost_point(frost_point, pressure);
  const double humidity = vapor / pressure;
  return humidity >= 0.0 && humidity < 0.1 ? humidity : nan;
}

}  // namespace

double Flown::value_at(const std::vector<double>& series, std::size_t sample) {
  return sample < series.size() && std::isfinite(series[sample]) ? series[sample] : nan;
}

Flown::Flown(const Flights& flights, Flaps which) {
  for (const auto& flight : flights) add(*flight, which);
}

void Flown::add(const FlightSamples& flight, Flaps which) {
  constexpr double least_airspeed = 60.0;  // m/s
  constexpr double most_flaps = 5.0;       // percent
  constexpr double flaps_out = 20.0;       // percent
  const std::vector<double>& recorded_flaps =
      flight.flaps.empty() ? series_of(flight, Quantity::flaps) : flight.flaps;
  const auto ground = static_cast<std::size_t>(Regime::ground);
  const auto take_off = static_cast<std::size_t>(Regime::take_off);
  const std::vector<RegimeSet> regimes = regimes_of_samples(flight.time, flight.intervals);
  const std::vector<double> loads = load_of(flight);
  const auto recorded = [&flight](Quantity quantity, std::size_t i) {
    return value_at(series_of(flight, quantity), i);
  };
  for (std::size_t i = 0; i < flight.time.size(); ++i) {
    const double p = recorded(Quantity::static_pressure, i);
    const double q = recorded(Quantity::dynamic_pressure, i);
    if (!(p > 0.0) || !(q > 0.0) || regimes[i][ground] || regimes[i][take_off]) continue;
    const bool out_by_lift = !flight.flaps_by_lift.empty() && flight.flaps_by_lift[i];
    const double if_not_recorded = out_by_lift ? nan : 0.0;  // out, but nobody knows by how much
    const double out = recorded_flaps.empty() ? if_not_recorded : value_at(recorded_flaps, i);
    if (!(which == Flaps::in ? out <= most_flaps : out >= flaps_out)) continue;
    const double moisture =
        humidity_at(recorded(Quantity::vapor_pressure, i), recorded(Quantity::dew_point, i),
                    recorded(Quantity::frost_point, i), p);
    const MoistAir<double> air = moist_air(std::isnan(moisture) ? 0.0 : moisture);
    const double m = mach_number(p, q, air);
    double t = recorded(Quantity::ambient_temperature, i);
    if (std::isnan(t)) t = ambient_temperature(recorded(Quantity::recovery_temperature, i), m, 1.0, air);
    if (std::isnan(t)) t = standard_temperature(pressure_altitude(p));
    const double v = true_airspeed(m, t, air);
    if (!(v >= least_airspeed)) continue;
    places_.push_back({&flight, i});
    pressure.push_back(p);
    dynamic.push_back(q);
    temperature.push_back(t);
    humidity.push_back(moisture);
    mach.push_back(m);
    airspeed.push_back(v);
    load.push_back(loads[i]);
    flaps.push_back(out);
  }
}

std::vector<double> Flown::column(Quantity quantity, ModelSamples FlightSamples::*samples) const {
  return gathered([&](const FlightSamples& flight) -> const std::vector<double>& {
    const std::vector<double>* found = (flight.*samples).find(quantity);
    return found == nullptr ? nothing : *found;
  });
}

std::vector<double> Flown::column(Quantity quantity) const {
  return gathered(
      [&](const FlightSamples& flight) -> const std::vector<double>& { return series_of(flight, quantity); });
}

}  // namespace pcor::internal::manoeuvres
