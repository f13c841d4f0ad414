#include "simulate/pilot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <pcor/base/error.hpp>
#include <pcor/physics/constants.hpp>

namespace pcor::internal::simulate {
namespace {

constexpr double degree = constants::radians_per_degree;
constexpr double metres_per_degree = 111195.0;  // latitude, mean earth
constexpr double gradient_length = 1e5;         // m; slopes of isobars are per 100 km
constexpr double roll_rate = 5.0;               // deg/s, of research turns
constexpr double flap_rate = 3.0;               // percent/s, estimate
constexpr double follows_gusts = 1.5;           // s, estimate
constexpr double cloud_memory = 20.0;           // s: patches of 2 to 5 km
constexpr double trim_memory = 60.0;            // s, of the power levers
constexpr double trim_rms = 0.02;               // part of the torque
constexpr double hidden_memory = 200.0;         // s
constexpr double cabin_time = 120.0;            // s
constexpr double bay_time = 900.0;              // s
constexpr double slowest = 0.5;                 // m/s; what an aircraft at rest is treated as

double kept(double memory) { return std::exp(-time_step / memory); }

/// Above which value a normal variable is with a probability, by bisection.
double threshold_of(double probability) {
  double low = -10.0;
  double high = 10.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(middle / std::sqrt(2.0)) > probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Moves `value` to `target` by at most `rate` a second.
void approach(double& value, double target, double rate) {
  value += std::clamp(target - value, -rate * time_step, rate * time_step);
}

/// First-order response of time constant `time`.
void follow(double& value, double target, double time) { value += (target - value) * time_step / time; }

}  // namespace

Pilot::Pilot(const Scenario& scenario)
    : scenario_(scenario),
      aircraft_(info_of(scenario.aircraft)),
      column_(scenario.atmosphere, scenario.latitude),
      gust_along_(scenario.seed, "gust along", false),
      gust_across_(scenario.seed, "gust across", true),
      gust_up_(scenario.seed, "gust up", true),
      drift_east_(scenario.seed, "wind east"),
      drift_north_(scenario.seed, "wind north"),
      trim_(scenario.seed, "trim"),
      hidden_(scenario.seed, "hidden"),
      height_(scenario.atmosphere.ground_height),
      direction_(scenario.heading),
      weight_(std::isnan(scenario.weight) ? aircraft_.weight : scenario.weight) {
  int number = 0;
  for (const Scenario::Cloud& layer : scenario.atmosphere.clouds) {
    clouds_.push_back(
        {&layer, threshold_of(layer.cover), Drift(scenario.seed, "cloud " + std::to_string(number++))});
  }
}

double Pilot::isobar_height() const {
  return (scenario_.atmosphere.pressure_height_east * east_ +
          scenario_.atmosphere.pressure_height_north * north_) /
         gradient_length;
}

double Pilot::column_height() const {
  const double latitude = scenario_.latitude + north_ / metres_per_degree;
  return height() * gravity(latitude, 0.0) / gravity(scenario_.latitude, 0.0);
}

double Pilot::towards_height(double height, double rate) {
  constexpr double capture = 10.0;        // s
  constexpr double response = 2.0;        // s
  constexpr double comfortable = 1.0;     // m/s2
  constexpr double smoothing_time = 0.4;  // s
  const double requested = std::clamp((height - this->height()) / capture, -rate, rate);
  const double acceleration = std::clamp((requested - vertical_speed_) / response, -comfortable, comfortable);
  follow(smooth_vertical_, acceleration, smoothing_time);
  return smooth_vertical_;
}

double Pilot::towards_speed(double speed, double limit) const {
  constexpr double capture = 3.0;  // s
  return std::clamp((speed - speed_) / capture, -limit, limit);
}

double Pilot::liquid_water() {
  double liquid = 0.0;
  for (Cloud& cloud : clouds_) {
    const bool here = cloud.drift.next(kept(cloud_memory)) > cloud.threshold;
    if (here && height_ > cloud.layer->base && height_ < cloud.layer->top) liquid += cloud.layer->liquid;
  }
  return liquid;
}

void Pilot::step(const Command& command, const Scenario::Leg& leg) {
  // The air
  const Scenario::Atmosphere& atmosphere = scenario_.atmosphere;
  const Air air = column_.at(column_height());
  const double edr = dissipation(atmosphere, height_);
  const double aloft = on_ground_ ? std::clamp(speed_ / aircraft_.lift_off_speed, 0.0, 1.0) : 1.0;
  const double moved = std::max(speed_, slowest) * time_step;
  const double along = aloft * gust_along_.next(moved, edr);
  const double across = aloft * gust_across_.next(moved, edr);
  const double up = aloft * gust_up_.next(moved, edr);
  follow(followed_up_, up, follows_gusts);
  follow(followed_across_, across, follows_gusts);
  const double mean_wind =
      atmosphere.wind_speed + atmosphere.wind_shear * 1e-3 * (height_ - atmosphere.ground_height);
  const double from = degree * atmosphere.wind_from;
  const double drift = kept(atmosphere.wind_drift_time);
  const double wind_east =
      aloft * (-mean_wind * std::sin(from) + atmosphere.wind_drift * drift_east_.next(drift));
  const double wind_north =
      aloft * (-mean_wind * std::cos(from) + atmosphere.wind_drift * drift_north_.next(drift));

  // The aircraft in it
  const double g = gravity(scenario_.latitude, height_);
  const double airspeed = std::max(speed_ + along, slowest);
  const double mach = airspeed / speed_of_sound(air);
  const double steady_mach = std::min(speed_ / speed_of_sound(air), 0.99);
  const double flow = 0.5 * density(air) * std::max(speed_ * speed_, slowest);
  const double load = (g + command.vertical_acceleration) / (g * std::cos(degree * roll_));
  double attack = lift_attack(aircraft_, weight_, load, flow, steady_mach, flaps_);
  if (on_ground_) {
    const double rotating = std::clamp((speed_ / aircraft_.lift_off_speed - 0.9) / 0.1, 0.0, 1.0);
    attack = rotating > 0.0 ? rotating * attack : 0.0;
  } else if (attack > aircraft_.max_attack) {
    throw Error(Error::Code::definition,
                fmt::format("{}: at {:.0f} m and {:.0f} m/s the {} stalls (angle of attack {:.1f} deg); fly "
                            "faster, lower or with flaps",
                            leg.position, height_, speed_, aircraft_.type, attack));
  } else if (steady_mach > aircraft_.max_mach) {
    throw Error(Error::Code::definition,
                fmt::format("{}: at {:.0f} m, {:.0f} m/s is Mach {:.3f}, beyond the limit {} of the {}; fly "
                            "slower or lower",
                            leg.position, height_, speed_, steady_mach, aircraft_.max_mach, aircraft_.type));
  }
  const double climb = std::clamp(vertical_speed_ / std::max(speed_, 10.0), -1.0, 1.0);  // sine of the path
  const double per_speed = 1.0 / (degree * std::max(airspeed, 10.0));
  // The axes of the aircraft about the direction in which it moves through the air: of its velocity, in units
  // of the forward part, the part to the right and the part down after the roll.
  const double slips = std::tan(degree * command.sideslip);
  const double sinks = std::tan(degree * attack);
  const double right = slips * std::cos(degree * roll_) - sinks * std::sin(degree * roll_);
  const double down = slips * std::sin(degree * roll_) + sinks * std::cos(degree * roll_);
  const double climbs = climb * std::sqrt(1.0 + right * right / (1.0 + down * down));
  const double pitch = std::atan(down) + std::asin(std::clamp(climbs, -1.0, 1.0));
  const double heading = direction_ - std::atan2(right, std::cos(pitch) + down * std::sin(pitch)) / degree;
  const double level_speed = speed_ * std::sqrt(1.0 - climb * climb);
  const double sine = std::sin(degree * direction_);
  const double cosine = std::cos(degree * direction_);
  const double ground_east = level_speed * sine + wind_east - followed_across_ * cosine;
  const double ground_north = level_speed * cosine + wind_north + followed_across_ * sine;
  const double track = std::atan2(ground_east, ground_north) / degree;

  truth_.pressure.push_back(air.pressure);
  truth_.total_pressure.push_back(total_pressure(air, airspeed));
  truth_.temperature.push_back(air.temperature);
  truth_.vapor_pressure.push_back(air.vapor_pressure);
  truth_.airspeed.push_back(airspeed);
  truth_.mach.push_back(mach);
  truth_.attack.push_back(attack + (up - followed_up_) * per_speed);
  truth_.sideslip.push_back(command.sideslip + (across - followed_across_) * per_speed);
  truth_.pitch.push_back(pitch / degree);
  truth_.roll.push_back(roll_);
  truth_.heading.push_back(heading);
  truth_.track.push_back(track + 360.0 * std::round((direction_ - track) / 360.0));
  truth_.ground_speed.push_back(std::hypot(ground_east, ground_north));
  truth_.altitude.push_back(height_);
  truth_.vertical_speed.push_back(vertical_speed_);
  truth_.latitude.push_back(scenario_.latitude + north_ / metres_per_degree);
  truth_.longitude.push_back(scenario_.longitude +
                             east_ / (metres_per_degree * std::cos(degree * scenario_.latitude)));
  truth_.height.push_back(height_ - atmosphere.ground_height);
  truth_.normal_acceleration.push_back((load - 1.0) * g);
  truth_.forward_acceleration.push_back(command.acceleration * std::cos(pitch) +
                                        (command.vertical_acceleration + g) * std::sin(pitch));
  truth_.flaps.push_back(flaps_);
  truth_.liquid_water.push_back(liquid_water());
  truth_.weight.push_back(weight_);
  truth_.wind_east.push_back(wind_east - along * sine - across * cosine);
  truth_.wind_north.push_back(wind_north - along * cosine + across * sine);
  truth_.dissipation.push_back(edr);
  truth_.hidden.push_back(hidden_.next(kept(hidden_memory)));

  const double lift = weight_ * load * g / (flow * aircraft_.wing_area);
  const double energy = weight_ * (g * vertical_speed_ + speed_ * command.acceleration);
  const double rolling = on_ground_ ? 0.0 : lift;
  truth_.torque.push_back(torque(aircraft_, rolling, flow, speed_, energy) *
                          (1.0 + trim_rms * trim_.next(kept(trim_memory))));

  const double cabin_equilibrium =
      std::max(air.pressure, std::min(0.7 * atmosphere.ground_pressure + 0.3 * air.pressure,
                                      air.pressure + aircraft_.cabin_differential));
  if (!cabin_) cabin_ = cabin_equilibrium;
  follow(*cabin_, cabin_equilibrium, cabin_time);
  truth_.cabin_pressure.push_back(*cabin_);
  const double bay_equilibrium = 290.0 + 0.4 * (air.temperature - 290.0);  // heated from inside
  if (!bay_) bay_ = bay_equilibrium;
  follow(*bay_, bay_equilibrium, bay_time);
  truth_.bay_temperature.push_back(*bay_);

  // To the next step
  east_ += ground_east * time_step;
  north_ += ground_north * time_step;
  height_ += (vertical_speed_ + 0.5 * command.vertical_acceleration * time_step) * time_step;
  vertical_speed_ += command.vertical_acceleration * time_step;
  if (!on_ground_)
    direction_ += g * std::tan(degree * roll_) / std::max(speed_, slowest) / degree * time_step;
  speed_ = std::max(0.0, speed_ + command.acceleration * time_step);
  approach(roll_, command.roll, roll_rate);
  approach(flaps_, command.flaps, flap_rate);
  weight_ -= aircraft_.fuel_flow * time_step;
}

}  // namespace pcor::internal::simulate
