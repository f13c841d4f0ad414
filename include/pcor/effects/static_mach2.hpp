#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct StaticMach2 : Proportional<Quantity::mach, Quantity::mach, Quantity::static_pressure> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "static-mach2";
    info.title = "static-port error with the square of the Mach number";
    info.family = "Mach number";
    info.location = EffectLocation::static_defect;
    info.formula = "m2 * mach^2 * static_pressure";
    info.parameters[0] = {"m2", "1", 0.0, -2.0, 2.0, 0.02};
    info.needs = {Quantity::mach, Quantity::static_pressure, Quantity::count, Quantity::count};
    info.size = "C-130 0.019 (PSFD)";
    info.confounders =
        "static-qp, static-mach, static-mach3, lams-scale, temp-offset, recovery-factor, qcf-gain";
    info.manoeuvre = "speed run at two altitudes";
    info.source = "Cooper (2012) eq. 19-20";
    info.example.inputs[0] = {Quantity::mach, 0.75};
    info.example.inputs[1] = {Quantity::static_pressure, 250.0};
    info.example.parameters = {-0.2833};
    info.example.value = -39.8390625;
    return info;
  }
};

}  // namespace pcor::effects
