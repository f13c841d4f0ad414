#include "diagnose/manoeuvres.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <pcor/physics/air_data.hpp>
#include <pcor/physics/geodesy.hpp>
#include <pcor/physics/lift.hpp>
#include <pcor/physics/moist_air.hpp>
#include "diagnose/manoeuvres/aircraft.hpp"
#include "diagnose/manoeuvres/atmosphere.hpp"
#include "diagnose/manoeuvres/path.hpp"
#include "diagnose/manoeuvres/recording.hpp"

namespace pcor::internal {
namespace {

using namespace manoeuvres;
using constants::standard_gravity;

/// Makes the manoeuvres, one after another. The numbers are those of NCAR's research flights (QAtools;
/// Cooper's study of manoeuvres).
class Programme {
 public:
  Programme(const Flights& flights, const Flown& flown, const Aircraft& aircraft)
      : flown_(flown),
        atmosphere_(flown),
        envelope_(flown, flights.front()->step),
        recorder_(flights, flown, aircraft, atmosphere_) {}

  std::vector<Manoeuvre> all() && {
    const Level& low = envelope_.low;
    const Level& high = envelope_.high;
    const bool two_levels = envelope_.has_two_levels();
    level_leg(low);
    if (two_levels) level_leg(high);
    pitch_manoeuvres();
    yaw_manoeuvre(low);
    if (two_levels) yaw_manoeuvre(high);
    speed_run(low);
    if (two_levels) speed_run(high);
    fast_leg();
    climb_and_descent();
    circles();
    steady_sideslips();
    legs_hours_apart();
    flaps_legs();
    cloud_passes();
    cabin_pressure_change();
    return std::move(made_);
  }

 private:
  double height_of(const Level& level) const { return atmosphere_.height_of(level.pressure); }

  /// For people, e.g. "at 3000 m".
  std::string place_of(const Level& level) const {
    if (!atmosphere_.has_altitude()) return fmt::format("at {:.0f} hPa", level.pressure);
    return fmt::format("at {:.0f} m", 100.0 * std::round(0.01 * height_of(level)));
  }

  std::string place_of(const Level& level, double airspeed) const {
    return fmt::format("{} and {:.0f} m/s", place_of(level), airspeed);
  }

  /// A path at the height of a level with one airspeed.
  Path level_path(const Level& level, double airspeed, double duration) const {
    Path path;
    path.duration = duration;
    path.height = constant(height_of(level));
    path.airspeed = constant(airspeed);
    path.regimes = {{Regime::level, 0.0, duration}};
    return path;
  }

  void make(const std::string& name, const std::string& how, double duration, const Path& path) {
    made_.push_back({name, how, duration, recorder_.record(name, path)});
  }

  void make(const std::string& name, const std::string& how, const Path& path) {
    make(name, how, path.duration, path);
  }

  void level_leg(const Level& level) {
    const Path path = level_path(level, level.usual, 600.0);
    make("level leg " + place_of(level), "10 minutes level " + place_of(level, level.usual), path);
  }

  void pitch_manoeuvres() {
    const Level& level = envelope_.middle;
    constexpr double least_apart = 10.0;  // m/s
    const double slow = level.slow + pitch_swing(level.slow);
    const double fast = level.fast - pitch_swing(level.fast);
    if (fast - slow < least_apart) return pitch_manoeuvre(level, level.usual);
    pitch_manoeuvre(level, slow);
    pitch_manoeuvre(level, fast);
  }

  static constexpr double pitch_period = 20.0;                                 // s
  static constexpr double pitch_frequency = 6.283185307179586 / pitch_period;  // 1/s

  /// By how much the airspeed swings at 4 m/s2, m/s: 40 m of height at constant energy.
  static double pitch_swing(double airspeed) {
    return standard_gravity * 4.0 / (pitch_frequency * pitch_frequency) / airspeed;
  }

  // The height swings about that of the level, and the power levers are not moved: gz + v^2/2 stays.
  void pitch_manoeuvre(const Level& level, double airspeed) {
    constexpr double cycles = 8.0;
    const double amplitude = pitch_amplitude(level, airspeed);
    Path path = level_path(level, airspeed, cycles * pitch_period);
    const Course rise =
        oscillation(-amplitude / (pitch_frequency * pitch_frequency), pitch_period, cycles, pitch_period);
    path.height = [rise, height = height_of(level)](double t) { return height + rise(t); };
    path.airspeed = [rise, airspeed](double t) {
      return std::sqrt(airspeed * airspeed - 2.0 * standard_gravity * rise(t));
    };
    path.regimes.push_back({Regime::pitch_manoeuvre, 0.0, path.duration});
    make(fmt::format("pitch manoeuvre at {:.0f} m/s", airspeed),
         fmt::format("8 cycles of 20 s, +-{:.1f} m/s2, power untouched, {}", amplitude,
                     place_of(level, airspeed)),
         path);
  }

  /// m/s2: as much as the greatest lift that was flown allows, a tenth added.
  double pitch_amplitude(const Level& level, double airspeed) const {
    const AirAt air = atmosphere_.at(height_of(level));
    const MoistAir<double> gas = moist_air(air.humidity);
    const double q = dynamic_pressure_from_airspeed(air.pressure, airspeed, air.temperature, gas);
    const double mach = mach_number(air.pressure, q, gas);
    const double most = 1.1 * envelope_.greatest_lift_number / lift_number(1.0, mach, q) - 1.0;
    return std::clamp(standard_gravity * most, 1.0, 4.0);
  }

  void yaw_manoeuvre(const Level& level) {
    constexpr double period = 12.0;
    constexpr double cycles = 12.0;
    Path path = level_path(level, level.usual, cycles * period);
    path.sideslip = oscillation(4.0, period, cycles, 0.5 * period);
    path.regimes.push_back({Regime::yaw_manoeuvre, 0.0, path.duration});
    make("yaw manoeuvre " + place_of(level),
         "12 cycles of 12 s, sideslip +-4 deg, " + place_of(level, level.usual), path);
  }

  void speed_run(const Level& level) {
    constexpr double least_range = 10.0;  // m/s
    constexpr double rate = 0.25;         // m/s2
    constexpr double pause = 20.0;        // s
    if (level.range() < least_range) return;
    const double branch = level.range() / rate;
    Path path = level_path(level, level.usual, 2.0 * branch + 3.0 * pause);
    path.airspeed = through({{pause, level.slow},
                             {pause + branch, level.fast},
                             {2.0 * pause + branch, level.fast},
                             {2.0 * (pause + branch), level.slow}});
    path.regimes.push_back({Regime::speed_run, 0.0, path.duration});
    make("speed run " + place_of(level),
         fmt::format("from {:.0f} to {:.0f} m/s and back at 0.25 m/s2, {}", level.slow, level.fast,
                     place_of(level)),
         path);
  }

  void fast_leg() {
    const Level& level = envelope_.fast;
    const double airspeed = level.fast;
    make("fast level leg", "5 minutes near the highest Mach number flown, " + place_of(level, airspeed),
         level_path(level, airspeed, 300.0));
  }

  void climb_and_descent() {
    constexpr double least_rise = 300.0;   // m
    constexpr double greatest_rate = 7.5;  // m/s
    constexpr double way = 300.0;          // s up, and as long down
    constexpr double ramp = 20.0;          // s
    const double bottom = atmosphere_.height_of(envelope_.greatest_pressure);
    const double top = atmosphere_.height_of(envelope_.least_pressure);
    if (top - bottom < least_rise) return;
    const double rate = std::min(greatest_rate, (top - bottom) / (way - ramp));
    const double rise = rate * (way - ramp);
    const double begin = std::clamp(height_of(envelope_.middle) - 0.5 * rise, bottom, top - rise);
    const Level lower = envelope_.level_at(atmosphere_.at(begin).pressure);
    const Level upper = envelope_.level_at(atmosphere_.at(begin + rise).pressure);
    const double airspeed = std::min(std::max({envelope_.middle.usual, lower.slow, upper.slow}),
                                     std::max(lower.usual, std::min(lower.fast, upper.fast)));
    Path path = level_path(lower, airspeed, 2.0 * way);
    path.height = [begin, up = steady_change(rate, 0.0, way, ramp),
                   down = steady_change(rate, way, 2.0 * way, ramp)](double t) {
      return begin + up(t) - down(t);
    };
    path.regimes = {{Regime::climb, 0.0, way}, {Regime::descent, way, 2.0 * way}};
    make("climb and descent",
         fmt::format("5 minutes up at {:.1f} m/s and 5 down through the same levels, beginning {}", rate,
                     place_of(lower, airspeed)),
         path);
  }

  void circles() {
    constexpr double roll = 26.7;    // deg
    constexpr double rolling = 6.0;  // s
    constexpr double pause = 20.0;   // s
    const Level& level = envelope_.middle;
    const double airspeed = level.usual;
    const double round =
        6.283185307179586 * airspeed / (standard_gravity * std::tan(constants::radians_per_degree * roll));
    const double second = pause + round + rolling;
    Path path = level_path(level, airspeed, 2.0 * (round + rolling) + pause);
    path.roll = through({{0.0, 0.0},
                         {rolling, -roll},
                         {round, -roll},
                         {round + rolling, 0.0},
                         {second, 0.0},
                         {second + rolling, roll},
                         {second + round, roll},
                         {second + round + rolling, 0.0}});
    for (const double begin : {0.0, second}) {
      for (const Regime regime : {Regime::turn, Regime::circle})
        path.regimes.push_back({regime, begin, begin + round + rolling});
    }
    make("circles", "a full circle left and one right, roll 26.7 deg, " + place_of(level, airspeed), path);
  }

  void steady_sideslips() {
    const Level& level = envelope_.middle;
    Path path = level_path(level, level.usual, 300.0);
    path.sideslip =
        through({{60.0, 0.0}, {66.0, 4.0}, {144.0, 4.0}, {156.0, -4.0}, {234.0, -4.0}, {240.0, 0.0}});
    make("steady sideslips",
         "80 s with 4 deg of sideslip to each side, wings level, between straight legs of a minute, " +
             place_of(level, level.usual),
         path);
  }

  void legs_hours_apart() {
    constexpr double leg = 300.0;     // s
    constexpr double later = 7200.0;  // s
    const Level& level = envelope_.middle;
    Path path = level_path(level, level.usual, later + leg);
    path.not_recorded = {leg, later};
    path.regimes = {{Regime::level, 0.0, leg}, {Regime::level, later, later + leg}};
    make("level leg repeated two hours later",
         "5 minutes early in the flight and 5 minutes two hours later, the same leg " +
             place_of(level, level.usual),
         2.0 * leg, path);
  }

  void flaps_legs() {
    if (!recorder_.has(Quantity::flaps)) return;
    const Level& level = envelope_.low;
    Path path = level_path(level, level.slow, 480.0);
    path.flaps =
        through({{112.0, 0.0}, {128.0, 50.0}, {232.0, 50.0}, {248.0, 0.0}, {352.0, 0.0}, {368.0, 50.0}});
    make("level legs with flaps",
         "4 legs of 2 minutes, flaps in, 50 %, in and 50 %, " + place_of(level, level.slow), path);
  }

  void cloud_passes() {
    if (!recorder_.has(Quantity::liquid_water)) return;
    constexpr double usual_liquid = 0.3;  // g/m3
    constexpr double cloudy = 0.1;        // g/m3
    std::vector<double> liquid = flown_.column(Quantity::liquid_water);
    std::vector<double> where = flown_.pressure;
    for (std::size_t i = 0; i < liquid.size(); ++i) {
      if (!(liquid[i] > cloudy)) liquid[i] = where[i] = std::nan("");
    }
    const double met = median(std::move(liquid));
    const double pressure = median(std::move(where));
    const double amount = std::isnan(met) ? usual_liquid : met;
    const Level level = std::isnan(met) ? envelope_.low : envelope_.level_at(pressure);
    Path path = level_path(level, level.usual, 600.0);
    std::vector<std::pair<double, double>> edges;
    for (double begin = 15.0; begin < path.duration; begin += 60.0) {
      edges.insert(edges.end(),
                   {{begin - 1.0, 0.0}, {begin + 1.0, amount}, {begin + 29.0, amount}, {begin + 31.0, 0.0}});
      path.regimes.push_back({Regime::cloud, begin, begin + 30.0});
    }
    path.liquid_water = through(std::move(edges));
    make("cloud passes",
         fmt::format("10 passes of 30 s through {:.1f} g/m3 with 30 s of clear air between, {}", amount,
                     place_of(level, level.usual)),
         path);
  }

  // Between the least and the greatest pressure of the cabin that were met, but never below that outside.
  void cabin_pressure_change() {
    if (!recorder_.has(Quantity::cabin_pressure)) return;
    constexpr double least_change = 30.0;  // hPa
    constexpr double most_change = 100.0;  // hPa
    const Level& level = envelope_.middle;
    const std::vector<double> met = flown_.column(Quantity::cabin_pressure);
    const double usual = recorder_.usual(Quantity::cabin_pressure, level.pressure);
    const double least = std::max({quantile(met, 0.01), level.pressure, usual - most_change});
    const double change = usual - least;
    if (!(change > least_change)) return;
    Path path = level_path(level, level.usual, 600.0);
    path.cabin_pressure = through({{60.0, usual}, {240.0, least}, {360.0, least}, {540.0, usual}});
    make("cabin pressure change",
         fmt::format(
             "10 minutes level in which the pressure of the cabin goes down by {:.0f} hPa and back, {}",
             change, place_of(level, level.usual)),
         path);
  }

  const Flown& flown_;
  Atmosphere atmosphere_;
  Envelope envelope_;
  Recorder recorder_;
  std::vector<Manoeuvre> made_;
};

bool is_usable(const std::shared_ptr<const FlightSamples>& flight) {
  return flight && !flight->time.empty() && flight->step > 0.0 &&
         flight->model.find(Quantity::static_pressure) != nullptr &&
         flight->model.find(Quantity::dynamic_pressure) != nullptr;
}

}  // namespace

std::vector<Manoeuvre> standard_manoeuvres(const std::vector<std::shared_ptr<const FlightSamples>>& flights) {
  constexpr std::size_t enough = 60;  // samples in the air
  Flights usable;
  std::copy_if(flights.begin(), flights.end(), std::back_inserter(usable), is_usable);
  const Flown flown(usable, Flown::Flaps::in);
  if (flown.pressure.size() < enough) return {};
  const Aircraft aircraft(flown, Flown(usable, Flown::Flaps::out));
  return Programme(usable, flown, aircraft).all();
}

}  // namespace pcor::internal
