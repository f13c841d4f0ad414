#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct LamsAzimuth : Constant {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "lams-azimuth";
    info.title = "error of the azimuth of the laser beam";
    info.family = "beam angle";
    info.location = EffectLocation::beam_azimuth;
    info.formula = "dtheta2";
    info.parameters[0] = {"dtheta2", "deg", 0.0, -45.0, 45.0, 0.5};
    info.parameters[0].calibration_uncertainty = 0.3;
    info.size = "survey 0.02 to 0.2 deg: 0.15 m/s for 0.5 deg at 4 deg of sideslip";
    info.confounders = "static-beta-odd, roll-static";
    info.manoeuvre = "yaw manoeuvre with a second static pair";
    info.source = "Cooper (2012), Effect of LAMS orientation";
    info.example.parameters = {0.5};
    info.example.value = 0.5;
    return info;
  }
};

}  // namespace pcor::effects
