#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct PitotAngle {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "pitot-angle";
    facts.title = "loss of total pressure where the flow meets the pitot at an angle";
    facts.family = "flow angle";
    facts.where = Where::pitot;
    facts.formula = "k * dynamic_pressure * ((attack - axis)^2 + sideslip^2)";
    facts.parameters[0] = {"k", "1/deg2", 0.0, 0.0, 0.01, 0.0001};
    facts.parameters[1] = {"axis", "deg", 0.0, -20.0, 20.0, 0.0, true, {-2.0, 2.0, 4.0}};
    facts.needs = {Quantity::dynamic_pressure, Quantity::attack, Quantity::sideslip, Quantity::count};
    facts.size =
        "below 0.2 % of q at 5 deg, below 1 % at 10 deg, always low: -0.12 and -0.6 hPa (C-130); axis is the "
        "angle of attack at which the pitot points into the wind";
    facts.look_alikes = "static-alpha-quad, static-beta-even, lams-elevation, qcr-angle";
    facts.manoeuvre = "pitch and yaw manoeuvres to large angles; a second pitot pair";
    facts.source = "Cooper (2012), footnote 3";
    facts.example.inputs[0] = {Quantity::dynamic_pressure, 70.0};
    facts.example.inputs[1] = {Quantity::attack, 6.0};
    facts.example.inputs[2] = {Quantity::sideslip, 3.0};
    facts.example.parameters = {0.0001, 2.0};
    facts.example.value = 0.175;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    const auto attack = state[Quantity::attack] - parameter[1];
    const auto& sideslip = state[Quantity::sideslip];
    return parameter[0] * (state[Quantity::dynamic_pressure] * (attack * attack + sideslip * sideslip));
  }
};

}  // namespace pcor::effects
