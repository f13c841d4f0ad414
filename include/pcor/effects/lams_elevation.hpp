#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct LamsElevation : Constant {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "lams-elevation";
    info.title = "error of the elevation of the laser beam";
    info.family = "beam angle";
    info.location = EffectLocation::beam_elevation;
    info.formula = "dtheta1";
    info.parameters[0] = {"dtheta1", "deg", 0.0, -45.0, 45.0, 0.5};
    info.parameters[0].calibration_uncertainty = 0.3;
    info.size =
        "pod pitch 1 deg (C-130), 3.5 deg (GV); survey 0.02 to 0.2 deg: 0.12 hPa for 0.5 deg at 6 deg";
    info.confounders = "static-alpha, static-constant";
    info.manoeuvre = "pitch manoeuvre with a second static pair";
    info.source = "Cooper (2012), Effect of LAMS orientation";

    info.example.parameters = {0.5};
    info.example.value = 0.5;
    return info;
  }
};

}  // namespace pcor::effects
