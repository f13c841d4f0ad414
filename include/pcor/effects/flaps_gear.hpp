#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct FlapsGear {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "flaps-gear";
    facts.title = "flaps, and the gear that goes with them";
    facts.family = "configuration";
    facts.where = Where::static_defect;
    facts.formula = "defect * flaps / 50";
    facts.parameters[0] = {"defect", "hPa", 0.0, -50.0, 50.0, 1.5};
    facts.needs = {Quantity::flaps, Quantity::count, Quantity::count, Quantity::count};
    facts.scalings[0] = {0, 1};  // with q
    facts.size = "C-130 1.3 to 1.7 hPa with flaps at 50 % and more; GV unknown";
    facts.look_alikes = "static-alpha-quad, ground-effect, pcor-regime";
    facts.manoeuvre = "level leg at one speed, repeated with flaps at 0 and 50 %";
    facts.source = "NCAR nimbus, qcfrc.c (GOTHAAM); Cooper (2012) fig. 2";
    facts.example.inputs[0] = {Quantity::flaps, 25.0};
    facts.example.parameters = {1.5};
    facts.example.value = 0.75;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    return parameter[0] * (state[Quantity::flaps] * S(0.02));
  }
};

}  // namespace pcor::effects
