#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct StaticAlpha {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "static-alpha";
    facts.title = "static-port error with the angle of attack, as the radome ratio";
    facts.family = "attack";
    facts.where = Where::static_defect;
    facts.formula = "a1 * attack_ratio * static_pressure";
    facts.parameters[0] = {"a1", "1", 0.0, -2.0, 2.0, 0.0213};
    facts.needs = {Quantity::attack_ratio, Quantity::static_pressure, Quantity::count, Quantity::count};
    facts.scalings[0] = {-1, 1};  // with q instead of p
    facts.size = "C-130 PSFD 0.0213, 1 hPa/deg at 700 hPa; PSFRD 0.0089";
    facts.look_alikes = "lams-elevation, pitot-angle, adif-drift";
    facts.manoeuvre = "pitch manoeuvre, speed run";
    facts.source = "Cooper (2012) eq. 18-19";
    facts.example.inputs[0] = {Quantity::attack_ratio, -0.2};
    facts.example.inputs[1] = {Quantity::static_pressure, 700.0};
    facts.example.parameters = {0.021279816};
    facts.example.value = -2.97917424;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * (state[Quantity::attack_ratio] * state[Quantity::static_pressure]);
  }
};

}  // namespace pcor::effects
