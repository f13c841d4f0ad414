#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct TempLag : Proportional<Quantity::recovery_temperature_rate> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "temp-lag";
    info.title = "slow thermometer";
    info.family = "lag";
    info.location = EffectLocation::temperature;
    info.formula = "tau * recovery_temperature_rate";
    info.parameters[0] = {"tau", "s", 0.0, 0.0, 120.0, 2.3};
    info.needs = {Quantity::recovery_temperature_rate, Quantity::count, Quantity::count, Quantity::count};
    info.size = "heated 2.3 s, unheated 0.03 and 0.45 s: 0.15 K at a climb of 10 m/s";
    info.confounders = "static-lag, total-lag, clock-skew";
    info.manoeuvre = "both branches of a speed run; climb and descent through one level";
    info.source = "Cooper, Recovery factor study, NCAR, October 2014";
    info.example.inputs[0] = {Quantity::recovery_temperature_rate, -0.05};
    info.example.parameters = {2.3};
    info.example.value = -0.115;
    return info;
  }
};

}  // namespace pcor::effects
