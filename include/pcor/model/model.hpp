#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <pcor/model/effect.hpp>
#include <pcor/model/quantity.hpp>
#include <pcor/model/surface.hpp>
#include <pcor/physics/flow_angles.hpp>
#include <pcor/physics/recovery_factor.hpp>

namespace pcor {

/// Effect of a model with its coefficients.
///
/// An effect of the catalogue has an `id`; a user-defined effect also has a `formula`, a location and names
/// of its parameters. A surface has knots instead, and its formula is a text for people.
struct ModelEffect {
  std::string id{};
  std::vector<double> parameters{};  ///< values, in the order of the effect's parameters

  std::vector<std::string>
      parameter_names{};             ///< names for a formula effect; empty for an effect of the catalogue
  std::string formula{};             ///< empty for an effect of the catalogue
  std::optional<Surface> surface{};  ///< knots of a surface, which acts at the static ports
  EffectLocation location = EffectLocation::static_defect;  ///< location of a formula effect
  std::string unit{};                                       ///< unit of a formula effect
  std::string source{};                                     ///< source of a formula effect

  Scaling scaling{};  ///< scaling of an effect of the catalogue

  /// True for effects outside the catalogue: a formula or a surface.
  bool is_formula() const { return !formula.empty(); }
  bool is_surface() const { return surface.has_value(); }
};

/// Treatment of the temperature in delta-p from LAMS: the three approaches of the memo.
enum class LamsApproach {
  simultaneous = 1,     ///< closed form from the recovery temperature
  iterated = 2,         ///< iteration from the recovery temperature
  with_temperature = 3  ///< an ambient temperature measured without pressure
};

/// Mounting and approach of LAMS.
struct LamsMounting {
  double elevation = 0.0;  ///< theta_1, deg above the longitudinal axis
  double azimuth = 0.0;    ///< theta_2, deg to starboard
  LamsApproach approach = LamsApproach::simultaneous;
};

/// Limits of the corrections. Their application to a sample is recorded in the quality bits.
struct Policy {
  /// Below this dynamic pressure (hPa) delta-p is multiplied by (q_m/taper_below)^taper_power; 0: no taper.
  double taper_below = 0.0;
  double taper_power = 3.0;
  /// Minimum of delta-p (hPa), before the taper.
  double minimum = -std::numeric_limits<double>::infinity();
  /// Minimum dynamic pressure (hPa) for detectable airflow: below it, delta-p (without a taper), Mach number
  /// and airspeed are missing. The default, 18 m/s at sea level, is ten times the 0.2 hPa of noise of a
  /// transducer on the ramp, so that this noise is 5 % of the airspeed.
  double min_dynamic_pressure = 2.0;
};

/// Range of a quantity over which the model was fitted. Samples outside it are flagged.
struct DomainRange {
  std::string quantity{};
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

/// Model of an aircraft's pressure system: effects with their coefficients, and other inputs of the chain
/// from the recorded values to the air.
struct Model {
  std::string name{};
  std::string aircraft{};
  std::vector<ModelEffect> effects{};
  /// Locations with an additional amount, one parameter each after those of the effects, zero: the derivative
  /// with respect to it is that of any effect at that location. At the static ports the policy limits the sum
  /// of the effects, and the amount adds to its minimum. An amount at a location that the model does not use
  /// has no effect. Not stored in model files.
  std::vector<EffectLocation> additions{};
  LamsMounting lams;
  RecoveryFactor recovery{{1.0, 0.0, 0.0, 0.0}};  ///< default 1, of no real thermometer: 0.95 to 0.99
  bool moist = true;                              ///< true: constants of moist air; false: of dry air
  RadomeCalibration attack_radome;
  RadomeCalibration sideslip_radome;
  Policy policy;
  std::vector<DomainRange> domain{};
};

}  // namespace pcor
