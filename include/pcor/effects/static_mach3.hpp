#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct StaticMach3 : Proportional<Quantity::mach, Quantity::mach, Quantity::mach, Quantity::static_pressure> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "static-mach3";
    info.title = "static-port error with the cube of the Mach number";
    info.family = "Mach number";
    info.location = EffectLocation::static_defect;
    info.formula = "m3 * mach^3 * static_pressure";
    info.parameters[0] = {"m3", "1", 0.0, -2.0, 2.0, -0.09};
    info.needs = {Quantity::mach, Quantity::static_pressure, Quantity::count, Quantity::count};
    info.size = "GV -0.0875: -10 hPa at 250 hPa, Mach 0.78, nearly cancelled by static-qp";
    info.confounders =
        "static-qp, static-mach, static-mach2, lams-scale, temp-offset, recovery-factor, qcf-gain";
    info.manoeuvre = "speed run at two altitudes";
    info.source = "Cooper (2012) eq. 20; NCAR processing algorithms eq. 4.5";
    info.example.inputs[0] = {Quantity::mach, 0.75};
    info.example.inputs[1] = {Quantity::static_pressure, 250.0};
    info.example.parameters = {-0.2437};
    info.example.value = -25.702734375;
    return info;
  }
};

}  // namespace pcor::effects
