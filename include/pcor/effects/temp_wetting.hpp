#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct TempWetting {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "temp-wetting";
    facts.title = "the thermometer gets wet in cloud and cools";
    facts.family = "cloud";
    facts.where = Where::temperature;
    facts.formula = "-error * wetness";
    facts.parameters[0] = {"error", "K", 0.0, -30.0, 0.0, -1.0};
    facts.parameters[1] = {"drying", "s", 10.0, 0.0, 600.0, 10.0, true, {1.0, 5.0, 20.0, 40.0}};
    facts.needs = {Quantity::wetness, Quantity::count, Quantity::count, Quantity::count};
    facts.memory = {Quantity::wetness, 1};
    facts.size = "-0.5 to -2 K: -0.1 to -0.8 hPa, in cloud and until it is dry, 5 to 20 s later";
    facts.look_alikes = "lams-cloud";
    facts.manoeuvre = "passes through cloud with a radiometer";
    facts.source = "Cooper (2012) item 6 and recommendation 5; ARISTO memo";
    facts.example.inputs[0] = {Quantity::wetness, 0.6};
    facts.example.parameters = {-1.0, 10.0};
    facts.example.value = 0.6;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return -(parameter[0] * state[Quantity::wetness]);
  }
};

}  // namespace pcor::effects
