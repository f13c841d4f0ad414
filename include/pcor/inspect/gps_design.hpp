#pragma once

#include <pcor/flight/flight.hpp>
#include <pcor/laws/model_file.hpp>

#include <optional>

namespace pcor {

/// How well the manoeuvres of a flight determine delta-p by GPS: standard errors, hPa.
struct GpsDesign {
  double level = 0.0;   ///< of its mean over the flight
  double slope = 0.0;   ///< of how it changes with the airspeed, rms over the flight
  double attack = 0.0;  ///< of how it changes with the attack, rms over the flight; NaN without that term
  bool by_wind = false;
  bool by_height = false;
};

/// What a refit with `--reference wind --reference height` would state, from the manoeuvres and the gusts alone,
/// before any fit: with usual sizes of what varies in the atmosphere. An error that the prior of an effect
/// limits, some hPa, says that the flight does not tell.
/// @param model with the roles, and terms that a refit finds
/// @return nothing where the flight records neither velocity over the ground nor height
std::optional<GpsDesign> gps_design(const Flight& flight, const ModelFile& model);

}  // namespace pcor
