#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct StaticQp {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "static-qp";
    facts.title = "static-port error with the ratio of dynamic to static pressure";
    facts.family = "Mach number";
    facts.where = Where::static_defect;
    facts.formula = "a2 * dynamic_ratio * static_pressure";
    facts.parameters[0] = {"a2", "1", 0.0, -2.0, 2.0, 0.03};
    facts.needs = {Quantity::dynamic_ratio, Quantity::static_pressure, Quantity::count, Quantity::count};
    facts.size = "C-130 0.031 (PSFD), 0.071 (PSFRD): 2.1 and 4.8 hPa at q 68 hPa";
    facts.look_alikes = "static-mach2, lams-scale, temp-offset, recovery-factor, qcf-gain";
    facts.manoeuvre = "speed run at two altitudes";
    facts.source = "Cooper (2012) eq. 18, 20";
    facts.example.inputs[0] = {Quantity::dynamic_ratio, 0.1};
    facts.example.inputs[1] = {Quantity::static_pressure, 680.0};
    facts.example.parameters = {0.030849643};
    facts.example.value = 2.097775724;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * (state[Quantity::dynamic_ratio] * state[Quantity::static_pressure]);
  }
};

}  // namespace pcor::effects
