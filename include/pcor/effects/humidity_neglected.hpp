#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct HumidityNeglected {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "humidity-neglected";
    facts.title = "dry constants in moist air";
    facts.family = "humidity";
    facts.where = Where::humidity;
    facts.constants = GasConstants::dry;
    facts.formula = "fraction * vapor_pressure";
    facts.parameters[0] = {"fraction", "1", 0.0, 0.0, 1.5, 1.0};
    facts.needs = {Quantity::vapor_pressure, Quantity::count, Quantity::count, Quantity::count};
    facts.size =
        "-0.1 to -0.65 hPa, most low, warm and fast; only where the model uses dry constants, and right at 1";
    facts.look_alikes = "temp-offset, lams-scale";
    facts.manoeuvre = "leg in the boundary layer against one aloft at the same Mach number and attack";
    facts.source = "Cooper (2012) eq. 13-17";
    facts.example.inputs[0] = {Quantity::vapor_pressure, 20.0};
    facts.example.parameters = {1.0};
    facts.example.value = 20.0;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * state[Quantity::vapor_pressure];
  }
};

}  // namespace pcor::effects
