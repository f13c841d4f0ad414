#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct HumidityError : MinusProportional<Quantity::vapor_pressure> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "humidity-error";
    info.title = "error of the humidity";
    info.family = "humidity";
    info.location = EffectLocation::humidity;
    info.constants = GasConstants::moist;
    info.formula = "-gain * vapor_pressure";
    info.parameters[0] = {"gain", "1", 0.0, -10.0, 1.0, 0.1};
    info.needs = {Quantity::vapor_pressure, Quantity::count, Quantity::count, Quantity::count};
    info.size =
        "10 % where the pressure in the cavity of a mirror is 10 % off (GV); only where the model uses moist "
        "constants";
    info.confounders = "humidity-neglected, temp-offset";
    info.manoeuvre = "descents followed by level flight";
    info.source = "NCAR memo FitCavityPressure; NCAR processing algorithms, note 20";
    info.example.inputs[0] = {Quantity::vapor_pressure, 20.0};
    info.example.parameters = {0.1};
    info.example.value = -2.0;
    return info;
  }
};

}  // namespace pcor::effects
