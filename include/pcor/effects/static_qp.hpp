#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct StaticQp : Proportional<Quantity::dynamic_ratio, Quantity::static_pressure> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "static-qp";
    info.title = "static-port error with the ratio of dynamic to static pressure";
    info.family = "Mach number";
    info.location = EffectLocation::static_defect;
    info.formula = "a2 * dynamic_ratio * static_pressure";
    info.parameters[0] = {"a2", "1", 0.0, -2.0, 2.0, 0.03};
    info.needs = {Quantity::dynamic_ratio, Quantity::static_pressure, Quantity::count, Quantity::count};
    info.size = "C-130 0.031 (PSFD), 0.071 (PSFRD): 2.1 and 4.8 hPa at q 68 hPa";
    info.confounders = "static-mach2, lams-scale, temp-offset, recovery-factor, qcf-gain";
    info.manoeuvre = "speed run at two altitudes";
    info.source = "Cooper (2012) eq. 18, 20";
    info.example.inputs[0] = {Quantity::dynamic_ratio, 0.1};
    info.example.inputs[1] = {Quantity::static_pressure, 680.0};
    info.example.parameters = {0.030849643};
    info.example.value = 2.097775724;
    return info;
  }
};

}  // namespace pcor::effects
