#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct QcfGain {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "qcf-gain";
    facts.title = "span error of the dynamic transducer";
    facts.family = "gain";
    facts.where = Where::dynamic_transducer;
    facts.formula = "-gain * dynamic_pressure";
    facts.parameters[0] = {"gain", "1", 0.0, -0.5, 0.5, 0.005};
    facts.needs = {Quantity::dynamic_pressure, Quantity::count, Quantity::count, Quantity::count};
    facts.size = "estimated 0.1 to 0.5 %: 0.06 to 0.35 hPa";
    facts.look_alikes = "lams-scale, temp-offset, static-qp, static-mach2, qcf-zero";
    facts.manoeuvre = "a second static and pitot pair over a wide range of q: one laser alone cannot show it";
    facts.source = "NCAR wind uncertainty technical note table 1";
    facts.example.inputs[0] = {Quantity::dynamic_pressure, 70.0};
    facts.example.parameters = {0.005};
    facts.example.value = -0.35;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return -(parameter[0] * state[Quantity::dynamic_pressure]);
  }
};

}  // namespace pcor::effects
