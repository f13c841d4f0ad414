#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <utility>
#include <vector>

#include <pcor/realtime/chain.hpp>

namespace pcor {

/// Which delta-p corrects the pressures.
enum class CorrectWith { model, lams };

/// Arguments of the stages: a chain, and the source of delta-p for the correction.
struct Correction {
  const Chain& chain;
  CorrectWith with = CorrectWith::model;
};

/// Stages of a chain. Each declares its inputs and outputs, and computes them for one sample, or one pack of
/// samples, without state. A sample loop orders them among user-defined functors; a batch runs those needed
/// for the requested outputs. Stages without outputs for a chain are skipped.
///
/// To add one: write it here, name it in `Stages`, and what it writes in `Quantity`.

using Quantities = std::vector<Quantity>;

inline Quantities joined(std::initializer_list<Quantities> lists) {
  Quantities all;
  for (const Quantities& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

/// Subset of `quantities` that is recorded or derived.
inline Quantities known(const Chain& chain, std::initializer_list<Quantity> quantities) {
  Quantities known;
  for (const Quantity quantity : quantities) {
    if (chain.recorded(quantity) || chain.needs(quantity)) known.push_back(quantity);
  }
  return known;
}

/// Inputs of temperature and humidity: recorded quantities, and inputs of their effects. Calibration effects
/// of an ambient temperature use the temperature of the stage that computes it.
inline Quantities read_of_air(const Chain& chain) {
  Quantities read =
      joined({chain.read_at(EffectLocation::temperature), chain.read_at(EffectLocation::recovery),
              chain.read_at(EffectLocation::humidity), chain.read_at(EffectLocation::ambient_temperature)});
  read.erase(std::remove(read.begin(), read.end(), Quantity::ambient_temperature), read.end());
  for (const Quantity recorded : {Quantity::recovery_temperature, Quantity::ambient_temperature,
                                  Quantity::vapor_pressure, Quantity::dew_point, Quantity::frost_point}) {
    if (chain.recorded(recorded)) read.push_back(recorded);
  }
  return read;
}

/// Recorded inputs of the airspeed of the model, and of the angle of the beam to the wind.
inline Quantities read_of_airspeed(const Chain& chain) {
  Quantities read;
  for (const Quantity input : chain.inputs()) {
    if (is_humidity(input) || chain.needs(input)) read.push_back(input);
  }
  return read;
}

/// Inputs of the airspeed from LAMS: the speed along the beam and the angle of the beam to the wind.
inline Quantities read_of_beam(const Chain& chain) {
  return joined({known(chain, {Quantity::lams_airspeed, Quantity::attack, Quantity::sideslip}),
                 chain.read_at(EffectLocation::beam_speed), chain.read_at(EffectLocation::beam_elevation),
                 chain.read_at(EffectLocation::beam_azimuth)});
}

/// Pressures at the ports, and the inputs of the effects: `Chain::correct_inputs`.
struct MeasuredQuantities {
  static Quantities reads(const Correction& correction) {
    const Chain& chain = correction.chain;
    Quantities read = writes_in_place(chain);
    for (const Quantity input : chain.inputs()) {
      if (chain.needs(input)) read.push_back(input);
    }
    for (const Rate& each : rates) {
      if (chain.derives(each.rate)) read.push_back(each.rate);
    }
    for (const Quantity given : {Quantity::airspeed_rate, Quantity::wetness, Quantity::time}) {
      if (chain.needs(given)) read.push_back(given);
    }
    return read;
  }

  static Quantities writes(const Correction& correction) {
    const Chain& chain = correction.chain;
    Quantities written = writes_in_place(chain);
    written.insert(written.end(), {Quantity::port_static_pressure, Quantity::port_dynamic_pressure});
    for (const Quantity derived :
         {Quantity::dynamic_ratio, Quantity::mach, Quantity::attack_ratio, Quantity::sideslip_ratio,
          Quantity::attack, Quantity::sideslip, Quantity::vapor_pressure}) {
      if (chain.derives(derived)) written.push_back(derived);
    }
    return written;
  }

  template <class S, class P, class Flags>
  static void compute(const Correction& correction, State<S>& state, const P* parameters, Flags& flags) {
    correction.chain.correct_inputs(state, parameters, flags);
  }

  /// Recorded quantities that effects modify.
  static Quantities writes_in_place(const Chain& chain) {
    Quantities completed;
    const auto completes = [&](EffectLocation location, Quantity quantity) {
      if (chain.acts(location) && chain.recorded(quantity)) completed.push_back(quantity);
    };
    completes(EffectLocation::radome, Quantity::radome_dynamic_pressure);
    completes(EffectLocation::attack, Quantity::attack);
    completes(EffectLocation::sideslip, Quantity::sideslip);
    completes(EffectLocation::ambient_temperature, Quantity::ambient_temperature);
    return completed;
  }

  /// Recorded quantities from which `quantity`, recorded or derived, is computed.
  static Quantities sources(const Chain& chain, Quantity quantity) {
    const auto of = [&chain](Quantity other) { return sources(chain, other); };
    if (chain.recorded(quantity)) return {quantity};
    for (const Rate& each : rates) {
      if (each.rate == quantity) return of(each.quantity);
    }
    switch (quantity) {
      case Quantity::dynamic_ratio:
      case Quantity::mach:
        return {Quantity::static_pressure, Quantity::dynamic_pressure};
      case Quantity::airspeed_rate:
        return read_of_airspeed(chain);
      case Quantity::wetness:
        return {Quantity::liquid_water};
      case Quantity::vapor_pressure:
        return joined(
            {{Quantity::static_pressure}, known(chain, {Quantity::dew_point, Quantity::frost_point})});
      case Quantity::attack:
      case Quantity::sideslip:
        return joined({of(quantity == Quantity::attack ? Quantity::attack_ratio : Quantity::sideslip_ratio),
                       chain.needs(Quantity::mach) ? of(Quantity::mach) : Quantities{}});
      case Quantity::attack_ratio:
        return {Quantity::attack_differential_pressure, Quantity::radome_dynamic_pressure};
      case Quantity::sideslip_ratio:
        return {Quantity::sideslip_differential_pressure, Quantity::radome_dynamic_pressure};
      default:
        return {};
    }
  }
};

/// Delta-p of the model, hPa: `Chain::static_defect`.
struct StaticDefect {
  static Quantities reads(const Correction& correction) {
    return joined({{Quantity::static_pressure, Quantity::dynamic_pressure},
                   correction.chain.read_at(EffectLocation::static_defect)});
  }
  static Quantities writes(const Correction&) { return {Quantity::static_defect}; }

  template <class S, class P, class Flags>
  static void compute(const Correction& correction, State<S>& state, const P* parameters, Flags& flags) {
    state[Quantity::static_defect] = correction.chain.static_defect(state, parameters, flags);
  }
};

/// Delta-p from LAMS, hPa: `Chain::lams_static_defect`.
struct LamsStaticDefect {
  static Quantities reads(const Correction& correction) {
    return joined({{Quantity::port_static_pressure, Quantity::port_dynamic_pressure},
                   read_of_beam(correction.chain),
                   read_of_air(correction.chain)});
  }
  static Quantities writes(const Correction& correction) {
    return correction.chain.has_lams() ? Quantities{Quantity::lams_static_defect} : Quantities{};
  }

  template <class S, class P, class Flags>
  static void compute(const Correction& correction, State<S>& state, const P* parameters, Flags& flags) {
    state[Quantity::lams_static_defect] = correction.chain.lams_static_defect(state, parameters, flags);
  }
};

/// True if the laser has its lock: its delta-p differs from delta-p of the model, or from zero, by at most
/// three tenths of the dynamic pressure (`max_lams_departure`), which is more than any static defect. The
/// model may be wrong, as with an iced port, and does not count if it is impossible (`is_impossible_defect`);
/// at a low dynamic pressure a true defect may exceed the limit.
/// False if the laser has no delta-p.
template <class S>
auto has_laser_lock(const State<S>& state) {
  const S& defect = state[Quantity::lams_static_defect];
  const S& model = state[Quantity::static_defect];
  const auto is_impossible = is_impossible_defect(model, state[Quantity::port_dynamic_pressure]);
  const S departure = defect - select(is_impossible, missing<S>(), model);
  const S limit = S(2.0 * max_lams_departure) * state[Quantity::port_dynamic_pressure];
  return (departure <= limit && departure >= -limit) || (defect <= limit && defect >= -limit);
}

/// Corrected static and dynamic pressure, hPa: `Chain::correct`, with delta-p of the model, or with that of
/// LAMS if the laser has its lock (`has_laser_lock`); the quality bit `corrected_with_lams` marks the latter.
struct CorrectedPressures {
  static Quantities reads(const Correction& correction) {
    Quantities read{Quantity::port_static_pressure, Quantity::port_dynamic_pressure, Quantity::static_defect};
    if (correction.with == CorrectWith::lams) read.push_back(Quantity::lams_static_defect);
    return read;
  }
  static Quantities writes(const Correction&) {
    return {Quantity::corrected_static_pressure, Quantity::corrected_dynamic_pressure};
  }

  template <class S, class P, class Flags>
  static void compute(const Correction& correction, State<S>& state, const P*, Flags& flags) {
    S defect = state[Quantity::static_defect];
    if (correction.with == CorrectWith::lams) {
      const auto has_lock = has_laser_lock(state);
      flags.set(has_lock, Quality::corrected_with_lams);
      defect = select(has_lock, state[Quantity::lams_static_defect], defect);
    }
    correction.chain.correct(state, defect, flags);
  }
};

/// Humidity, Mach number, ambient temperature (K) and true airspeed (m/s) from the corrected pressures:
/// `Chain::air`.
struct AirState {
  static Quantities reads(const Correction& correction) {
    return joined({{Quantity::dynamic_pressure, Quantity::corrected_static_pressure,
                    Quantity::corrected_dynamic_pressure},
                   read_of_air(correction.chain)});
  }
  static Quantities writes(const Correction& correction) {
    Quantities written{Quantity::humidity, Quantity::corrected_mach};
    if (correction.chain.has_temperature()) written.push_back(Quantity::corrected_airspeed);
    if (correction.chain.derives_temperature()) written.push_back(Quantity::ambient_temperature);
    return written;
  }

  template <class S, class P, class Flags>
  static void compute(const Correction& correction, State<S>& state, const P* parameters, Flags& flags) {
    correction.chain.air(state, parameters, flags);
  }
};

/// Temperature (K) and dynamic pressure (hPa) from LAMS and the corrected pressures: `Chain::lams_air`. NaN,
/// with the bit `lams_missing`, without lock (`has_laser_lock`). Without a thermometer the lock is unknown;
/// the temperature, which does not need one, is then kept within a fifth (40 to 60 K) of that of the standard
/// atmosphere up to 20 km.
struct LamsAir {
  static Quantities reads(const Correction& correction) {
    return joined({{Quantity::corrected_static_pressure, Quantity::corrected_mach, Quantity::humidity,
                    Quantity::ambient_temperature, Quantity::port_dynamic_pressure, Quantity::static_defect,
                    Quantity::lams_static_defect},
                   read_of_beam(correction.chain)});
  }
  static Quantities writes(const Correction& correction) {
    if (!correction.chain.has_lams()) return {};
    return {Quantity::lams_temperature, Quantity::lams_dynamic_pressure};
  }

  template <class S, class P, class Flags>
  static void compute(const Correction& correction, State<S>& state, const P* parameters, Flags& flags) {
    correction.chain.lams_air(state, parameters, flags);
    const auto has_lock = has_laser_lock(state);
    flags.set(!has_lock, Quality::lams_missing);
    const S p = state[Quantity::corrected_static_pressure];
    const S tropospheric = power(p / S(1013.25), 0.190263);
    const S tropopause(216.65 / 288.15);
    const S standard = S(288.15) * select(tropospheric < tropopause, tropopause, tropospheric);
    S& temperature = state[Quantity::lams_temperature];
    const auto is_usual = temperature >= S(0.8) * standard && temperature <= S(1.2) * standard;
    const auto is_kept = has_lock || (is_missing(state[Quantity::lams_static_defect]) && is_usual);
    temperature = select(is_kept, temperature, missing<S>());
    S& pressure = state[Quantity::lams_dynamic_pressure];
    pressure = select(has_lock, pressure, missing<S>());
  }
};

template <class... Stage>
struct StageList {
  static constexpr std::size_t count = sizeof...(Stage);

  /// Calls `visit` with every stage, in their order.
  template <class Visit>
  static void each(const Visit& visit) {
    (visit(Stage{}), ...);
  }
};

/// All stages, in an order in which the inputs of each precede it.
using Stages =
    StageList<MeasuredQuantities, StaticDefect, LamsStaticDefect, CorrectedPressures, AirState, LamsAir>;

}  // namespace pcor
