#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct PsfdDrift : MinusDrift {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "psfd-drift";
    info.title = "zero of the static transducer drifts through the flight";
    info.family = "drift";
    info.location = EffectLocation::static_transducer;
    info.formula = "-per_hour * time / 3600";
    info.parameters[0] = {"per_hour", "hPa/h", 0.0, -20.0, 20.0, 0.03};
    info.parameters[0].calibration_uncertainty = 0.03;
    info.needs = {Quantity::time, Quantity::count, Quantity::count, Quantity::count};
    info.size = "estimated 0.03 hPa/h: a third of the bias of 0.1 hPa (Paroscientific) within an hour";
    info.confounders = "time-drift, qcf-drift, psfd-thermal";
    info.manoeuvre =
        "level legs early and late at one speed, attack and level, with a second static and pitot pair";
    info.source = "estimate, from NCAR wind uncertainty technical note table 1";
    info.example.inputs[0] = {Quantity::time, 7200.0};
    info.example.parameters = {0.03};
    info.example.value = -0.06;
    return info;
  }
};

}  // namespace pcor::effects
