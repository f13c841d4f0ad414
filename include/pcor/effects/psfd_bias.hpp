#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct PsfdBias : MinusConstant {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "psfd-bias";
    info.title = "bias of the static transducer";
    info.family = "zero";
    info.location = EffectLocation::static_transducer;
    info.formula = "-offset";
    info.parameters[0] = {"offset", "hPa", 0.0, -50.0, 50.0, 0.1};
    info.parameters[0].calibration_uncertainty = 0.1;
    info.size = "Paroscientific 0.1 hPa; the laser sees 7 to 35 % of it";
    info.confounders = "static-constant, qcf-zero";
    info.manoeuvre =
        "airport pressure on the ramp; hydrostatic height in climbs; a second static and pitot pair";
    info.source = "Cooper (2012), Background";
    info.example.parameters = {0.1};
    info.example.value = -0.1;
    return info;
  }
};

}  // namespace pcor::effects
