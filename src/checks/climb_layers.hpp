#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <pcor/base/note.hpp>

#include "campaign/flight_air.hpp"
#include "numerics/least_squares.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {

/// Selection of climbs and descents for layers, and uncertainty of pressure and height: standard deviations.
struct LayerOptions {
  double min_climb_rate = 2.0;   ///< m/s up or down, over 30 s
  double min_thickness = 500.0;  ///< m: thinner climbs have too large errors
  double thickness = 1000.0;     ///< m: a longer climb is divided into layers of about this thickness

  /// Rms error of one GPS height, m. NaN: rms deviation from the height of the pressure within five
  /// minutes of the flight, at least 0.15 m, the error of current differential GPS; 1 m, the error of GPS in
  /// 2004, if five minutes without a gap are not available.
  double height_noise = nan;
  double pressure_noise = 0.03;  ///< rms error of one pressure, hPa
  double static_bias = 0.3;      ///< standard error of delta-p that is constant over height, hPa
  double static_change = 0.1;    ///< standard error of delta-p that differs between heights, hPa
  /// Standard deviation of the slope of the pressure surfaces in any direction, m per 100 km. NaN: 5, half
  /// of the upper limit of the memo, or the slope found along level legs if it is larger.
  double gradient = nan;
};

/// Standard errors of T_p, K, by cause. The sums telescope: noise counts at both ends of a layer, not in
/// between, and does not decrease with the number of samples (the memo assumes that it does).
struct LayerErrors {
  double height_noise = 0.0;    ///< noise of the GPS height at both ends
  double pressure_noise = 0.0;  ///< noise of the pressure at both ends
  double static_bias = 0.0;     ///< constant error of delta-p, which partly cancels between the two ends
  double static_change = 0.0;   ///< error of delta-p that differs between both ends
  double gradient = 0.0;        ///< slope of the pressure surfaces along the track

  double total() const {
    return std::sqrt(height_noise * height_noise + pressure_noise * pressure_noise +
                     static_bias * static_bias + static_change * static_change + gradient * gradient);
  }
};

/// Layer of air through which the aircraft climbed or descended (as in the table of the memo's Determining
/// the Air Temperature).
struct Layer {
  std::size_t climb = 0;  ///< index of its climb or descent in the flight
  std::size_t first = 0;  ///< records at its ends
  std::size_t last = 0;
  double begin = 0.0;           ///< s since 1970 UTC
  double end = 0.0;             ///< s since 1970 UTC
  double height_begin = 0.0;    ///< geopotential, m
  double height_end = 0.0;      ///< geopotential, m
  double pressure_begin = 0.0;  ///< hPa
  double pressure_end = 0.0;    ///< hPa
  double east = 0.0;            ///< distance flown, m
  double north = 0.0;           ///< distance flown, m
  double s1 = 0.0;              ///< sum of (R_a/g) ln(p_i/p_(i-1)), m/K
  double s2 = 0.0;              ///< sum of z_i - z_(i-1), m
  double s3 = 0.0;              ///< sum of (z_i - z_(i-1))/T, m/K
  LayerErrors errors{};

  /// T_p = -S2/S1, K: temperature from height and pressure. The memo prints the reciprocal.
  double hydrostatic_temperature() const { return -s2 / s1; }
  /// T_m = S2/S3, K: temperature of the thermometer. Both are harmonic means over the height.
  double measured_temperature() const { return s2 / s3; }
  /// T_p - T_m, K: correction required by the thermometer.
  double difference() const { return hydrostatic_temperature() - measured_temperature(); }
};

/// Layers of a flight, in the order of time.
struct FlightLayers {
  std::string flight;
  LayerOptions uncertainty{};  ///< options, and the estimated errors of this flight
  std::vector<Layer> layers{};
  Notes notes{};  ///< notes for the user, one sentence each
};

/// Finds the climbs and descents of a flight and divides them into layers of equal thickness. Heights are
/// geopotential and gravity is standard gravity, which is equivalent to R_a/g(latitude, height) with
/// geometric heights. A sum ends at a gap in time, a missing value, a sample not in flight, and at a step of
/// the GPS height relative to the pressure by more than 2 m (or eight times its typical step) within a
/// sample.
/// @param air with temperatures and GPS heights
/// @param options positive thicknesses and rates, and standard deviations that are not negative
FlightLayers find_layers(const FlightAir& air, const LayerOptions& options = {});

/// Thermometer correction implied by layers: the line that minimizes
///
///     chi2 = sum (T_m + c0 + c1 (T_m - centre) - T_p)^2 / sigma^2,
///
/// or a constant if there are too few layers for a line, with the full covariance instead of sigma^2: layers
/// of one climb share an end, and layers of one flight the slope of the pressure surfaces. Four fifths of its
/// variance are assigned to the flight, the rest to each climb, so climbs and descents on one heading cancel
/// most of it (iii of the memo's steps against the gradient). An error of delta-p that differs between
/// heights is the same for all flights at one height.
struct LayerFit {
  std::size_t layers = 0;
  /// Correction of the thermometer at the mean temperature of the layers, K, by the line or the constant.
  Estimate offset{nan, nan};
  double centre = nan;       ///< K: the temperature at which the errors of c0 and c1 are independent; may be
                             ///< outside the layers
  Estimate c0{nan, nan};     ///< correction at the centre, K; NaN, like c1, with fewer than three layers or a
                             ///< range below 5 K
  Estimate c1{nan, nan};     ///< K per K
  double error_scale = 1.0;  ///< factor on all errors that reduces chi2 per degree of freedom to at most 1

  /// Correction of the line at a temperature, K: at 273.15 K it is the c0 of a line in degC, at 0 K the c0 of
  /// the memo, whose temperatures are absolute.
  Estimate correction_at(double temperature) const {
    return {c0.value + c1.value * (temperature - centre),
            std::hypot(c0.error, c1.error * (temperature - centre))};
  }
};

/// Fit over the layers of some flights. NaN if there are no layers.
LayerFit fit_layers(const std::vector<FlightLayers>& flights);

}  // namespace pcor::internal
