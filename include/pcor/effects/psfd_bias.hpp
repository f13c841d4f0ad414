#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct PsfdBias {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "psfd-bias";
    facts.title = "bias of the static transducer";
    facts.family = "zero";
    facts.where = Where::static_transducer;
    facts.formula = "-offset";
    facts.parameters[0] = {"offset", "hPa", 0.0, -50.0, 50.0, 0.1};
    facts.parameters[0].doubt = 0.1;
    facts.size = "Paroscientific 0.1 hPa; the laser sees 7 to 35 % of it";
    facts.look_alikes = "static-constant, qcf-zero";
    facts.manoeuvre =
        "airport pressure on the ramp; hydrostatic height in climbs; a second static and pitot pair";
    facts.source = "Cooper (2012), Background";
    facts.example.parameters = {0.1};
    facts.example.value = -0.1;
    return facts;
  }

  template <class State, class P>
  static auto value(const State&, const P* parameter) {
    return -parameter[0];
  }
};

}  // namespace pcor::effects
