#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct PsfdDrift {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "psfd-drift";
    facts.title = "zero of the static transducer drifts through the flight";
    facts.family = "drift";
    facts.where = Where::static_transducer;
    facts.formula = "-per_hour * time / 3600";
    facts.parameters[0] = {"per_hour", "hPa/h", 0.0, -20.0, 20.0, 0.03};
    facts.parameters[0].doubt = 0.03;
    facts.needs = {Quantity::time, Quantity::count, Quantity::count, Quantity::count};
    facts.size = "estimated 0.03 hPa/h: a third of the bias of 0.1 hPa (Paroscientific) within an hour";
    facts.look_alikes = "time-drift, qcf-drift, psfd-thermal";
    facts.manoeuvre =
        "level legs early and late at one speed, attack and level, with a second static and pitot pair";
    facts.source = "estimate, from NCAR wind uncertainty technical note table 1";
    facts.example.inputs[0] = {Quantity::time, 7200.0};
    facts.example.parameters = {0.03};
    facts.example.value = -0.06;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    return -(parameter[0] * (state[Quantity::time] * S(1.0 / 3600.0)));
  }
};

}  // namespace pcor::effects
