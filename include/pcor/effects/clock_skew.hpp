#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct ClockSkew : Proportional<Quantity::airspeed_rate> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "clock-skew";
    info.title = "clock of the laser is late";
    info.family = "clock";
    info.location = EffectLocation::beam_speed;
    info.formula = "seconds * airspeed_rate";
    info.parameters[0] = {"seconds", "s", 0.0,   -60.0,
                          60.0,      0.5, false, {0.5, -0.5, 1.0, -1.0, 1.5, -1.5, 2.0, -2.0, 4.0, -4.0}};
    info.needs = {Quantity::airspeed_rate, Quantity::count, Quantity::count, Quantity::count};
    info.memory = {Quantity::airspeed_rate, 0};
    info.size = "0.08 to 2 s between the clocks of one aircraft: 0.27 to 0.5 hPa/s in a speed run";
    info.confounders = "qcf-lag, total-lag, temp-lag, lams-volume";
    info.manoeuvre = "both branches of a speed run; phase in a pitch manoeuvre";
    info.source = "NCAR quality-assurance notes, pitch manoeuvre";
    info.example.inputs[0] = {Quantity::airspeed_rate, 0.4};
    info.example.parameters = {0.5};
    info.example.value = 0.2;
    return info;
  }
};

}  // namespace pcor::effects
