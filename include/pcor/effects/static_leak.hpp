#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct StaticLeak {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "static-leak";
    info.title = "leak from the pressurised cabin into the static line";
    info.family = "leak";
    info.location = EffectLocation::static_line;
    info.formula = "-fraction * (cabin_pressure - static_pressure)";
    info.parameters[0] = {"fraction", "1", 0.0, 0.0, 1.0, 0.0005};
    info.needs = {Quantity::cabin_pressure, Quantity::static_pressure, Quantity::count, Quantity::count};
    info.size = "1e-4 to 1e-3, estimated: 0.06 to 0.55 hPa (GV at 250 hPa, cabin at 800)";
    info.confounders = "qcf-zero, temp-deice-heat, static-constant";
    info.manoeuvre = "level legs before and after the cabin pressure changes; leak check on the ground";
    info.source = "Gracey, NASA RP-1046; size estimated";
    info.example.inputs[0] = {Quantity::cabin_pressure, 800.0};
    info.example.inputs[1] = {Quantity::static_pressure, 250.0};
    info.example.parameters = {0.0005};
    info.example.value = -0.275;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return -(parameter[0] * (state[Quantity::cabin_pressure] - state[Quantity::static_pressure]));
  }
};

}  // namespace pcor::effects
