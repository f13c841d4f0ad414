#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct QcfZero : MinusConstant {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "qcf-zero";
    info.title = "zero offset of the dynamic transducer";
    info.family = "zero";
    info.location = EffectLocation::dynamic_transducer;
    info.formula = "-offset";
    info.parameters[0] = {"offset", "hPa", 0.0, -50.0, 50.0, 0.3};
    info.parameters[0].calibration_uncertainty = 0.3;
    info.size = "0.34 hPa typical, 0.68 at most (Honeywell PPT); Cooper (2012) has 0.05";
    info.confounders = "static-constant, static-leak, temp-deice-heat, psfd-bias, qcf-gain";
    info.manoeuvre = "zero on the ramp before taxi; a second static and pitot pair";
    info.source = "NCAR wind uncertainty technical note table 1; Cooper (2012), Background";
    info.example.parameters = {0.3};
    info.example.value = -0.3;
    return info;
  }
};

}  // namespace pcor::effects
