#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct LamsElevation {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "lams-elevation";
    facts.title = "error of the elevation of the laser beam";
    facts.family = "beam angle";
    facts.where = Where::beam_elevation;
    facts.formula = "dtheta1";
    facts.parameters[0] = {"dtheta1", "deg", 0.0, -45.0, 45.0, 0.5};
    facts.parameters[0].doubt = 0.3;
    facts.size =
        "pod pitch 1 deg (C-130), 3.5 deg (GV); survey 0.02 to 0.2 deg: 0.12 hPa for 0.5 deg at 6 deg";
    facts.look_alikes = "static-alpha, static-constant";
    facts.manoeuvre = "pitch manoeuvre with a second static pair";
    facts.source = "Cooper (2012), Effect of LAMS orientation";

    facts.example.parameters = {0.5};
    facts.example.value = 0.5;
    return facts;
  }

  template <class State, class P>
  static auto value(const State&, const P* parameter) {
    return parameter[0];
  }
};

}  // namespace pcor::effects
