#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct QcfZero {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "qcf-zero";
    facts.title = "zero offset of the dynamic transducer";
    facts.family = "zero";
    facts.where = Where::dynamic_transducer;
    facts.formula = "-offset";
    facts.parameters[0] = {"offset", "hPa", 0.0, -50.0, 50.0, 0.3};
    facts.parameters[0].doubt = 0.3;
    facts.size = "0.34 hPa typical, 0.68 at most (Honeywell PPT); Cooper (2012) has 0.05";
    facts.look_alikes = "static-constant, static-leak, temp-deice-heat, psfd-bias, qcf-gain";
    facts.manoeuvre = "zero on the ramp before taxi; a second static and pitot pair";
    facts.source = "NCAR wind uncertainty technical note table 1; Cooper (2012), Background";
    facts.example.parameters = {0.3};
    facts.example.value = -0.3;
    return facts;
  }

  template <class State, class P>
  static auto value(const State&, const P* parameter) {
    return -parameter[0];
  }
};

}  // namespace pcor::effects
