#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct StaticMach2 {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "static-mach2";
    facts.title = "static-port error with the square of the Mach number";
    facts.family = "Mach number";
    facts.where = Where::static_defect;
    facts.formula = "m2 * mach^2 * static_pressure";
    facts.parameters[0] = {"m2", "1", 0.0, -2.0, 2.0, 0.02};
    facts.needs = {Quantity::mach, Quantity::static_pressure, Quantity::count, Quantity::count};
    facts.size = "C-130 0.019 (PSFD)";
    facts.look_alikes =
        "static-qp, static-mach, static-mach3, lams-scale, temp-offset, recovery-factor, qcf-gain";
    facts.manoeuvre = "speed run at two altitudes";
    facts.source = "Cooper (2012) eq. 19-20";
    facts.example.inputs[0] = {Quantity::mach, 0.75};
    facts.example.inputs[1] = {Quantity::static_pressure, 250.0};
    facts.example.parameters = {-0.2833};
    facts.example.value = -39.8390625;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * (state[Quantity::mach] * state[Quantity::mach] * state[Quantity::static_pressure]);
  }
};

}  // namespace pcor::effects
