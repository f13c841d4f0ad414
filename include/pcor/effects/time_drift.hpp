#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct TimeDrift {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "time-drift";
    info.title = "delta-p drifts through the flight";
    info.family = "drift";
    info.location = EffectLocation::static_defect;
    info.formula = "per_hour * time / 3600";
    info.parameters[0] = {"per_hour", "hPa/h", 0.0, -20.0, 20.0, 0.1};
    info.needs = {Quantity::time, Quantity::count, Quantity::count, Quantity::count};
    info.size = "0.1 hPa/h, estimated: zeros warm up, ports collect dirt";
    info.confounders = "transducer-thermal, adif-drift";
    info.manoeuvre = "level legs early and late at one speed, attack and level";
    info.source = "estimate";
    info.example.inputs[0] = {Quantity::time, 7200.0};
    info.example.parameters = {0.1};
    info.example.value = 0.2;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    return parameter[0] * (state[Quantity::time] * S(1.0 / 3600.0));
  }
};

}  // namespace pcor::effects
