#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct QcfDrift {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "qcf-drift";
    facts.title = "zero of the dynamic transducer drifts through the flight";
    facts.family = "drift";
    facts.where = Where::dynamic_transducer;
    facts.formula = "-per_hour * time / 3600";
    facts.parameters[0] = {"per_hour", "hPa/h", 0.0, -20.0, 20.0, 0.1};
    facts.needs = {Quantity::time, Quantity::count, Quantity::count, Quantity::count};
    facts.size = "estimated 0.1 hPa/h: a third of the zero of 0.34 hPa (Honeywell PPT) within an hour";
    facts.look_alikes = "time-drift, psfd-drift, transducer-thermal";
    facts.manoeuvre =
        "level legs early and late at one speed, attack and level, with a second static and pitot pair; zero "
        "on the ramp before and after";
    facts.source = "estimate, from NCAR wind uncertainty technical note table 1";
    facts.example.inputs[0] = {Quantity::time, 7200.0};
    facts.example.parameters = {0.1};
    facts.example.value = -0.2;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    return -(parameter[0] * (state[Quantity::time] * S(1.0 / 3600.0)));
  }
};

}  // namespace pcor::effects
