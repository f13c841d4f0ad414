#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct ClockSkew {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "clock-skew";
    facts.title = "clock of the laser is late";
    facts.family = "clock";
    facts.where = Where::beam_speed;
    facts.formula = "seconds * airspeed_rate";
    facts.parameters[0] = {"seconds", "s", 0.0,   -60.0,
                           60.0,      0.5, false, {0.5, -0.5, 1.0, -1.0, 1.5, -1.5, 2.0, -2.0, 4.0, -4.0}};
    facts.needs = {Quantity::airspeed_rate, Quantity::count, Quantity::count, Quantity::count};
    facts.memory = {Quantity::airspeed_rate, 0};
    facts.size = "0.08 to 2 s between the clocks of one aircraft: 0.27 to 0.5 hPa/s in a speed run";
    facts.look_alikes = "qcf-lag, total-lag, temp-lag, lams-volume";
    facts.manoeuvre = "both branches of a speed run; phase in a pitch manoeuvre";
    facts.source = "NCAR quality-assurance notes, pitch manoeuvre";
    facts.example.inputs[0] = {Quantity::airspeed_rate, 0.4};
    facts.example.parameters = {0.5};
    facts.example.value = 0.2;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * state[Quantity::airspeed_rate];
  }
};

}  // namespace pcor::effects
