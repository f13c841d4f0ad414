#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct TimeDrift {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "time-drift";
    facts.title = "delta-p drifts through the flight";
    facts.family = "drift";
    facts.where = Where::static_defect;
    facts.formula = "per_hour * time / 3600";
    facts.parameters[0] = {"per_hour", "hPa/h", 0.0, -20.0, 20.0, 0.1};
    facts.needs = {Quantity::time, Quantity::count, Quantity::count, Quantity::count};
    facts.size = "0.1 hPa/h, estimated: zeros warm up, ports collect dirt";
    facts.look_alikes = "transducer-thermal, adif-drift";
    facts.manoeuvre = "level legs early and late at one speed, attack and level";
    facts.source = "estimate";
    facts.example.inputs[0] = {Quantity::time, 7200.0};
    facts.example.parameters = {0.1};
    facts.example.value = 0.2;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    return parameter[0] * (state[Quantity::time] * S(1.0 / 3600.0));
  }
};

}  // namespace pcor::effects
