#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct StaticConstant : Proportional<Quantity::static_pressure> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "static-constant";
    info.title = "static-port error that is a constant fraction of the pressure";
    info.family = "zero";
    info.location = EffectLocation::static_defect;
    info.formula = "a0 * static_pressure";
    info.parameters[0] = {"a0", "1", 0.0, -0.5, 0.5, 0.004};
    info.needs = {Quantity::static_pressure, Quantity::count, Quantity::count, Quantity::count};
    info.size = "C-130 0.004: 3 hPa at 700 hPa";
    info.confounders = "psfd-bias, qcf-zero";
    info.manoeuvre = "an absolute reference; no manoeuvre does";
    info.source = "Cooper (2012) eq. 18-20";
    info.example.inputs[0] = {Quantity::static_pressure, 700.0};
    info.example.parameters = {0.004127875};
    info.example.value = 2.8895125;
    return info;
  }
};

}  // namespace pcor::effects
