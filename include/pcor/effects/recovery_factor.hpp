#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct RecoveryFactorError {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "recovery-factor";
    facts.title = "error of the recovery factor";
    facts.family = "recovery";
    facts.where = Where::recovery;
    facts.formula = "da";
    facts.parameters[0] = {"da", "1", 0.0, -0.2, 0.2, 0.01};
    facts.parameters[0].doubt = 0.005;
    facts.size = "0.01 changes delta-p from LAMS by -0.017 hPa (C-130) to -0.11 hPa (GV)";
    facts.look_alikes = "temp-offset, static-qp, static-mach2";
    facts.manoeuvre = "speed run, both branches, at constant temperature";
    facts.source = "Cooper, Recovery factor study, NCAR, October 2014";

    facts.example.parameters = {0.01};
    facts.example.value = 0.01;
    return facts;
  }

  template <class State, class P>
  static auto value(const State&, const P* parameter) {
    return parameter[0];
  }
};

}  // namespace pcor::effects
