#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct QcfLag {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "qcf-lag";
    facts.title = "response and filter of the differential transducer";
    facts.family = "lag";
    facts.where = Where::dynamic_transducer;
    facts.formula = "tau * dynamic_pressure_rate";
    facts.parameters[0] = {"tau", "s", 0.0, 0.0, 30.0, 0.1};
    facts.needs = {Quantity::dynamic_pressure_rate, Quantity::count, Quantity::count, Quantity::count};
    facts.size = "QCF answers in 0.05 s and is 0.02 s late: 0.03 hPa in a speed run of 0.3 m/s2";
    facts.look_alikes = "clock-skew, total-lag";
    facts.manoeuvre =
        "none with one laser: its clock does the same; a second differential transducer of another response";
    facts.source = "NCAR wind uncertainty technical note sec. 2.2.3";
    facts.example.inputs[0] = {Quantity::dynamic_pressure_rate, 0.3};
    facts.example.parameters = {0.1};
    facts.example.value = 0.03;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * state[Quantity::dynamic_pressure_rate];
  }
};

}  // namespace pcor::effects
