#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct TotalLag {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "total-lag";
    info.title = "lag of the total-pressure line";
    info.family = "lag";
    info.location = EffectLocation::total_line;
    info.formula = "tau * (static_pressure_rate + dynamic_pressure_rate)";
    info.parameters[0] = {"tau", "s", 0.0, 0.0, 30.0, 0.1};
    info.needs = {Quantity::static_pressure_rate, Quantity::dynamic_pressure_rate, Quantity::count,
                  Quantity::count};
    info.size = "QCF answers in 0.05 s and is 0.02 s late: 0.1 hPa at a climb of 10 m/s";
    info.confounders = "static-lag, clock-skew, temp-lag";
    info.manoeuvre = "speed run, accelerating against decelerating";
    info.source = "NCAR wind uncertainty technical note sec. 2.2.3";
    info.example.inputs[0] = {Quantity::static_pressure_rate, -0.8};
    info.example.inputs[1] = {Quantity::dynamic_pressure_rate, 0.3};
    info.example.parameters = {0.1};
    info.example.value = -0.05;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * (state[Quantity::static_pressure_rate] + state[Quantity::dynamic_pressure_rate]);
  }
};

}  // namespace pcor::effects
