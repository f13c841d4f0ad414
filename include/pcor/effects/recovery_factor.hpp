#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct RecoveryFactorError : Constant {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "recovery-factor";
    info.title = "error of the recovery factor";
    info.family = "recovery";
    info.location = EffectLocation::recovery;
    info.formula = "da";
    info.parameters[0] = {"da", "1", 0.0, -0.2, 0.2, 0.01};
    info.parameters[0].calibration_uncertainty = 0.005;
    info.size = "0.01 changes delta-p from LAMS by -0.017 hPa (C-130) to -0.11 hPa (GV)";
    info.confounders = "temp-offset, static-qp, static-mach2";
    info.manoeuvre = "speed run, both branches, at constant temperature";
    info.source = "Cooper, Recovery factor study, NCAR, October 2014";

    info.example.parameters = {0.01};
    info.example.value = 0.01;
    return info;
  }
};

}  // namespace pcor::effects
