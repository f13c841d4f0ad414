#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct StaticAlphaQuad {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "static-alpha-quad";
    facts.title = "non-linear static-port error with the angle of attack";
    facts.family = "attack";
    facts.where = Where::static_defect;
    facts.formula = "a4 * dynamic_ratio * attack^2 * static_pressure";
    facts.parameters[0] = {"a4", "1/deg2", 0.0, -0.2, 0.2, 0.0024};
    facts.needs = {Quantity::dynamic_ratio, Quantity::attack, Quantity::static_pressure, Quantity::count};
    facts.scalings[0] = {1, -1};  // with p instead of q
    facts.size = "C-130 0.00245 (PSFD), 0.00163 (PSFRD): 2.6 hPa at 4 deg, 700 hPa";
    facts.look_alikes = "flaps-gear, pitot-angle, lams-elevation";
    facts.manoeuvre = "pitch manoeuvre at two speeds; slow half of a speed run";
    facts.source = "ARISTO memo eq. 10; NCAR processing algorithms eq. 4.4";
    facts.example.inputs[0] = {Quantity::dynamic_ratio, 0.1};
    facts.example.inputs[1] = {Quantity::attack, 4.0};
    facts.example.inputs[2] = {Quantity::static_pressure, 700.0};
    facts.example.parameters = {0.00245};
    facts.example.value = 2.744;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * (state[Quantity::dynamic_ratio] * state[Quantity::attack] *
                           state[Quantity::attack] * state[Quantity::static_pressure]);
  }
};

}  // namespace pcor::effects
