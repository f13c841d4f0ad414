#pragma once

#include <pcor/effects/in_cloud.hpp>
#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct TempWetting {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "temp-wetting";
    facts.title = "the thermometer is wet in cloud and cools";
    facts.family = "cloud";
    facts.where = Where::temperature;
    facts.formula = "if(liquid_water > 0.05, -error, 0)";
    facts.parameters[0] = {"error", "K", 0.0, -30.0, 0.0, -1.0};
    facts.needs = {Quantity::liquid_water, Quantity::count, Quantity::count, Quantity::count};
    facts.size = "-0.5 to -2 K: -0.1 to -0.8 hPa; the drying after the cloud is not described";
    facts.look_alikes = "lams-cloud";
    facts.manoeuvre = "passes through cloud with a radiometer";
    facts.source = "Cooper (2012) item 6 and recommendation 5; ARISTO memo";
    facts.example.inputs[0] = {Quantity::liquid_water, 0.3};
    facts.example.parameters = {-1.0};
    facts.example.value = 1.0;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return -(parameter[0] * in_cloud(state[Quantity::liquid_water]));
  }
};

}  // namespace pcor::effects
