#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pcor/base/note.hpp>
#include <pcor/campaign/flight_set.hpp>
#include <pcor/residuals/residuals.hpp>

namespace pcor::internal {

/// LAMS-derived series of a flight, one value per record, NaN if missing.
struct LaserAir {
  std::vector<double> airspeed;       ///< true airspeed from the beam, m/s
  std::vector<double> static_defect;  ///< delta-p from LAMS, hPa
  std::vector<double> temperature;    ///< eq. 12 with the model's pressures, K

  template <class Archive>
  void serialize(Archive& archive) {
    archive(airspeed, static_defect, temperature);
  }
};

/// Air along a flight computed with a model: input of checks and of the temperature fit. One value for each
/// record, NaN if missing; unavailable series are empty.
struct FlightAir {
  std::shared_ptr<const FlightSamples> samples;  ///< recorded inputs and motion
  std::vector<bool> flying;                      ///< airborne, fast enough, flaps in, not excluded

  std::vector<double> measured_static;   ///< hPa
  std::vector<double> measured_dynamic;  ///< hPa
  std::vector<double> static_defect;     ///< delta-p of the model, hPa
  std::vector<double> pressure;          ///< corrected static pressure, hPa
  std::vector<double> dynamic;           ///< corrected dynamic pressure, hPa
  std::vector<double> mach;
  std::vector<double> temperature;   ///< ambient temperature, K
  std::vector<double> airspeed;      ///< true airspeed, m/s
  std::vector<double> gas_constant;  ///< gas constant of the moist air, J/(kg K)
  std::vector<double> attack;        ///< deg
  std::vector<double> sideslip;      ///< deg
  std::vector<double> attack_ratio;  ///< ADIFR/QCR
  std::vector<double> sideslip_ratio;
  std::optional<LaserAir> laser;

  /// Name of the height; without `height`, a height without unit. Empty if the flight has no height.
  std::string height_variable;
  std::string height_scale_problem{};       ///< `HeightEvidence::slope_problem`
  std::vector<double> height;               ///< GPS height, m
  std::vector<double> latitude;             ///< deg
  std::vector<double> geopotential_height;  ///< geopotential height by GPS, m
  std::vector<double> pressure_altitude;    ///< pressure altitude of the corrected pressure, m
  /// Geopotential height minus pressure altitude, m: height of the surface of this pressure above the
  /// standard atmosphere (DVALUE).
  std::vector<double> d_value;
  std::vector<double> east_speed;   ///< eastward ground velocity, m/s
  std::vector<double> north_speed;  ///< northward ground velocity, m/s
  /// Wind along the aircraft's axis, m/s, tail wind positive: ground speed times cos(track - heading), minus
  /// the true airspeed (the memo's UXW).
  std::vector<double> tail_wind;

  Notes notes;  ///< notes for the user, one sentence each

  template <class Archive>
  void serialize(Archive& archive) {
    archive(samples, flying, measured_static, measured_dynamic, static_defect, pressure, dynamic, mach,
            temperature, airspeed, gas_constant, attack, sideslip, attack_ratio, sideslip_ratio, laser,
            height_variable, height_scale_problem, height, latitude, geopotential_height, pressure_altitude,
            d_value, east_speed, north_speed, tail_wind, notes);
  }

  std::size_t size() const { return flying.size(); }
  double step() const { return samples->step; }
  const std::vector<double>& time() const { return samples->time; }
};

/// Reads a flight of this rank and evaluates `model` on it. The laser is used if the model has one and the
/// flight records it. Heights, positions and angles follow the model's roles, otherwise the names of NCAR's
/// files.
/// @throws Error as does `read_samples`.
FlightAir read_flight_air(const FlightSet& flights, std::size_t number, const ModelDefinition& model,
                          const MaskOptions& options = {});

/// Reason why the height of a flight does not match its pressure, for example because it is in feet; empty if
/// it matches. Uses the samples in the air only.
std::string height_problem(const FlightAir& air);

}  // namespace pcor::internal
