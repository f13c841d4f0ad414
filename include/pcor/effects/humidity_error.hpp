#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct HumidityError {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "humidity-error";
    facts.title = "error of the humidity";
    facts.family = "humidity";
    facts.where = Where::humidity;
    facts.constants = GasConstants::moist;
    facts.formula = "-gain * vapor_pressure";
    facts.parameters[0] = {"gain", "1", 0.0, -10.0, 1.0, 0.1};
    facts.needs = {Quantity::vapor_pressure, Quantity::count, Quantity::count, Quantity::count};
    facts.size =
        "10 % where the pressure in the cavity of a mirror is 10 % off (GV); only where the model uses moist "
        "constants";
    facts.look_alikes = "humidity-neglected, temp-offset";
    facts.manoeuvre = "descents followed by level flight";
    facts.source = "NCAR memo FitCavityPressure; NCAR processing algorithms, note 20";
    facts.example.inputs[0] = {Quantity::vapor_pressure, 20.0};
    facts.example.parameters = {0.1};
    facts.example.value = -2.0;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return -(parameter[0] * state[Quantity::vapor_pressure]);
  }
};

}  // namespace pcor::effects
