#pragma once

#include <pcor/effects/in_cloud.hpp>
#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct LamsCloud {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "lams-cloud";
    facts.title = "the laser reads low in cloud";
    facts.family = "cloud";
    facts.where = Where::beam_speed;
    facts.formula = "if(liquid_water > 0.05, -error, 0)";
    facts.parameters[0] = {"error", "m/s", 0.0, -50.0, 0.0, -0.5};
    facts.needs = {Quantity::liquid_water, Quantity::count, Quantity::count, Quantity::count};
    facts.size = "-0.5 to -2 m/s: 0.5 to 2 hPa";
    facts.look_alikes = "temp-wetting";
    facts.manoeuvre = "entry into cloud and exit; several beams";
    facts.source = "ARISTO memo sec. 5.2-5.3; Keeler et al., J. Atmos. Oceanic Technol. 4, 113 (1987)";
    facts.example.inputs[0] = {Quantity::liquid_water, 0.3};
    facts.example.parameters = {-0.5};
    facts.example.value = 0.5;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return -(parameter[0] * in_cloud(state[Quantity::liquid_water]));
  }
};

}  // namespace pcor::effects
