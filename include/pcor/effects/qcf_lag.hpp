#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct QcfLag : Proportional<Quantity::dynamic_pressure_rate> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "qcf-lag";
    info.title = "response and filter of the differential transducer";
    info.family = "lag";
    info.location = EffectLocation::dynamic_transducer;
    info.formula = "tau * dynamic_pressure_rate";
    info.parameters[0] = {"tau", "s", 0.0, 0.0, 30.0, 0.1};
    info.needs = {Quantity::dynamic_pressure_rate, Quantity::count, Quantity::count, Quantity::count};
    info.size = "QCF answers in 0.05 s and is 0.02 s late: 0.03 hPa in a speed run of 0.3 m/s2";
    info.confounders = "clock-skew, total-lag";
    info.manoeuvre =
        "none with one laser: its clock does the same; a second differential transducer of another response";
    info.source = "NCAR wind uncertainty technical note sec. 2.2.3";
    info.example.inputs[0] = {Quantity::dynamic_pressure_rate, 0.3};
    info.example.parameters = {0.1};
    info.example.value = 0.03;
    return info;
  }
};

}  // namespace pcor::effects
