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

/// One effect of a model with its coefficients.
///
/// An effect of the catalogue has its `id`; one of the user's own has a `formula`, a place and names for its
/// parameters besides; a surface has knots instead, and its formula is a text for people.
struct ModelEffect {
  std::string id{};
  std::vector<double> parameters{};  ///< in the order of the effect's parameters

  std::vector<std::string> parameter_names{};  ///< of a formula; empty for an effect of the catalogue
  std::string formula{};                       ///< empty for an effect of the catalogue
  std::optional<Surface> surface{};            ///< knots of a surface, which acts at the static ports
  EffectLocation location = EffectLocation::static_defect;  ///< of a formula
  std::string unit{};                                       ///< of a formula's value
  std::string source{};                                     ///< of a formula

  Scaling scaling{};  ///< of an effect of the catalogue

  /// True for effects outside the catalogue: a formula or a surface.
  bool is_formula() const { return !formula.empty(); }
  bool is_surface() const { return surface.has_value(); }
};

/// How the temperature enters delta-p from LAMS: the approaches of the memo. There is no fourth.
enum class LamsApproach {
  simultaneous = 1,     ///< closed form from the recovery temperature
  iterated = 2,         ///< iteration from the recovery temperature
  with_temperature = 3  ///< an ambient temperature measured without any pressure
};

/// How LAMS is mounted and used.
struct LamsMounting {
  double elevation = 0.0;  ///< theta_1, deg above the longitudinal axis
  double azimuth = 0.0;    ///< theta_2, deg to starboard
  LamsApproach approach = LamsApproach::simultaneous;
};

/// The one policy for what physics leaves open. What it does to a sample is told in the quality bits.
struct Policy {
  /// Below this dynamic pressure (hPa) delta-p is multiplied by (q_m/taper_below)^taper_power; 0 for none.
  double taper_below = 0.0;
  double taper_power = 3.0;
  /// Delta-p (hPa) is not less than this, before the taper.
  double minimum = -std::numeric_limits<double>::infinity();
  /// Below this dynamic pressure (hPa) nothing says that air flows: delta-p is missing, but under a taper,
  /// and so are Mach number and airspeed. The default, 18 m/s at sea level, is ten times the 0.2 hPa of noise
  /// that a transducer shows on the ramp; there such a noise is 5 % of the airspeed.
  double min_dynamic_pressure = 2.0;
};

/// The range of a quantity over which the law was fitted. Outside it a sample is flagged.
struct DomainRange {
  std::string quantity{};
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

/// What an aircraft's pressure system is believed to be: its effects with their coefficients, and what else
/// the chain from the recorded values to the air needs.
struct Model {
  std::string name{};
  std::string aircraft{};
  std::vector<ModelEffect> effects{};
  /// Places where an amount of its own is added, a parameter each behind those of the effects, zero: the
  /// derivative by it is that by whatever an effect there gives. Where the model has no use for the
  /// place the amount changes nothing. No model file has them.
  std::vector<EffectLocation> additions{};
  LamsMounting lams;
  RecoveryFactor recovery{{1.0, 0.0, 0.0, 0.0}};
  bool moist = true;  ///< constants of moist air; of dry air where false
  RadomeCalibration attack_radome;
  RadomeCalibration sideslip_radome;
  Policy policy;
  std::vector<DomainRange> domain{};
};

}  // namespace pcor
