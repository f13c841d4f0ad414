#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct StaticAlpha : Proportional<Quantity::attack_ratio, Quantity::static_pressure> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "static-alpha";
    info.title = "static-port error with the angle of attack, as the radome ratio";
    info.family = "attack";
    info.location = EffectLocation::static_defect;
    info.formula = "a1 * attack_ratio * static_pressure";
    info.parameters[0] = {"a1", "1", 0.0, -2.0, 2.0, 0.0213};
    info.needs = {Quantity::attack_ratio, Quantity::static_pressure, Quantity::count, Quantity::count};
    info.scalings[0] = {-1, 1};  // q instead of p
    info.size = "C-130 PSFD 0.0213, 1 hPa/deg at 700 hPa; PSFRD 0.0089";
    info.confounders = "lams-elevation, pitot-angle, adif-drift";
    info.manoeuvre = "pitch manoeuvre, speed run";
    info.source = "Cooper (2012) eq. 18-19";
    info.example.inputs[0] = {Quantity::attack_ratio, -0.2};
    info.example.inputs[1] = {Quantity::static_pressure, 700.0};
    info.example.parameters = {0.021279816};
    info.example.value = -2.97917424;
    return info;
  }
};

}  // namespace pcor::effects
