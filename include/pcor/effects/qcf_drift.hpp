#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct QcfDrift : MinusDrift {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "qcf-drift";
    info.title = "zero of the dynamic transducer drifts through the flight";
    info.family = "drift";
    info.location = EffectLocation::dynamic_transducer;
    info.formula = "-per_hour * time / 3600";
    info.parameters[0] = {"per_hour", "hPa/h", 0.0, -20.0, 20.0, 0.1};
    info.needs = {Quantity::time, Quantity::count, Quantity::count, Quantity::count};
    info.size = "estimated 0.1 hPa/h: a third of the zero of 0.34 hPa (Honeywell PPT) within an hour";
    info.confounders = "time-drift, psfd-drift, transducer-thermal";
    info.manoeuvre =
        "level legs early and late at one speed, attack and level, with a second static and pitot pair; zero "
        "on the ramp before and after";
    info.source = "estimate, from NCAR wind uncertainty technical note table 1";
    info.example.inputs[0] = {Quantity::time, 7200.0};
    info.example.parameters = {0.1};
    info.example.value = -0.2;
    return info;
  }
};

}  // namespace pcor::effects
