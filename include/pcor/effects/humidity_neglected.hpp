#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct HumidityNeglected : Proportional<Quantity::vapor_pressure> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "humidity-neglected";
    info.title = "dry constants in moist air";
    info.family = "humidity";
    info.location = EffectLocation::humidity;
    info.constants = GasConstants::dry;
    info.formula = "fraction * vapor_pressure";
    info.parameters[0] = {"fraction", "1", 0.0, 0.0, 1.5, 1.0};
    info.needs = {Quantity::vapor_pressure, Quantity::count, Quantity::count, Quantity::count};
    info.size =
        "-0.1 to -0.65 hPa, most low, warm and fast; only where the model uses dry constants, and right at 1";
    info.confounders = "temp-offset, lams-scale";
    info.manoeuvre = "leg in the boundary layer against one aloft at the same Mach number and attack";
    info.source = "Cooper (2012) eq. 13-17";
    info.example.inputs[0] = {Quantity::vapor_pressure, 20.0};
    info.example.parameters = {1.0};
    info.example.value = 20.0;
    return info;
  }
};

}  // namespace pcor::effects
