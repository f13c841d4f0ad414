#pragma once

#include <vector>

#include "diagnose/manoeuvres/flown.hpp"
#include "diagnose/manoeuvres/statistics.hpp"

namespace pcor::internal::manoeuvres {

/// The air at some height.
struct AirAt {
  double pressure = 0.0;     ///< hPa
  double temperature = 0.0;  ///< K
  double humidity = 0.0;     ///< vapour pressure over pressure, 1
};

/// The air that some flights met: the medians of temperature and humidity at every pressure, in hydrostatic
/// balance.
///
/// Between the pressures of the profile the virtual temperature is linear in ln p, for which the balance
/// dz = -(R T_v/g) d ln p has a closed solution. Heights are those of the GPS in the median; where no
/// altitude was recorded, they are those of the standard atmosphere at the lowest level.
class Atmosphere {
 public:
  explicit Atmosphere(const Flown& flown);

  AirAt at(double height) const;

  /// m, at a pressure in hPa.
  double height_of(double pressure) const;

  bool has_altitude() const { return has_altitude_; }

 private:
  struct Node {
    double log_pressure;
    double virtual_temperature;  // K
    double gradient;             // to the next node, K for a unit of ln p
    double height;               // m
  };

  Profile temperature_;
  Profile humidity_;
  std::vector<Node> nodes_;  // upwards; below the first and above the last the temperature is constant
  bool has_altitude_ = false;
};

}  // namespace pcor::internal::manoeuvres
