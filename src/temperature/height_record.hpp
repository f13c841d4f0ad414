#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <pcor/base/note.hpp>

#include "campaign/flight_air.hpp"

namespace pcor::internal {

/// Number of coefficients of a calibration: a0 + a1 t + a2 t^2.
inline constexpr std::size_t calibration_terms = 3;

/// Errors in addition to that of the thermometer: a constant static-pressure bias (hPa), and errors
/// proportional to the static pressure (static-constant), the dynamic pressure (static-qp), the angle of
/// attack times the static pressure (static-alpha, static-attack), and the vapour pressure (humidity-error).
/// The second affects heights only through the temperature.
enum HeightError : Eigen::Index {
  lasting = calibration_terms,
  with_static,
  with_dynamic,
  with_attack,
  with_vapor,
  height_unknowns
};

/// A value for each coefficient of the calibration, followed by one for each `HeightError`.
using HeightUnknowns = Eigen::Matrix<double, height_unknowns, 1>;

/// Means over a few seconds of a flight: GPS height compared with the integral of the hydrostatic equation
/// from the start of the segment.
struct HeightBlock {
  bool starts_segment = false;  ///< the integral restarts: its height is unknown
  double time = 0.0;            ///< middle, s since 1970 UTC
  double length = 0.0;          ///< averaging time, s
  double excess = 0.0;  ///< GPS geopotential height minus integral with the uncorrected temperature, m
  /// Change of the integral for one unit of a0 (K), a1 (1), a2 (1/K), m; then change of `excess` for one unit
  /// of each error: m/hPa; m for an error as large as the static pressure, and as the dynamic pressure; m for
  /// one of the radome ratio, or 1 deg, times the static pressure; last, m for a relative error of 1 of the
  /// vapour pressure.
  HeightUnknowns columns = HeightUnknowns::Zero();
  double east = 0.0;            ///< way flown, m (`WayKnown`)
  double north = 0.0;           ///< m
  double height = 0.0;          ///< geopotential height by GPS, m
  double pressure = 0.0;        ///< corrected static pressure, hPa
  double temperature = 0.0;     ///< uncorrected, degC
  double metres_per_hpa = 0.0;  ///< R_a T/(g p): thickness of a layer of 1 hPa, m/hPa
  double climb = 0.0;           ///< m/s
  std::size_t samples = 0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(starts_segment, time, length, excess, columns, east, north, height, pressure, temperature,
            metres_per_hpa, climb, samples);
  }
};

/// Source of the horizontal displacement of a flight.
enum class WayKnown {
  over_ground,
  through_air,  ///< airspeed and heading
  length        ///< unknown heading: all displacement counts as one direction
};

/// A flight as the fit of temperature sees it.
struct HeightRecord {
  std::string name;
  std::vector<HeightBlock> blocks;
  std::size_t segments = 0;
  std::size_t samples = 0;          ///< those that are in blocks
  std::size_t height_steps = 0;     ///< steps of the GPS height, at which the integral restarts
  std::size_t height_spikes = 0;    ///< samples with excluded GPS height
  std::size_t missing_heights = 0;  ///< samples in the air without GPS height
  std::size_t unknown_ways = 0;     ///< samples without velocity over the ground in a flight that has it
  WayKnown way = WayKnown::over_ground;
  double slope_fraction = 1.0;   ///< fraction of the usual slope of isobars still in `excess`, 0 to 1
  bool returns = false;          ///< ends within 50 km of its start
  double min_temperature = 0.0;  ///< degC
  double max_temperature = 0.0;  ///< degC
  /// Rms of the static pressure by one unit of each of its errors, hPa; zero for the coefficients.
  HeightUnknowns rms_of_unit = HeightUnknowns::Zero();
  /// Stated variance of delta-p of the model, averaged over the samples, hPa2; nullopt if not stated.
  std::optional<double> law_variance{};
  Notes notes;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(name, blocks, segments, samples, height_steps, height_spikes, missing_heights, unknown_ways, way,
            slope_fraction, returns, min_temperature, max_temperature, rms_of_unit, law_variance, notes);
  }
};

struct HeightRecordOptions {
  double min_climb_rate = 0.0;  ///< m/s; slower blocks are excluded, and each climb is a segment
  /// The temperature is computed from a recovery temperature and the Mach number. If delta-p is too large by
  /// the fraction x of the pressure, the temperature is too high by the fraction x R/cp: the ratio of the two
  /// temperatures is (p/(p + q))^(R/cp) for complete recovery.
  bool recovers = false;
  bool has_radome = true;  ///< angle-of-attack errors in units of the radome ratio; otherwise of degrees
};

/// Integrates the hydrostatic equation along a flight (memo eq. 24 in its exact form, geopotential height),
/// after the take-off, with flaps retracted. Restarts after every gap and every step of the GPS height.
///
/// @param steps if not empty, -(R_a/g0) ln(p_i/p_(i-1)) of every record from `pcor process --hydrostatic`,
/// m/K; otherwise computed from pressure and humidity
/// @throws Error if the height is inconsistent with the pressure (`height_problem`), the flight has no
/// temperature, or it neither climbs nor descends by 300 m.
HeightRecord height_record(const FlightAir& air, const std::vector<double>& steps,
                           const HeightRecordOptions& options);

}  // namespace pcor::internal
