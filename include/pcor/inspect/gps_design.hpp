#pragma once

#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>

#include <optional>

namespace pcor {

/// How well the manoeuvres of a flight determine delta-p by GPS: standard errors, hPa.
struct GpsDesign {
  double level = 0.0;   ///< mean over the flight
  double slope = 0.0;   ///< change with the airspeed, rms over the flight
  double attack = 0.0;  ///< change with the attack, rms over the flight; NaN without that term
  bool by_wind = false;
  bool by_height = false;
};

template <class Field>
void describe(const GpsDesign& self, Field& field) {
  field("level", self.level, "standard error of the mean of delta-p over the flight", "hPa");
  field("slope", self.slope, "standard error of its change with the airspeed, rms over the flight", "hPa");
  field("attack", self.attack, "standard error of its change with the attack, rms over the flight", "hPa");
}

/// Errors that a refit with `--reference wind --reference height` would state, from the manoeuvres and the
/// gusts alone, before any fit, with usual sizes of the variations of the atmosphere. An error of several hPa
/// is that of the prior: the flight does not determine this part.
/// @param model with the roles, and terms that a refit finds
/// @return empty without velocity over the ground and height
std::optional<GpsDesign> gps_design(const Flight& flight, const ModelDefinition& model);

}  // namespace pcor
