#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct StaticAttack {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "static-attack";
    facts.title = "static-port error with the angle of attack in degrees";
    facts.family = "attack";
    facts.where = Where::static_defect;
    facts.formula = "a3 * attack * static_pressure";
    facts.parameters[0] = {"a3", "1/deg", 0.0, -0.1, 0.1, 0.0014};
    facts.needs = {Quantity::attack, Quantity::static_pressure, Quantity::count, Quantity::count};
    facts.scalings[0] = {-1, 1};  // with q instead of p
    facts.size = "C-130 PSFD 0.00137/deg, PSFRD 0.0005/deg; GV 0.00215/deg";
    facts.look_alikes = "lams-elevation, pitot-angle, adif-drift";
    facts.manoeuvre = "pitch manoeuvre, speed run";
    facts.source = "NCAR processing algorithms eq. 4.4-4.5";
    facts.example.inputs[0] = {Quantity::attack, 3.0};
    facts.example.inputs[1] = {Quantity::static_pressure, 250.0};
    facts.example.parameters = {0.002148};
    facts.example.value = 1.611;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * (state[Quantity::attack] * state[Quantity::static_pressure]);
  }
};

}  // namespace pcor::effects
