#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct StaticMach : Proportional<Quantity::mach, Quantity::static_pressure> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "static-mach";
    info.title = "static-port error with the Mach number";
    info.family = "Mach number";
    info.location = EffectLocation::static_defect;
    info.formula = "m1 * mach * static_pressure";
    info.parameters[0] = {"m1", "1", 0.0, -2.0, 2.0, 0.03};
    info.needs = {Quantity::mach, Quantity::static_pressure, Quantity::count, Quantity::count};
    info.size = "C-130 0.015 to 0.037; GV -0.06, nearly cancelled by the other powers";
    info.confounders =
        "static-qp, static-mach2, static-mach3, lams-scale, temp-offset, recovery-factor, qcf-gain";
    info.manoeuvre = "speed run at two altitudes";
    info.source = "Cooper (2012) eq. 19-20";
    info.example.inputs[0] = {Quantity::mach, 0.75};
    info.example.inputs[1] = {Quantity::static_pressure, 250.0};
    info.example.parameters = {-0.05965};
    info.example.value = -11.184375;
    return info;
  }
};

}  // namespace pcor::effects
