#include "inspect/plausibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <pcor/base/utc.hpp>
#include <pcor/physics/air_data.hpp>
#include <pcor/physics/constants.hpp>
#include <pcor/physics/standard_atmosphere.hpp>
#include "numerics/median.hpp"
#include "numerics/missing.hpp"
#include "residuals/ground_velocity.hpp"
#include "roles/jumps.hpp"
#include "roles/plausible_pressure.hpp"
#include "roles/recorded_series.hpp"
#include "roles/resolution.hpp"

namespace pcor::internal {
namespace {

using Q = Quantity;

/// From which step on a series is coarse, in the unit of its role.
constexpr std::array<std::pair<Quantity, double>, 9> coarse_steps{{{Q::static_pressure, 0.1},
                                                                   {Q::dynamic_pressure, 0.1},
                                                                   {Q::radome_dynamic_pressure, 0.1},
                                                                   {Q::recovery_temperature, 0.25},
                                                                   {Q::ambient_temperature, 0.25},
                                                                   {Q::altitude, 5.0},
                                                                   {Q::attack, 0.2},
                                                                   {Q::heading, 0.5},
                                                                   {Q::ground_speed, 0.5}}};

class Plausibility {
 public:
  Plausibility(const Flight& flight, const ModelDefinition& model)
      : flight_(flight), model_(model), time_(record_times(flight)) {}

  std::vector<Problem> run() {
    limits();
    pressure();
    temperature_against_height();
    dynamic_against_airspeed();
    angles();
    ground_speed_against_position();
    jumps();
    steps();
    return std::move(problems_);
  }

 private:
  RecordedSeries read(Quantity role) const { return read_role(flight_, model_, role); }

  void add(const std::string& variable, std::string kind, double number, std::string unit,
           std::string action) {
    const std::string times =
        fmt::format("{} to {}", utc_text(time_.front(), "%H:%M:%S"), utc_text(time_.back(), "%H:%M:%S"));
    problems_.push_back({variable, std::move(kind), times, number, std::move(unit), std::move(action)});
  }

  /// Values beyond the limits of a role are missing: usually their unit is not the stated one.
  void limits() {
    const VariableNaming& naming = naming_of(model_, flight_);
    for (const auto& [role, variable] : model_.variables) {
      const QuantityInfo& info = info_of(role);
      const std::string unit = unit_of_role(model_, naming, role);
      if (!has_values(flight_, variable, std::string(info.unit), unit)) continue;
      const UnitConversion conversion = flight_.conversion(variable, std::string(info.unit), "", unit);
      const ReadValues read = read_values(flight_, variable, within_plausible_range(conversion, info));
      const auto impossible = static_cast<double>(read.excluded.impossible);
      const auto present = static_cast<double>(
          std::count_if(read.values.begin(), read.values.end(), [](double x) { return !std::isnan(x); }));
      if (impossible > present)
        add(variable,
            fmt::format("share of values outside {:g} to {:g} {}", info.minimum, info.maximum, info.unit),
            100.0 * impossible / (impossible + present), "%",
            "these values are treated as missing; state the unit of the variable in the [units] of the "
            "model");
    }
  }

  void pressure() {
    const std::optional<ImpossiblePressure> wrong = impossible_pressure(flight_, model_);
    if (!wrong) return;
    const std::string_view role = info_of(wrong->role).name;
    add(model_.variables.at(wrong->role),
        fmt::format("{} pressure divided by {}", wrong->role == Q::static_pressure ? "static" : "dynamic",
                    wrong->against),
        wrong->ratio, "1",
        wrong->are_exchanged
            ? "refused; static_pressure and dynamic_pressure may be exchanged in the [variables] of the model"
        : wrong->unit.empty()
            ? "refused; no unit explains this ratio, so a sensor or its calibration is wrong"
            : fmt::format("refused; state its unit in the [units] of the model, {} = \"{}\"", role,
                          wrong->unit));
  }

  void temperature_against_height() {
    const RecordedSeries temperature = read(Q::ambient_temperature);
    const std::vector<double> altitude = read(Q::altitude).values;
    constexpr double maximum = 40.0;  // K: no air is so far from the standard atmosphere
    std::vector<double> excesses;
    for (std::size_t i = 0; i < std::min(temperature.values.size(), altitude.size()); ++i)
      excesses.push_back(temperature.values[i] - standard_temperature(altitude[i]));
    const double excess = median(std::move(excesses));
    if (std::abs(excess) > maximum)
      add(temperature.variable, "temperature against height", excess, "K",
          "used unchanged; state its unit in the [units] of the model");
  }

  void dynamic_against_airspeed() {
    const RecordedSeries p = read(Q::static_pressure);
    const RecordedSeries q = read(Q::dynamic_pressure);
    const RecordedSeries airspeed = read(Q::true_airspeed);
    if (p.values.empty() || q.values.empty() || airspeed.values.empty()) return;
    const RecordedSeries temperature = read(Q::ambient_temperature);
    std::vector<double> ratios;
    for (std::size_t i = 0; i < p.values.size(); ++i) {
      if (!(p.values[i] > 0.0) || !(q.values[i] > 0.0) || !(airspeed.values[i] > 60.0)) continue;
      const double t = temperature.values.empty() ? standard_temperature(pressure_altitude(p.values[i]))
                                                  : temperature.values[i];
      const double mach = mach_number(p.values[i], q.values[i], dry_air<double>());
      ratios.push_back(true_airspeed(mach, t, dry_air<double>()) / airspeed.values[i]);
    }
    const double ratio = median(std::move(ratios));
    constexpr double maximum = 0.1;
    if (std::abs(ratio - 1.0) > maximum)
      add(q.variable, "airspeed from the pressures divided by " + airspeed.variable, ratio, "1",
          "used unchanged; name another dynamic pressure in the [variables] of the model, or its unit in "
          "[units]");
  }

  void angles() {
    for (const Quantity role : {Q::heading, Q::ground_track}) {
      const RecordedSeries angle = read(role);
      double maximum = 0.0;
      for (const double each : angle.values)
        maximum = std::isfinite(each) ? std::max(maximum, std::abs(each)) : maximum;
      // The maximum is 6.28 in radians and 360 in degrees, unless the flight is one leg.
      if (maximum > 3.0 && maximum < 6.3)
        add(angle.variable, "angle with a maximum typical of radians", maximum, "degree",
            fmt::format("used unchanged; if it is in radians, {} = \"radian\" in the [units] of the model",
                        info_of(role).name));
    }
  }

  void ground_speed_against_position() {
    const RecordedSeries latitude = read(Q::latitude);
    const RecordedSeries longitude = read_longitude(flight_, model_);
    const RecordedSeries speed = read(Q::ground_speed);
    if (latitude.values.empty() || longitude.values.empty() || speed.values.empty()) return;
    constexpr std::size_t apart = 20;
    constexpr double metres = 6371000.0 * constants::radians_per_degree;
    std::vector<double> ratios;
    for (std::size_t i = apart; i < time_.size(); ++i) {
      const double north = latitude.values[i] - latitude.values[i - apart];
      const double east = std::remainder(longitude.values[i] - longitude.values[i - apart], 360.0) *
                          std::cos(latitude.values[i] * constants::radians_per_degree);
      const double by_position = metres * std::hypot(north, east) / (time_[i] - time_[i - apart]);
      if (speed.values[i] > 40.0) ratios.push_back(by_position / speed.values[i]);
    }
    const double ratio = median(std::move(ratios));
    constexpr double maximum = 0.05;
    if (std::abs(ratio - 1.0) > maximum)
      add(speed.variable, "speed from the positions divided by this speed", ratio, "1",
          "used unchanged; state its unit in the [units] of the model");
  }

  void add_jumps(const std::string& variable, const char* kind, const std::vector<Jump>& jumps,
                 const char* unit, const char* action) {
    for (const Jump& jump : jumps) {
      problems_.push_back({variable, kind,
                           fmt::format("{} to {}", utc_text(time_[jump.first]),
                                       utc_text(time_[jump.first + jump.count - 1], "%H:%M:%S")),
                           jump.size, unit, action});
    }
  }

  void jumps() {
    const RecordedSeries altitude = read(Q::altitude);
    add_jumps(altitude.variable, "jump", find_jumps(altitude.values, time_), "m",
              "masked where heights are compared");
    const Positions positions = read_positions(flight_, model_, time_);
    constexpr const char* masked = "masked where velocities are compared with positions";
    add_jumps(positions.latitude.variable, "jump", positions.latitude_jumps, "m", masked);
    add_jumps(positions.longitude.variable, "jump", positions.longitude_jumps, "m", masked);
    const GroundVelocity velocity = read_ground_velocity(flight_, model_);
    add_jumps(velocity.speed.variable, "jump", velocity.jumps, "m/s", "masked where winds are compared");
    add_jumps(velocity.speed.variable, "velocity against position", velocity.against_position, "m/s",
              "masked where winds are compared");
  }

  void steps() {
    for (const auto& [role, coarse] : coarse_steps) {
      const RecordedSeries series = read(role);
      const double step = resolution_of(series.values);
      if (step >= 0.999 * coarse)
        add(series.variable, "recorded in steps", step, std::string(info_of(role).unit),
            fmt::format("used unchanged; rounding alone is {:.2g} {} rms", rounding_of(step),
                        info_of(role).unit));
    }
  }

  const Flight& flight_;
  const ModelDefinition& model_;
  std::vector<double> time_;
  std::vector<Problem> problems_;
};

}  // namespace

std::vector<Problem> find_problems(const Flight& flight, const ModelDefinition& model) {
  return Plausibility(flight, model).run();
}

}  // namespace pcor::internal
