#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct StaticLag : Proportional<Quantity::static_pressure_rate> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "static-lag";
    info.title = "pneumatic lag of the static line";
    info.family = "lag";
    info.location = EffectLocation::static_line;
    info.formula = "tau * static_pressure_rate";
    info.parameters[0] = {"tau", "s", 0.0, 0.0, 30.0, 0.15};
    info.needs = {Quantity::static_pressure_rate, Quantity::count, Quantity::count, Quantity::count};
    info.size = "0.05 to 0.3 s: 0.05 to 0.3 hPa at a climb of 10 m/s";
    info.confounders = "total-lag, temp-lag, speedbrake-thrust";
    info.manoeuvre = "climb and descent through one level; pitch manoeuvre";
    info.source = "Gracey, NASA RP-1046; NCAR wind uncertainty technical note sec. 2.2";
    info.example.inputs[0] = {Quantity::static_pressure_rate, -1.2};
    info.example.parameters = {0.15};
    info.example.value = -0.18;
    return info;
  }
};

}  // namespace pcor::effects
