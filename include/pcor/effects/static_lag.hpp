#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct StaticLag {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "static-lag";
    facts.title = "pneumatic lag of the static line";
    facts.family = "lag";
    facts.where = Where::static_line;
    facts.formula = "tau * static_pressure_rate";
    facts.parameters[0] = {"tau", "s", 0.0, 0.0, 30.0, 0.15};
    facts.needs = {Quantity::static_pressure_rate, Quantity::count, Quantity::count, Quantity::count};
    facts.size = "0.05 to 0.3 s: 0.05 to 0.3 hPa at a climb of 10 m/s";
    facts.look_alikes = "total-lag, temp-lag, speedbrake-thrust";
    facts.manoeuvre = "climb and descent through one level; pitch manoeuvre";
    facts.source = "Gracey, NASA RP-1046; NCAR wind uncertainty technical note sec. 2.2";
    facts.example.inputs[0] = {Quantity::static_pressure_rate, -1.2};
    facts.example.parameters = {0.15};
    facts.example.value = -0.18;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * state[Quantity::static_pressure_rate];
  }
};

}  // namespace pcor::effects
