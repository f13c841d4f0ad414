#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct StaticLeak {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "static-leak";
    facts.title = "leak from the pressurised cabin into the static line";
    facts.family = "leak";
    facts.where = Where::static_line;
    facts.formula = "-fraction * (cabin_pressure - static_pressure)";
    facts.parameters[0] = {"fraction", "1", 0.0, 0.0, 1.0, 0.0005};
    facts.needs = {Quantity::cabin_pressure, Quantity::static_pressure, Quantity::count, Quantity::count};
    facts.size = "1e-4 to 1e-3, estimated: 0.06 to 0.55 hPa (GV at 250 hPa, cabin at 800)";
    facts.look_alikes = "qcf-zero, temp-deice-heat, static-constant";
    facts.manoeuvre = "level legs before and after the cabin pressure changes; leak check on the ground";
    facts.source = "Gracey, NASA RP-1046; size estimated";
    facts.example.inputs[0] = {Quantity::cabin_pressure, 800.0};
    facts.example.inputs[1] = {Quantity::static_pressure, 250.0};
    facts.example.parameters = {0.0005};
    facts.example.value = -0.275;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return -(parameter[0] * (state[Quantity::cabin_pressure] - state[Quantity::static_pressure]));
  }
};

}  // namespace pcor::effects
