#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct QcrAngle {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "qcr-angle";
    info.title = "loss of radome dynamic pressure at flow angles";
    info.family = "flow angle";
    info.location = EffectLocation::radome;
    info.formula = "attack_loss * attack^2 + sideslip_loss * sideslip^2";
    info.parameters[0] = {"attack_loss", "hPa/deg2", 0.0, 0.0, 2.0, 0.0273};
    info.parameters[1] = {"sideslip_loss", "hPa/deg2", 0.0, 0.0, 2.0, 0.0562};
    info.needs = {Quantity::attack, Quantity::sideslip, Quantity::count, Quantity::count};
    info.size =
        "GV 0.44 hPa at 4 deg of attack, 0.9 hPa at 4 deg of sideslip; it moves delta-p only through the "
        "radome ratios";
    info.confounders = "adif-drift, pitot-angle";
    info.manoeuvre = "pitch and yaw manoeuvres";
    info.source = "NCAR processing algorithms sec. 4.3";
    info.example.inputs[0] = {Quantity::attack, 4.0};
    info.example.inputs[1] = {Quantity::sideslip, 2.0};
    info.example.parameters = {0.0273, 0.0562};
    info.example.value = 0.6616;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    const auto& attack = state[Quantity::attack];
    const auto& sideslip = state[Quantity::sideslip];
    return parameter[0] * (attack * attack) + parameter[1] * (sideslip * sideslip);
  }
};

}  // namespace pcor::effects
