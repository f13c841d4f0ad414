#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct StaticAttack : Proportional<Quantity::attack, Quantity::static_pressure> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "static-attack";
    info.title = "static-port error with the angle of attack in degrees";
    info.family = "attack";
    info.location = EffectLocation::static_defect;
    info.formula = "a3 * attack * static_pressure";
    info.parameters[0] = {"a3", "1/deg", 0.0, -0.1, 0.1, 0.0014};
    info.needs = {Quantity::attack, Quantity::static_pressure, Quantity::count, Quantity::count};
    info.scalings[0] = {-1, 1};  // q instead of p
    info.size = "C-130 PSFD 0.00137/deg, PSFRD 0.0005/deg; GV 0.00215/deg";
    info.confounders = "lams-elevation, pitot-angle, adif-drift";
    info.manoeuvre = "pitch manoeuvre, speed run";
    info.source = "NCAR processing algorithms eq. 4.4-4.5";
    info.example.inputs[0] = {Quantity::attack, 3.0};
    info.example.inputs[1] = {Quantity::static_pressure, 250.0};
    info.example.parameters = {0.002148};
    info.example.value = 1.611;
    return info;
  }
};

}  // namespace pcor::effects
