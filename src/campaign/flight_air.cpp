#include "campaign/flight_air.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <pcor/physics/geodesy.hpp>
#include <pcor/physics/moist_air.hpp>
#include <pcor/physics/standard_atmosphere.hpp>
#include "numerics/missing.hpp"
#include "residuals/ground_velocity.hpp"
#include "residuals/masks.hpp"
#include "residuals/model_on_samples.hpp"
#include "roles/jumps.hpp"
#include "roles/pressure_height.hpp"
#include "roles/recorded_series.hpp"

namespace pcor::internal {
namespace {

std::vector<bool> find_flying(const FlightSamples& samples, const MaskOptions& options) {
  const std::vector<Mask> masks = masks_as_flown(samples, options);
  std::vector<bool> flying(masks.size());
  for (std::size_t i = 0; i < flying.size(); ++i)
    flying[i] = masks[i] == Mask::none && samples.motion.airspeed[i] >= options.min_airspeed;
  for (const FrozenSpan& span : samples.model.frozen)
    std::fill_n(flying.begin() + static_cast<std::ptrdiff_t>(span.first), span.count, false);
  return flying;
}

void run_chain(const FlightSamples& samples, const ModelDefinition& model, FlightAir& air) {
  const ModelOnSamples law(model, samples.model);
  const Chain& chain = law.chain();
  const std::size_t count = samples.time.size();
  std::vector<Batch::Output> outputs;
  const auto requested = [&](Quantity quantity, std::vector<double>& values) {
    values.resize(count);
    outputs.push_back({quantity, values.data()});
  };
  const auto if_there = [&](Quantity quantity, std::vector<double>& values) {
    if (chain.derives(quantity)) requested(quantity, values);
    if (chain.recorded(quantity)) values = *samples.model.find(quantity);
  };
  std::vector<double> humidity;
  requested(Quantity::static_defect, air.static_defect);
  requested(Quantity::corrected_static_pressure, air.pressure);
  requested(Quantity::corrected_dynamic_pressure, air.dynamic);
  requested(Quantity::corrected_mach, air.mach);
  requested(Quantity::humidity, humidity);
  if (chain.has_temperature()) {
    requested(Quantity::ambient_temperature, air.temperature);
    requested(Quantity::corrected_airspeed, air.airspeed);
  }
  if_there(Quantity::attack, air.attack);
  if_there(Quantity::sideslip, air.sideslip);
  if_there(Quantity::attack_ratio, air.attack_ratio);
  if_there(Quantity::sideslip_ratio, air.sideslip_ratio);
  if (chain.has_lams()) {
    air.laser.emplace();
    requested(Quantity::lams_static_defect, air.laser->static_defect);
    requested(Quantity::lams_temperature, air.laser->temperature);
  }
  law.batch().run(law.columns(), outputs, count);
  air.gas_constant.resize(count);
  for (std::size_t i = 0; i < count; ++i) air.gas_constant[i] = moist_air(humidity[i]).gas_constant;
  if (!air.laser) return;
  // Inverse of eq. 12: v = M (gamma R_a T)^(1/2) with the laser temperature is the laser airspeed.
  air.laser->airspeed.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    air.laser->airspeed[i] = true_airspeed(air.mach[i], air.laser->temperature[i], moist_air(humidity[i]));
}

void find_heights(const Flight& flight, const ModelDefinition& model, FlightAir& air) {
  RecordedSeries height = read_role(flight, model, Quantity::altitude);
  air.height_variable = height.values.empty() ? height.without_unit : height.variable;
  const HeightEvidence evidence = height_evidence(flight, height.values, static_pressures_of(flight, model));
  if (evidence.kind == HeightEvidence::Kind::pressure_altitude) {
    air.notes.push_back(
        fmt::format("{} is a pressure altitude, not a GPS height: {}", height.variable, to_string(evidence)));
    air.height_variable.clear();
    height.values.clear();
  }
  air.height_scale_problem = evidence.slope_problem(height.variable);
  mask(find_jumps(height.values, record_times(flight)), height.values);
  air.height = std::move(height.values);
  air.latitude = read_role(flight, model, Quantity::latitude).values;
  air.pressure_altitude.resize(air.size());
  for (std::size_t i = 0; i < air.size(); ++i) air.pressure_altitude[i] = pressure_altitude(air.pressure[i]);
  if (air.height.empty() || air.latitude.empty()) return;
  air.geopotential_height.resize(air.size());
  air.d_value.resize(air.size());
  for (std::size_t i = 0; i < air.size(); ++i) {
    air.geopotential_height[i] = geopotential_height(air.latitude[i], air.height[i]);
    air.d_value[i] = air.geopotential_height[i] - air.pressure_altitude[i];
  }
}

void find_tail_wind(FlightAir& air) {
  const std::vector<double>& heading = air.samples->motion.heading;
  if (heading.empty() || air.east_speed.empty() || air.airspeed.empty()) return;
  air.tail_wind.resize(air.size());
  for (std::size_t i = 0; i < air.size(); ++i) {
    const double angle = heading[i] * constants::radians_per_degree;
    air.tail_wind[i] =
        air.east_speed[i] * std::sin(angle) + air.north_speed[i] * std::cos(angle) - air.airspeed[i];
  }
}

}  // namespace

FlightAir read_flight_air(const FlightSet& flights, std::size_t number, const ModelDefinition& model,
                          const MaskOptions& options) {
  const Flight& flight = flights[number];
  const bool with_laser = flight.has(model.variable_of(Quantity::lams_airspeed));
  const auto reference =
      with_laser ? lams_reference() : pressure_reference(model.variables.at(Quantity::static_pressure));
  const auto samples = flights.samples(number, model, *reference, options);
  FlightAir air;
  air.notes = samples->notes;
  air.flying = find_flying(*samples, options);
  air.measured_static = *samples->model.find(Quantity::static_pressure);
  air.measured_dynamic = *samples->model.find(Quantity::dynamic_pressure);
  run_chain(*samples, model, air);
  air.samples = samples;
  find_heights(flight, model, air);
  const GroundVelocity ground = read_ground_velocity(flight, model);
  for (std::size_t i = 0; i < ground.speed.values.size(); ++i) {
    const double track = ground.track.values[i] * constants::radians_per_degree;
    air.east_speed.push_back(ground.speed.values[i] * std::sin(track));
    air.north_speed.push_back(ground.speed.values[i] * std::cos(track));
  }
  find_tail_wind(air);
  return air;
}

std::string height_problem(const FlightAir& air) {
  if (air.height.empty() && !air.height_variable.empty())
    return fmt::format(
        "{0} has no unit in the file; set [variables] altitude = \"{0}\" and [units] altitude = \"m\" in the "
        "model, or add a units attribute to the file",
        air.height_variable);
  if (air.height.empty())
    return "the flight records no GPS height (GGALT; [variables] altitude names another)";
  if (air.latitude.empty())
    return "the flight records no latitude (GGLAT, LATC; [variables] latitude names another), so gravity is "
           "not known";
  return air.height_scale_problem;
}

}  // namespace pcor::internal
