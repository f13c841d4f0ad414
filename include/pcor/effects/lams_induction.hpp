#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct LamsInduction : Proportional<Quantity::attack, Quantity::lams_airspeed> {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "lams-induction";
    info.title = "flow ahead of the aircraft that changes with the angle of attack";
    info.family = "beam speed";
    info.location = EffectLocation::beam_speed;
    info.formula = "per_attack * attack * lams_airspeed";
    info.parameters[0] = {"per_attack", "1/deg", 0.0, -0.05, 0.05, 0.0005};
    info.needs = {Quantity::attack, Quantity::lams_airspeed, Quantity::count, Quantity::count};
    info.size =
        "-0.5 to -2 m/s (GV, inboard-down beam at 20 m), -0.35 to -0.55 m/s (C-130); the constant part is "
        "lams-scale";
    info.confounders = "lams-scale, lams-elevation, static-alpha";
    info.manoeuvre = "other focus distances; reverse headings at two angles of attack";
    info.source = "NCAR wind uncertainty technical note sec. 2.4.6; ARISTO memo sec. 5";
    info.example.inputs[0] = {Quantity::attack, 4.0};
    info.example.inputs[1] = {Quantity::lams_airspeed, 120.0};
    info.example.parameters = {0.0005};
    info.example.value = 0.24;
    return info;
  }
};

}  // namespace pcor::effects
