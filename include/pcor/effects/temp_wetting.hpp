#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct TempWetting : MinusProportional<Quantity::wetness> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "temp-wetting";
    info.title = "the thermometer gets wet in cloud and cools";
    info.family = "cloud";
    info.location = EffectLocation::temperature;
    info.formula = "-error * wetness";
    info.parameters[0] = {"error", "K", 0.0, -30.0, 0.0, -1.0};
    info.parameters[1] = {"drying", "s", 10.0, 0.0, 600.0, 10.0, true, {1.0, 5.0, 20.0, 40.0}};
    info.needs = {Quantity::wetness, Quantity::count, Quantity::count, Quantity::count};
    info.memory = {Quantity::wetness, 1};
    info.size = "-0.5 to -2 K: -0.1 to -0.8 hPa, in cloud and until it is dry, 5 to 20 s later";
    info.confounders = "lams-cloud";
    info.manoeuvre = "passes through cloud with a radiometer";
    info.source = "Cooper (2012) item 6 and recommendation 5; ARISTO memo";
    info.example.inputs[0] = {Quantity::wetness, 0.6};
    info.example.parameters = {-1.0, 10.0};
    info.example.value = 0.6;
    return info;
  }
};

}  // namespace pcor::effects
