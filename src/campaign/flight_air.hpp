#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pcor/campaign/flight_set.hpp>
#include <pcor/residuals/residuals.hpp>

namespace pcor::internal {

/// What the laser says of a flight, one value for each record, NaN where missing.
struct LaserAir {
  std::vector<double> airspeed;       ///< true airspeed from the beam, m/s
  std::vector<double> static_defect;  ///< delta-p from LAMS, hPa
  std::vector<double> temperature;    ///< eq. 12 with the model's pressures, K

  template <class Archive>
  void serialize(Archive& archive) {
    archive(airspeed, static_defect, temperature);
  }
};

/// The air along a flight, as a model sees it: what checks and the fit of temperature look at. One value for
/// each record, NaN where missing; a series that the flight cannot give is empty.
struct FlightAir {
  std::shared_ptr<const FlightSamples> samples;  ///< what was recorded, how it was flown
  std::vector<bool> flying;                      ///< in the air, fast enough, flaps in, not excluded

  std::vector<double> measured_static;   ///< hPa
  std::vector<double> measured_dynamic;  ///< hPa
  std::vector<double> static_defect;     ///< delta-p of the model, hPa
  std::vector<double> pressure;          ///< corrected static pressure, hPa
  std::vector<double> dynamic;           ///< corrected dynamic pressure, hPa
  std::vector<double> mach;
  std::vector<double> temperature;   ///< ambient, K
  std::vector<double> airspeed;      ///< true, m/s
  std::vector<double> gas_constant;  ///< of the moist air, J/(kg K)
  std::vector<double> attack;        ///< deg
  std::vector<double> sideslip;      ///< deg
  std::vector<double> attack_ratio;  ///< ADIFR/QCR
  std::vector<double> sideslip_ratio;
  std::optional<LaserAir> laser;

  /// Which height it is; without a `height`, one that has no unit. Empty where there is none.
  std::string height_variable;
  std::vector<double> height;               ///< GPS height, m
  std::vector<double> latitude;             ///< deg
  std::vector<double> geopotential_height;  ///< of the GPS height, m
  std::vector<double> pressure_altitude;    ///< of the corrected pressure, m
  /// Geopotential height less pressure altitude, m: how far above that of the standard atmosphere the
  /// surface of this pressure lies (DVALUE).
  std::vector<double> d_value;
  std::vector<double> east_speed;   ///< over the ground, m/s
  std::vector<double> north_speed;  ///< over the ground, m/s
  /// Wind along the aircraft's axis, m/s, from behind positive: ground speed times cos(track - heading), less
  /// the true airspeed (the memo's UXW).
  std::vector<double> tail_wind;

  std::vector<std::string> notes;  ///< what a user should know, a sentence each

  template <class Archive>
  void serialize(Archive& archive) {
    archive(samples, flying, measured_static, measured_dynamic, static_defect, pressure, dynamic, mach,
            temperature, airspeed, gas_constant, attack, sideslip, attack_ratio, sideslip_ratio, laser,
            height_variable, height, latitude, geopotential_height, pressure_altitude, d_value, east_speed,
            north_speed, tail_wind, notes);
  }

  std::size_t size() const { return flying.size(); }
  double step() const { return samples->step; }
  const std::vector<double>& time() const { return samples->time; }
};

/// Reads an own flight of a set and runs `model` over it. The laser takes part where the model has one and
/// the flight records it. Heights, positions and angles are those of the model's roles, else of the names
/// that NCAR's files use.
/// @throws Error as `read_samples`.
FlightAir read_flight_air(const FlightSet& flights, std::size_t number, const ModelDefinition& model,
                          const MaskOptions& options = {});

/// Why the height of a flight is none that goes with its pressure, for example because it is in feet; empty
/// where it is well. Looks at the samples in the air only.
std::string height_problem(const FlightAir& air);

}  // namespace pcor::internal
