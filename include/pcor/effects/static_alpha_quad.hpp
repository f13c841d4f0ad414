#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct StaticAlphaQuad
    : Proportional<Quantity::dynamic_ratio, Quantity::attack, Quantity::attack, Quantity::static_pressure> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "static-alpha-quad";
    info.title = "non-linear static-port error with the angle of attack";
    info.family = "attack";
    info.location = EffectLocation::static_defect;
    info.formula = "a4 * dynamic_ratio * attack^2 * static_pressure";
    info.parameters[0] = {"a4", "1/deg2", 0.0, -0.2, 0.2, 0.0024};
    info.needs = {Quantity::dynamic_ratio, Quantity::attack, Quantity::static_pressure, Quantity::count};
    info.scalings[0] = {1, -1};  // p instead of q
    info.size = "C-130 0.00245 (PSFD), 0.00163 (PSFRD): 2.6 hPa at 4 deg, 700 hPa";
    info.confounders = "flaps-gear, pitot-angle, lams-elevation";
    info.manoeuvre = "pitch manoeuvre at two speeds; slow half of a speed run";
    info.source = "ARISTO memo eq. 10; NCAR processing algorithms eq. 4.4";
    info.example.inputs[0] = {Quantity::dynamic_ratio, 0.1};
    info.example.inputs[1] = {Quantity::attack, 4.0};
    info.example.inputs[2] = {Quantity::static_pressure, 700.0};
    info.example.parameters = {0.00245};
    info.example.value = 2.744;
    return info;
  }
};

}  // namespace pcor::effects
