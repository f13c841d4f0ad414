#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct StaticConstant {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "static-constant";
    facts.title = "static-port error that is a constant fraction of the pressure";
    facts.family = "zero";
    facts.where = Where::static_defect;
    facts.formula = "a0 * static_pressure";
    facts.parameters[0] = {"a0", "1", 0.0, -0.5, 0.5, 0.004};
    facts.needs = {Quantity::static_pressure, Quantity::count, Quantity::count, Quantity::count};
    facts.size = "C-130 0.004: 3 hPa at 700 hPa";
    facts.look_alikes = "psfd-bias, qcf-zero";
    facts.manoeuvre = "an absolute reference; no manoeuvre does";
    facts.source = "Cooper (2012) eq. 18-20";
    facts.example.inputs[0] = {Quantity::static_pressure, 700.0};
    facts.example.parameters = {0.004127875};
    facts.example.value = 2.8895125;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * state[Quantity::static_pressure];
  }
};

}  // namespace pcor::effects
