#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct QcfGain : MinusProportional<Quantity::dynamic_pressure> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "qcf-gain";
    info.title = "span error of the dynamic transducer";
    info.family = "gain";
    info.location = EffectLocation::dynamic_transducer;
    info.formula = "-gain * dynamic_pressure";
    info.parameters[0] = {"gain", "1", 0.0, -0.5, 0.5, 0.005};
    info.needs = {Quantity::dynamic_pressure, Quantity::count, Quantity::count, Quantity::count};
    info.size = "estimated 0.1 to 0.5 %: 0.06 to 0.35 hPa";
    info.confounders = "lams-scale, temp-offset, static-qp, static-mach2, qcf-zero";
    info.manoeuvre = "a second static and pitot pair over a wide range of q: one laser alone cannot show it";
    info.source = "NCAR wind uncertainty technical note table 1";
    info.example.inputs[0] = {Quantity::dynamic_pressure, 70.0};
    info.example.parameters = {0.005};
    info.example.value = -0.35;
    return info;
  }
};

}  // namespace pcor::effects
