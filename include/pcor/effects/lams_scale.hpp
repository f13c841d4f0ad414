#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct LamsScale : MinusProportional<Quantity::lams_airspeed> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "lams-scale";
    info.title = "scale of the airspeed from the laser";
    info.family = "beam speed";
    info.location = EffectLocation::beam_speed;
    info.formula = "-scale * lams_airspeed";
    info.parameters[0] = {"scale", "1", 0.0, -0.5, 0.5, 0.001};
    info.parameters[0].calibration_uncertainty = 0.002;
    info.needs = {Quantity::lams_airspeed, Quantity::count, Quantity::count, Quantity::count};
    info.size =
        "calibration within 0.1 m/s; index of refraction 0.024 m/s at 700 hPa; the constant part of the flow "
        "ahead of the aircraft 0.004";
    info.confounders = "static-mach2, static-qp, temp-offset, qcf-gain, lams-induction";
    info.manoeuvre = "reverse headings and circles only";
    info.source = "NCAR wind uncertainty technical note sec. 2.4.5";
    info.example.inputs[0] = {Quantity::lams_airspeed, 120.0};
    info.example.parameters = {0.001};
    info.example.value = -0.12;
    return info;
  }
};

}  // namespace pcor::effects
