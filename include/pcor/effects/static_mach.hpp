#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct StaticMach {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "static-mach";
    facts.title = "static-port error with the Mach number";
    facts.family = "Mach number";
    facts.where = Where::static_defect;
    facts.formula = "m1 * mach * static_pressure";
    facts.parameters[0] = {"m1", "1", 0.0, -2.0, 2.0, 0.03};
    facts.needs = {Quantity::mach, Quantity::static_pressure, Quantity::count, Quantity::count};
    facts.size = "C-130 0.015 to 0.037; GV -0.06, nearly cancelled by the other powers";
    facts.look_alikes =
        "static-qp, static-mach2, static-mach3, lams-scale, temp-offset, recovery-factor, qcf-gain";
    facts.manoeuvre = "speed run at two altitudes";
    facts.source = "Cooper (2012) eq. 19-20";
    facts.example.inputs[0] = {Quantity::mach, 0.75};
    facts.example.inputs[1] = {Quantity::static_pressure, 250.0};
    facts.example.parameters = {-0.05965};
    facts.example.value = -11.184375;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * (state[Quantity::mach] * state[Quantity::static_pressure]);
  }
};

}  // namespace pcor::effects
