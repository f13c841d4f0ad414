#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct TempDrift {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "temp-drift";
    facts.title = "thermometer drifts through the flight";
    facts.family = "drift";
    facts.where = Where::temperature;
    facts.formula = "-per_hour * time / 3600";
    facts.parameters[0] = {"per_hour", "K/h", 0.0, -20.0, 20.0, 0.1};
    facts.needs = {Quantity::time, Quantity::count, Quantity::count, Quantity::count};
    facts.size = "estimated 0.1 K/h: a third of the offset of 0.3 K within an hour";
    facts.look_alikes = "temp-offset, time-drift, qcf-drift";
    facts.manoeuvre = "climbs and descents early and late, with GPS height; two thermometers";
    facts.source = "estimate, from Cooper et al., Atmos. Meas. Tech. 7, 3215 (2014)";
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
