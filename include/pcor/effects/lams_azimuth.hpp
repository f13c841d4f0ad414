#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct LamsAzimuth {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "lams-azimuth";
    facts.title = "error of the azimuth of the laser beam";
    facts.family = "beam angle";
    facts.where = Where::beam_azimuth;
    facts.formula = "dtheta2";
    facts.parameters[0] = {"dtheta2", "deg", 0.0, -45.0, 45.0, 0.5};
    facts.parameters[0].doubt = 0.3;
    facts.size = "survey 0.02 to 0.2 deg: 0.15 m/s for 0.5 deg at 4 deg of sideslip";
    facts.look_alikes = "static-beta-odd, roll-static";
    facts.manoeuvre = "yaw manoeuvre with a second static pair";
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
