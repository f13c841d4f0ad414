#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

#include <pcor/model/quantity.hpp>
#include <pcor/model/scaling.hpp>

namespace pcor {

/// Where in the instrument an effect acts, from what was recorded to the air. The value of an effect
/// is added to the quantity of its place.
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

/// A stage where something acts: its name in model files, the unit of what acts there, what that is added to,
/// and the place in the instrument that is to be looked at, which stages may share.
struct EffectLocationInfo {
  std::string_view name;
  std::string_view unit;
  std::string_view adds_to;
  std::string_view place;
};

inline constexpr std::array<EffectLocationInfo, location_count> effect_location_info{{
    {"static-transducer", "hPa", "measured static pressure", "p-transducer"},
    {"dynamic-transducer", "hPa", "measured dynamic pressure", "q-transducer"},
    {"static-line", "hPa", "measured static pressure, and taken from the dynamic pressure", "static-line"},
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
    {"static", "hPa", "delta-p: added to the static, taken from the dynamic pressure", "port"},
    {"pitot", "hPa", "total pressure, and so the dynamic pressure", "pitot"},
}};

constexpr const EffectLocationInfo& info_of(EffectLocation location) {
  return effect_location_info[static_cast<std::size_t>(location)];
}

/// The place called `name`, or `EffectLocation::count` where there is none.
constexpr EffectLocation location_named(std::string_view name) {
  for (std::size_t i = 0; i < location_count; ++i) {
    if (effect_location_info[i].name == name) return static_cast<EffectLocation>(i);
  }
  return EffectLocation::count;
}

/// A coefficient of an effect.
struct ParameterInfo {
  std::string_view name;
  std::string_view unit;
  double neutral = 0.0;                                     ///< the value at which the effect is absent
  double lower = -std::numeric_limits<double>::infinity();  ///< bounds of what physics allows
  double upper = std::numeric_limits<double>::infinity();
  double typical = 0.0;  ///< size met in practice
  /// True where it only shapes the effect, as the Mach number from which the effect acts does. It is neutral
  /// at its typical value, and the effect is absent, whatever the shape, when all others are neutral.
  bool shape = false;
  /// Other values that nature may have, and 0 behind them: of a shape, and of a time over which a need is
  /// found (`EffectInfo::memory`). A diagnosis tries them all, a fit begins at the best of them.
  std::array<double, 10> tried{};
  /// Standard uncertainty of the calibration of a reference or of the thermometer, in the unit of the
  /// coefficient. Stated errors include it unless the model states another value. Zero: no doubt by default.
  /// Sources: `EffectInfo::source` and `size` of the effect.
  double doubt = 0.0;
};

inline constexpr std::size_t parameter_capacity = 3;
inline constexpr std::size_t need_capacity = 4;
inline constexpr std::size_t scaling_capacity = 2;

/// A need of an effect that is found over a time, which one of its coefficients says.
struct Memory {
  Quantity of = Quantity::count;  ///< airspeed_rate or wetness; or nothing is remembered
  std::size_t parameter = 0;      ///< the number of the coefficient, in s
};

/// The gas constants of a model in which an effect has a meaning.
enum class GasConstants : std::uint8_t { any, dry, moist };

/// A worked example of an effect: its inputs, coefficients and value, from outside this program.
struct EffectExample {
  struct Input {
    Quantity quantity = Quantity::count;
    double value = 0.0;
  };
  std::array<Input, need_capacity> inputs{};
  std::array<double, parameter_capacity> parameters{};
  double value = 0.0;
};

/// All that is known of an effect beside its formula in code. The help, the documentation, the law tests, the
/// refit and the diagnosis read it.
///
/// An effect is a type with `static constexpr EffectInfo facts()` and
///
///     template <class State, class P> static auto value(const State& state, const P* parameters)
///
/// which gives what is added at its place: the correction, which brings what was recorded to what is true.
/// The value is linear in its parameters, but for those that shape it, and zero at the neutral ones.
struct EffectInfo {
  std::string_view id;
  std::string_view title;
  std::string_view family;  ///< what it shares with its other shapes and places, such as lag or attack
  EffectLocation location = EffectLocation::static_defect;
  std::string_view formula;  ///< in the language of formula effects; a test holds it against `value`
  std::array<ParameterInfo, parameter_capacity> parameters{};
  std::array<Quantity, need_capacity> needs{Quantity::count, Quantity::count, Quantity::count,
                                            Quantity::count};
  Memory memory{};
  std::array<Scaling, scaling_capacity> scalings{};  ///< other ones that nature may have; behind them none
  std::string_view size;                             ///< how large it is met, in words
  std::string_view look_alikes;                      ///< effects that data easily confuse with it
  std::string_view manoeuvre;                        ///< what separates it from them
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

/// The place in the instrument that an effect belongs to. A clock is no stage, but shifts one.
constexpr std::string_view place_of(const EffectInfo& info) {
  return info.family == "clock" ? info.family : info_of(info.location).place;
}

}  // namespace pcor
