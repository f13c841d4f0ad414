#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct StaticBetaOdd : Proportional<Quantity::sideslip_ratio, Quantity::static_pressure> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "static-beta-odd";
    info.title = "static-port error with sideslip, ports not perfectly paired";
    info.family = "sideslip";
    info.location = EffectLocation::static_defect;
    info.formula = "b1 * sideslip_ratio * static_pressure";
    info.parameters[0] = {"b1", "1", 0.0, -2.0, 2.0, -0.0018};
    info.needs = {Quantity::sideslip_ratio, Quantity::static_pressure, Quantity::count, Quantity::count};
    info.scalings[0] = {-1, 1};  // q instead of p
    info.size = "C-130 -0.00177 (PSFD), -0.0008 (PSFRD): -0.37 hPa at 3.7 deg, 700 hPa";
    info.confounders = "lams-azimuth";
    info.manoeuvre = "yaw manoeuvre";
    info.source = "Cooper (2012) eq. 19";
    info.example.inputs[0] = {Quantity::sideslip_ratio, 0.3};
    info.example.inputs[1] = {Quantity::static_pressure, 700.0};
    info.example.parameters = {-0.001773};
    info.example.value = -0.37233;
    return info;
  }
};

}  // namespace pcor::effects
