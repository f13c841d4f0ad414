#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct PsfdGain {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "psfd-gain";
    facts.title = "span error of the static transducer";
    facts.family = "gain";
    facts.where = Where::static_transducer;
    facts.formula = "-gain * static_pressure";
    facts.parameters[0] = {"gain", "1", 0.0, -0.5, 0.5, 0.0001};
    facts.parameters[0].doubt = 0.0001;
    facts.needs = {Quantity::static_pressure, Quantity::count, Quantity::count, Quantity::count};
    facts.size = "0.1 hPa at 1000 hPa (Paroscientific): the laser sees 7 to 35 % of it";
    facts.look_alikes = "psfd-bias, static-constant, qcf-gain";
    facts.manoeuvre =
        "airport pressures at two levels; a second static and pitot pair from the ground to high up";
    facts.source = "NCAR wind uncertainty technical note table 1";
    facts.example.inputs[0] = {Quantity::static_pressure, 700.0};
    facts.example.parameters = {0.0001};
    facts.example.value = -0.07;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return -(parameter[0] * state[Quantity::static_pressure]);
  }
};

}  // namespace pcor::effects
