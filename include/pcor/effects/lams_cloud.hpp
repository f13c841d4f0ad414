#pragma once

#include <pcor/effects/in_cloud.hpp>
#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct LamsCloud {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "lams-cloud";
    info.title = "the laser reads low in cloud";
    info.family = "cloud";
    info.location = EffectLocation::beam_speed;
    info.formula = "if(liquid_water > 0.05, -error, 0)";
    info.parameters[0] = {"error", "m/s", 0.0, -50.0, 0.0, -0.5};
    info.needs = {Quantity::liquid_water, Quantity::count, Quantity::count, Quantity::count};
    info.size = "-0.5 to -2 m/s: 0.5 to 2 hPa";
    info.confounders = "temp-wetting";
    info.manoeuvre = "entry into cloud and exit; several beams";
    info.source = "ARISTO memo sec. 5.2-5.3; Keeler et al., J. Atmos. Oceanic Technol. 4, 113 (1987)";
    info.example.inputs[0] = {Quantity::liquid_water, 0.3};
    info.example.parameters = {-0.5};
    info.example.value = 0.5;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return -(parameter[0] * in_cloud(state[Quantity::liquid_water]));
  }
};

}  // namespace pcor::effects
