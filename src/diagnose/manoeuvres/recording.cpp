#include "diagnose/manoeuvres/recording.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include <pcor/physics/air_data.hpp>
#include <pcor/physics/geodesy.hpp>
#include <pcor/physics/lams.hpp>
#include <pcor/physics/lift.hpp>
#include <pcor/physics/moist_air.hpp>
#include <pcor/physics/recovery_factor.hpp>

namespace pcor::internal::manoeuvres {

/// All that is known of one sample.
struct Instant {
  double time;  // s since the first record
  double pressure;
  double dynamic;
  double temperature;
  double recovery_temperature;
  double vapor_pressure;
  double mach;
  double airspeed;
  double lams_airspeed;
  double height;
  double vertical_speed;
  double normal_acceleration;
  double longitudinal_acceleration;
  double roll;
  double pitch;
  double heading;
  double attack;
  double sideslip;
  double radome_dynamic;
  double attack_differential;
  double sideslip_differential;
  double flaps;
  double liquid_water;
  double cabin_pressure;
};

namespace {

constexpr double radians = constants::radians_per_degree;
using constants::standard_gravity;
using Series = std::vector<double>;

double rate_of(const Course& course, double t) {
  constexpr double step = 0.05;  // s
  return (course(t + step) - course(t - step)) / (2.0 * step);
}

double second_rate_of(const Course& course, double t) {
  constexpr double step = 0.05;  // s
  return (course(t + step) - 2.0 * course(t) + course(t - step)) / (step * step);
}

/// Centred differences, one-sided at the ends and beside gaps.
Series rates_of(const Series& values, const Series& time, double step) {
  const auto adjoin = [&](std::size_t i) { return time[i + 1] - time[i] < 1.5 * step; };
  Series rate(values.size(), 0.0);
  for (std::size_t i = 0; i < rate.size(); ++i) {
    const std::size_t before = i > 0 && adjoin(i - 1) ? i - 1 : i;
    const std::size_t after = i + 1 < rate.size() && adjoin(i) ? i + 1 : i;
    if (after > before) rate[i] = (values[after] - values[before]) / (time[after] - time[before]);
  }
  return rate;
}

/// A name without "_rate" at its end; empty where it has no such end.
std::string_view before_rate(std::string_view name) {
  constexpr std::string_view end = "_rate";
  if (name.size() <= end.size() || name.substr(name.size() - end.size()) != end) return {};
  return name.substr(0, name.size() - end.size());
}

bool has_column(const FlightSamples& flight, ModelSamples FlightSamples::*samples, Quantity quantity) {
  return (flight.*samples).find(quantity) != nullptr;
}

bool all_have(const Flights& flights, ModelSamples FlightSamples::*samples, Quantity quantity) {
  return std::all_of(flights.begin(), flights.end(),
                     [&](const auto& flight) { return has_column(*flight, samples, quantity); });
}

/// The member that holds what has a name.
using Law = std::pair<std::string_view, double Instant::*>;
constexpr std::array<Law, 28> laws{{
    {"static_pressure", &Instant::pressure},
    {"corrected_static_pressure", &Instant::pressure},
    {"dynamic_pressure", &Instant::dynamic},
    {"ambient_temperature", &Instant::temperature},
    {"recovery_temperature", &Instant::recovery_temperature},
    {"vapor_pressure", &Instant::vapor_pressure},
    {"mach", &Instant::mach},
    {"true_airspeed", &Instant::airspeed},
    {"airspeed", &Instant::airspeed},
    {"ground_speed", &Instant::airspeed},
    {"lams_airspeed", &Instant::lams_airspeed},
    {"altitude", &Instant::height},
    {"vertical_speed", &Instant::vertical_speed},
    {"normal_acceleration", &Instant::normal_acceleration},
    {"longitudinal_acceleration", &Instant::longitudinal_acceleration},
    {"roll", &Instant::roll},
    {"pitch", &Instant::pitch},
    {"heading", &Instant::heading},
    {"ground_track", &Instant::heading},
    {"attack", &Instant::attack},
    {"sideslip", &Instant::sideslip},
    {"radome_dynamic_pressure", &Instant::radome_dynamic},
    {"attack_differential_pressure", &Instant::attack_differential},
    {"sideslip_differential_pressure", &Instant::sideslip_differential},
    {"flaps", &Instant::flaps},
    {"liquid_water", &Instant::liquid_water},
    {"cabin_pressure", &Instant::cabin_pressure},
    {"time", &Instant::time},
}};

/// The values of what has that name; none where no law says what they are.
std::optional<Series> values_of(std::string_view name, const std::vector<Instant>& instants) {
  const auto law =
      std::find_if(laws.begin(), laws.end(), [name](const Law& each) { return each.first == name; });
  if (law == laws.end()) return std::nullopt;
  Series values;
  for (const Instant& now : instants) values.push_back(now.*law->second);
  return values;
}

/// The values of a quantity by the laws; none where it has none.
std::optional<Series> values_of(Quantity quantity, const std::vector<Instant>& instants, double step) {
  if (index(quantity) >= quantity_count) return std::nullopt;
  const std::string_view name = facts_of(quantity).name;
  const std::optional<Series> changing = values_of(before_rate(name), instants);
  return changing ? rates_of(*changing, *values_of("time", instants), step) : values_of(name, instants);
}

}  // namespace

Recorder::Recorder(const Flights& flights, const Flown& flown, const Aircraft& aircraft,
                   const Atmosphere& atmosphere)
    : aircraft_(aircraft),
      atmosphere_(atmosphere),
      registration_(flights.front()->aircraft),
      first_time_(flights.front()->time.front()),
      step_(flights.front()->step),
      has_flaps_(std::all_of(flights.begin(), flights.end(),
                             [](const auto& flight) { return !flight->flaps.empty(); })),
      model_(columns_of(flights, flown, &FlightSamples::model)),
      reference_(columns_of(flights, flown, &FlightSamples::reference)) {}

bool Recorder::has(Quantity quantity) const { return find(quantity) != nullptr; }

double Recorder::usual(Quantity quantity, double pressure) const {
  const Column* column = find(quantity);
  return column == nullptr ? std::numeric_limits<double>::quiet_NaN() : column->usual.at(pressure);
}

const Recorder::Column* Recorder::find(Quantity quantity) const {
  const auto found = std::find_if(model_.columns.begin(), model_.columns.end(),
                                  [quantity](const Column& column) { return column.quantity == quantity; });
  return found == model_.columns.end() ? nullptr : &*found;
}

Recorder::Columns Recorder::columns_of(const Flights& flights, const Flown& flown,
                                       ModelSamples FlightSamples::*samples) {
  Columns result;
  for (const auto& [quantity, values] : (flights.front().get()->*samples).columns) {
    if (!all_have(flights, samples, quantity)) continue;
    result.columns.push_back({quantity, Profile(flown.pressure, flown.column(quantity, samples), 0.0)});
  }
  for (const Quantity role : (flights.front().get()->*samples).roles) {
    if (all_have(flights, samples, role)) result.roles.push_back(role);
  }
  return result;
}

std::vector<Instant> Recorder::fly(const Path& path) const {
  std::vector<Instant> instants;
  double heading = 0.0;
  const auto count = static_cast<std::size_t>(path.duration / step_ + 1e-6) + 1;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = step_ * static_cast<double>(i);
    if (t > path.not_recorded.first && t < path.not_recorded.second) continue;
    Instant now{};
    now.time = t;
    now.height = path.height(t);
    now.airspeed = path.airspeed(t);
    now.roll = path.roll(t);
    now.sideslip = path.sideslip(t);
    now.flaps = path.flaps(t);
    now.liquid_water = path.liquid_water(t);
    now.vertical_speed = rate_of(path.height, t);

    const AirAt here = atmosphere_.at(now.height);
    const MoistAir<double> air = moist_air(here.humidity);
    now.pressure = here.pressure;
    now.temperature = here.temperature;
    now.vapor_pressure = here.humidity * here.pressure;
    now.cabin_pressure =
        path.cabin_pressure ? path.cabin_pressure(t) : usual(Quantity::cabin_pressure, here.pressure);
    now.dynamic = dynamic_pressure_from_airspeed(here.pressure, now.airspeed, here.temperature, air);
    now.mach = mach_number(now.pressure, now.dynamic, air);
    now.recovery_temperature =
        recovery_temperature(here.temperature, now.mach, aircraft_.recovery_factor, air);

    const double load =
        (1.0 + second_rate_of(path.height, t) / standard_gravity) / std::cos(radians * now.roll);
    const double climb = std::asin(std::clamp(now.vertical_speed / now.airspeed, -1.0, 1.0));
    now.attack =
        aircraft_.attack.at(lift_number(load, now.mach, now.dynamic)) + aircraft_.flaps_attack * now.flaps;
    now.pitch = now.attack * std::cos(radians * now.roll) + climb / radians;
    heading += step_ * standard_gravity * std::tan(radians * now.roll) / now.airspeed / radians;
    now.heading = std::fmod(heading - now.sideslip + 720.0, 360.0);
    now.normal_acceleration = aircraft_.level_acceleration + (load - 1.0) * standard_gravity;
    // The part of gravity and lift that points along the axis of the fuselage is felt too.
    const double along = rate_of(path.airspeed, t) + standard_gravity * std::sin(climb);
    now.longitudinal_acceleration =
        along * std::cos(radians * now.attack) + load * standard_gravity * std::sin(radians * now.attack);

    now.radome_dynamic = aircraft_.radome_gain * now.dynamic;
    now.attack_differential = aircraft_.attack_ratio.at(now.attack) * now.radome_dynamic;
    now.sideslip_differential = aircraft_.sideslip_ratio.at(now.sideslip) * now.radome_dynamic;
    now.lams_airspeed = now.airspeed * beam_cosine(0.0, 0.0, now.attack, now.sideslip);
    instants.push_back(now);
  }
  return instants;
}

ModelSamples Recorder::samples_of(const Columns& columns, const std::vector<Instant>& instants) const {
  ModelSamples samples;
  samples.roles = columns.roles;
  for (const auto& [quantity, usual] : columns.columns) {
    std::optional<Series> values = values_of(quantity, instants, step_);
    if (!values) {
      values.emplace();
      for (const Instant& now : instants) values->push_back(usual.at(now.pressure));
    }
    samples.columns.emplace_back(quantity, std::move(*values));
  }
  return samples;
}

std::shared_ptr<const FlightSamples> Recorder::record(const std::string& name, const Path& path) const {
  const std::vector<Instant> instants = fly(path);
  const auto series = [&](double Instant::*member) {
    Series values;
    for (const Instant& now : instants) values.push_back(now.*member);
    return values;
  };
  FlightSamples samples;
  samples.name = name;
  samples.aircraft = registration_;
  samples.step = step_;
  samples.time = series(&Instant::time);
  for (double& time : samples.time) time += first_time_;
  samples.motion.time = samples.time;
  samples.motion.airspeed = series(&Instant::airspeed);
  samples.motion.altitude = series(&Instant::height);
  samples.motion.vertical_speed = series(&Instant::vertical_speed);
  samples.motion.roll = series(&Instant::roll);
  samples.motion.pitch = series(&Instant::pitch);
  samples.motion.heading = series(&Instant::heading);
  samples.motion.attack = series(&Instant::attack);
  samples.motion.sideslip = series(&Instant::sideslip);
  samples.motion.ground_speed = samples.motion.airspeed;
  samples.motion.ground_track = samples.motion.heading;
  samples.motion.liquid_water = series(&Instant::liquid_water);
  if (has_flaps_) samples.flaps.assign(instants.size(), 0.0);  // so that masks let flaps pass
  samples.intervals = path.regimes;
  for (Interval& interval : samples.intervals) {
    interval.begin += first_time_;
    interval.end += first_time_ + step_;  // the last sample belongs to it
  }
  samples.model = samples_of(model_, instants);
  samples.model.along_beam = {samples.motion.airspeed, 1, 2.0 * step_};
  samples.reference = samples_of(reference_, instants);
  return std::make_shared<const FlightSamples>(std::move(samples));
}

}  // namespace pcor::internal::manoeuvres
