#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct TempDrift : MinusDrift {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "temp-drift";
    info.title = "thermometer drifts through the flight";
    info.family = "drift";
    info.location = EffectLocation::temperature;
    info.formula = "-per_hour * time / 3600";
    info.parameters[0] = {"per_hour", "K/h", 0.0, -20.0, 20.0, 0.1};
    info.needs = {Quantity::time, Quantity::count, Quantity::count, Quantity::count};
    info.size = "estimated 0.1 K/h: a third of the offset of 0.3 K within an hour";
    info.confounders = "temp-offset, time-drift, qcf-drift";
    info.manoeuvre = "climbs and descents early and late, with GPS height; two thermometers";
    info.source = "estimate, from Cooper et al., Atmos. Meas. Tech. 7, 3215 (2014)";
    info.example.inputs[0] = {Quantity::time, 7200.0};
    info.example.parameters = {0.1};
    info.example.value = -0.2;
    return info;
  }
};

}  // namespace pcor::effects
