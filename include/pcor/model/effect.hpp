#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

#include <pcor/model/quantity.hpp>
#include <pcor/model/scaling.hpp>

namespace pcor {

/// Location in the measurement chain at which an effect acts, from the recorded values to the air. The value
/// of an effect is added to the quantity of its location.
enum class EffectLocation : std::uint8_t {
  static_transducer,
  dynamic_transducer,
  static_line,
  total_line,
  radome,
  attack_ratio,
  attack,
  sideslip,
  temperature,
  recovery,
  ambient_temperature,
  humidity,
  beam_elevation,
  beam_azimuth,
  beam_speed,
  static_defect,
  pitot,
  count
};

inline constexpr std::size_t location_count = static_cast<std::size_t>(EffectLocation::count);

/// Metadata of an effect location: name in model files, unit of the effect, corrected quantity, and
/// instrument component, which several locations may share.
struct EffectLocationInfo {
  std::string_view name;
  std::string_view unit;
  std::string_view adds_to;
  std::string_view component;
};

inline constexpr std::array<EffectLocationInfo, location_count> effect_location_info{{
    {"static-transducer", "hPa", "measured static pressure", "p-transducer"},
    {"dynamic-transducer", "hPa", "measured dynamic pressure", "q-transducer"},
    {"static-line", "hPa", "measured static pressure, and subtracted from the dynamic pressure",
     "static-line"},
    {"total-line", "hPa", "measured dynamic pressure", "pitot"},
    {"radome", "hPa", "radome dynamic pressure", "radome"},
    {"attack-ratio", "1", "radome attack ratio ADIFR/QCR", "radome"},
    {"attack", "deg", "angle of attack", "radome"},
    {"sideslip", "deg", "sideslip", "radome"},
    {"temperature", "K", "recovery temperature", "thermometer"},
    {"recovery", "1", "recovery factor", "thermometer"},
    {"ambient-temperature", "K", "ambient temperature", "thermometer"},
    {"humidity", "hPa", "water vapour pressure", "humidity"},
    {"lams-elevation", "deg", "elevation of the laser beam", "laser"},
    {"lams-azimuth", "deg", "azimuth of the laser beam", "laser"},
    {"lams", "m/s", "airspeed along the laser beam", "laser"},
    {"static", "hPa", "delta-p: added to the static, subtracted from the dynamic pressure", "port"},
    {"pitot", "hPa", "total pressure, and therefore the dynamic pressure", "pitot"},
}};

constexpr const EffectLocationInfo& info_of(EffectLocation location) {
  return effect_location_info[static_cast<std::size_t>(location)];
}

/// Location with the given name, or `EffectLocation::count` if unknown.
constexpr EffectLocation location_named(std::string_view name) {
  for (std::size_t i = 0; i < location_count; ++i) {
    if (effect_location_info[i].name == name) return static_cast<EffectLocation>(i);
  }
  return EffectLocation::count;
}

/// Coefficient of an effect.
struct ParameterInfo {
  std::string_view name;
  std::string_view unit;
  double neutral = 0.0;                                     ///< value at which the effect is zero
  double lower = -std::numeric_limits<double>::infinity();  ///< physical bounds
  double upper = std::numeric_limits<double>::infinity();
  double typical = 0.0;  ///< typical size
  /// True if the coefficient only shapes the effect, such as the Mach number at which the effect starts. Its
  /// neutral value is its typical value; the effect is zero, for any shape, if all other coefficients are
  /// neutral.
  bool shape = false;
  /// Alternative values, padded with 0: of a shape, and of a time constant of an input
  /// (`EffectInfo::memory`). A diagnosis tests all of them, a fit starts at the best one.
  std::array<double, 10> tried{};
  /// Standard uncertainty of the calibration of a reference or of the thermometer, in the unit of the
  /// coefficient. Stated errors include it unless the model states another value. Zero: no uncertainty by
  /// default. Sources: `EffectInfo::source` and `size` of the effect.
  double calibration_uncertainty = 0.0;

  /// True if the value is within the physical bounds; false for NaN.
  constexpr bool allows(double value) const { return value >= lower && value <= upper; }
};

inline constexpr std::size_t parameter_capacity = 3;
inline constexpr std::size_t need_capacity = 4;
inline constexpr std::size_t scaling_capacity = 2;

/// Input of an effect that is computed from earlier samples with a time constant.
struct Memory {
  Quantity of = Quantity::count;  ///< airspeed_rate or wetness; count: no such input
  std::size_t parameter = 0;      ///< index of the coefficient with the time constant, s
};

/// Gas constants of the models in which an effect is meaningful.
enum class GasConstants : std::uint8_t { any, dry, moist };

/// Worked example of an effect: inputs, coefficients and value, from an independent source.
struct EffectExample {
  struct Input {
    Quantity quantity = Quantity::count;
    double value = 0.0;
  };
  std::array<Input, need_capacity> inputs{};
  std::array<double, parameter_capacity> parameters{};
  double value = 0.0;
};

/// Metadata of an effect, read by the help, the documentation, the law tests, the refit and the diagnosis.
///
/// The struct of an effect has `info()`, which returns this metadata, and
///
///     template <class State, class P> static auto value(const State& state, const P* parameters)
///
/// which returns the correction at its location, true minus recorded value, in the unit of the location; or a
/// base of `effects/shared_formulas.hpp`, which has it.
/// `value` is linear in the parameters, except shape parameters, and zero at the neutral parameters. NaN in
/// an input gives NaN.
struct EffectInfo {
  std::string_view id;
  std::string_view title;
  std::string_view family;  ///< group of its alternative shapes and locations, such as lag or attack
  EffectLocation location = EffectLocation::static_defect;
  std::string_view formula;  ///< formula in the language of formula effects; a test compares it with `value`
  std::array<ParameterInfo, parameter_capacity> parameters{};
  std::array<Quantity, need_capacity> needs{Quantity::count, Quantity::count, Quantity::count,
                                            Quantity::count};
  Memory memory{};
  /// Alternative scalings to test; unused entries are empty.
  std::array<Scaling, scaling_capacity> scalings{};
  std::string_view size;         ///< typical size, as text
  std::string_view confounders;  ///< confounded effects
  std::string_view manoeuvre;    ///< manoeuvre that separates it from them
  std::string_view source;
  EffectExample example{};
  GasConstants constants = GasConstants::any;

  constexpr std::size_t parameter_count() const {
    std::size_t n = 0;
    while (n < parameter_capacity && !parameters[n].name.empty()) ++n;
    return n;
  }
  constexpr std::size_t need_count() const {
    std::size_t n = 0;
    while (n < need_capacity && needs[n] != Quantity::count) ++n;
    return n;
  }
  constexpr std::size_t scaling_count() const {
    std::size_t n = 0;
    while (n < scaling_capacity && !scalings[n].is_none()) ++n;
    return n;
  }
};

/// Instrument component of an effect. A clock is a separate component, although it shifts the input of a
/// location.
constexpr std::string_view component_of(const EffectInfo& info) {
  return info.family == "clock" ? info.family : info_of(info.location).component;
}

}  // namespace pcor
