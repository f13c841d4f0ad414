#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct PsfdGain : MinusProportional<Quantity::static_pressure> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "psfd-gain";
    info.title = "span error of the static transducer";
    info.family = "gain";
    info.location = EffectLocation::static_transducer;
    info.formula = "-gain * static_pressure";
    info.parameters[0] = {"gain", "1", 0.0, -0.5, 0.5, 0.0001};
    info.parameters[0].calibration_uncertainty = 0.0001;
    info.needs = {Quantity::static_pressure, Quantity::count, Quantity::count, Quantity::count};
    info.size = "0.1 hPa at 1000 hPa (Paroscientific): the laser sees 7 to 35 % of it";
    info.confounders = "psfd-bias, static-constant, qcf-gain";
    info.manoeuvre =
        "airport pressures at two levels; a second static and pitot pair from the ground to high up";
    info.source = "NCAR wind uncertainty technical note table 1";
    info.example.inputs[0] = {Quantity::static_pressure, 700.0};
    info.example.parameters = {0.0001};
    info.example.value = -0.07;
    return info;
  }
};

}  // namespace pcor::effects
