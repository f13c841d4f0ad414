#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct PitotAngle {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "pitot-angle";
    info.title = "loss of total pressure where the flow meets the pitot at an angle";
    info.family = "flow angle";
    info.location = EffectLocation::pitot;
    info.formula = "k * dynamic_pressure * ((attack - axis)^2 + sideslip^2)";
    info.parameters[0] = {"k", "1/deg2", 0.0, 0.0, 0.01, 0.0001};
    info.parameters[1] = {"axis", "deg", 0.0, -20.0, 20.0, 0.0, true, {-2.0, 2.0, 4.0}};
    info.needs = {Quantity::dynamic_pressure, Quantity::attack, Quantity::sideslip, Quantity::count};
    info.size =
        "below 0.2 % of q at 5 deg, below 1 % at 10 deg, always low: -0.12 and -0.6 hPa (C-130); axis is the "
        "angle of attack at which the pitot points into the wind";
    info.confounders = "static-alpha-quad, static-beta-even, lams-elevation, qcr-angle";
    info.manoeuvre = "pitch and yaw manoeuvres to large angles; a second pitot pair";
    info.source = "Cooper (2012), footnote 3";
    info.example.inputs[0] = {Quantity::dynamic_pressure, 70.0};
    info.example.inputs[1] = {Quantity::attack, 6.0};
    info.example.inputs[2] = {Quantity::sideslip, 3.0};
    info.example.parameters = {0.0001, 2.0};
    info.example.value = 0.175;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    const auto attack = state[Quantity::attack] - parameter[1];
    const auto& sideslip = state[Quantity::sideslip];
    return parameter[0] * (state[Quantity::dynamic_pressure] * (attack * attack + sideslip * sideslip));
  }
};

}  // namespace pcor::effects
