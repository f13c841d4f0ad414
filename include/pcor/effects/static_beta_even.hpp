#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct StaticBetaEven {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "static-beta-even";
    facts.title = "static-port error with sideslip, ports joined left to right";
    facts.family = "sideslip";
    facts.where = Where::static_defect;
    facts.formula = "b2 * sideslip^2 * static_pressure";
    facts.parameters[0] = {"b2", "1/deg2", 0.0, -0.02, 0.02, -2e-5};
    facts.needs = {Quantity::sideslip, Quantity::static_pressure, Quantity::count, Quantity::count};
    facts.scalings[0] = {-1, 1};  // with q instead of p
    facts.size = "estimated 1e-5 to 4e-5 /deg2: -0.1 to -0.4 hPa at 4 deg";
    facts.look_alikes = "pitot-angle, lams-azimuth";
    facts.manoeuvre = "yaw manoeuvre, steady-heading sideslip";
    facts.source = "Cooper (2012), text after eq. 20";
    facts.example.inputs[0] = {Quantity::sideslip, 4.0};
    facts.example.inputs[1] = {Quantity::static_pressure, 700.0};
    facts.example.parameters = {-2e-5};
    facts.example.value = -0.224;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] *
           (state[Quantity::sideslip] * state[Quantity::sideslip] * state[Quantity::static_pressure]);
  }
};

}  // namespace pcor::effects
