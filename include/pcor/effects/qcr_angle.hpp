#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct QcrAngle {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "qcr-angle";
    facts.title = "loss of radome dynamic pressure at flow angles";
    facts.family = "flow angle";
    facts.where = Where::radome;
    facts.formula = "attack_loss * attack^2 + sideslip_loss * sideslip^2";
    facts.parameters[0] = {"attack_loss", "hPa/deg2", 0.0, 0.0, 2.0, 0.0273};
    facts.parameters[1] = {"sideslip_loss", "hPa/deg2", 0.0, 0.0, 2.0, 0.0562};
    facts.needs = {Quantity::attack, Quantity::sideslip, Quantity::count, Quantity::count};
    facts.size =
        "GV 0.44 hPa at 4 deg of attack, 0.9 hPa at 4 deg of sideslip; it moves delta-p only through the "
        "radome ratios";
    facts.look_alikes = "adif-drift, pitot-angle";
    facts.manoeuvre = "pitch and yaw manoeuvres";
    facts.source = "NCAR processing algorithms sec. 4.3";
    facts.example.inputs[0] = {Quantity::attack, 4.0};
    facts.example.inputs[1] = {Quantity::sideslip, 2.0};
    facts.example.parameters = {0.0273, 0.0562};
    facts.example.value = 0.6616;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    const auto& attack = state[Quantity::attack];
    const auto& sideslip = state[Quantity::sideslip];
    return parameter[0] * (attack * attack) + parameter[1] * (sideslip * sideslip);
  }
};

}  // namespace pcor::effects
