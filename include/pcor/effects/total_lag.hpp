#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct TotalLag {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "total-lag";
    facts.title = "lag of the total-pressure line";
    facts.family = "lag";
    facts.where = Where::total_line;
    facts.formula = "tau * (static_pressure_rate + dynamic_pressure_rate)";
    facts.parameters[0] = {"tau", "s", 0.0, 0.0, 30.0, 0.1};
    facts.needs = {Quantity::static_pressure_rate, Quantity::dynamic_pressure_rate, Quantity::count,
                   Quantity::count};
    facts.size = "QCF answers in 0.05 s and is 0.02 s late: 0.1 hPa at a climb of 10 m/s";
    facts.look_alikes = "static-lag, clock-skew, temp-lag";
    facts.manoeuvre = "speed run, accelerating against decelerating";
    facts.source = "NCAR wind uncertainty technical note sec. 2.2.3";
    facts.example.inputs[0] = {Quantity::static_pressure_rate, -0.8};
    facts.example.inputs[1] = {Quantity::dynamic_pressure_rate, 0.3};
    facts.example.parameters = {0.1};
    facts.example.value = -0.05;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * (state[Quantity::static_pressure_rate] + state[Quantity::dynamic_pressure_rate]);
  }
};

}  // namespace pcor::effects
