#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct TempLag {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "temp-lag";
    facts.title = "slow thermometer";
    facts.family = "lag";
    facts.where = Where::temperature;
    facts.formula = "tau * recovery_temperature_rate";
    facts.parameters[0] = {"tau", "s", 0.0, 0.0, 120.0, 2.3};
    facts.needs = {Quantity::recovery_temperature_rate, Quantity::count, Quantity::count, Quantity::count};
    facts.size = "heated 2.3 s, unheated 0.03 and 0.45 s: 0.15 K at a climb of 10 m/s";
    facts.look_alikes = "static-lag, total-lag, clock-skew";
    facts.manoeuvre = "both branches of a speed run; climb and descent through one level";
    facts.source = "Cooper, Recovery factor study, NCAR, October 2014";
    facts.example.inputs[0] = {Quantity::recovery_temperature_rate, -0.05};
    facts.example.parameters = {2.3};
    facts.example.value = -0.115;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * state[Quantity::recovery_temperature_rate];
  }
};

}  // namespace pcor::effects
