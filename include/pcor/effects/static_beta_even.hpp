#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct StaticBetaEven : Proportional<Quantity::sideslip, Quantity::sideslip, Quantity::static_pressure> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "static-beta-even";
    info.title = "static-port error with sideslip, ports joined left to right";
    info.family = "sideslip";
    info.location = EffectLocation::static_defect;
    info.formula = "b2 * sideslip^2 * static_pressure";
    info.parameters[0] = {"b2", "1/deg2", 0.0, -0.02, 0.02, -2e-5};
    info.needs = {Quantity::sideslip, Quantity::static_pressure, Quantity::count, Quantity::count};
    info.scalings[0] = {-1, 1};  // q instead of p
    info.size = "estimated 1e-5 to 4e-5 /deg2: -0.1 to -0.4 hPa at 4 deg";
    info.confounders = "pitot-angle, lams-azimuth";
    info.manoeuvre = "yaw manoeuvre, steady-heading sideslip";
    info.source = "Cooper (2012), text after eq. 20";
    info.example.inputs[0] = {Quantity::sideslip, 4.0};
    info.example.inputs[1] = {Quantity::static_pressure, 700.0};
    info.example.parameters = {-2e-5};
    info.example.value = -0.224;
    return info;
  }
};

}  // namespace pcor::effects
