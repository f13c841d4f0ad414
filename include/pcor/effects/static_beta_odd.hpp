#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct StaticBetaOdd {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "static-beta-odd";
    facts.title = "static-port error with sideslip, ports not perfectly paired";
    facts.family = "sideslip";
    facts.where = Where::static_defect;
    facts.formula = "b1 * sideslip_ratio * static_pressure";
    facts.parameters[0] = {"b1", "1", 0.0, -2.0, 2.0, -0.0018};
    facts.needs = {Quantity::sideslip_ratio, Quantity::static_pressure, Quantity::count, Quantity::count};
    facts.scalings[0] = {-1, 1};  // with q instead of p
    facts.size = "C-130 -0.00177 (PSFD), -0.0008 (PSFRD): -0.37 hPa at 3.7 deg, 700 hPa";
    facts.look_alikes = "lams-azimuth";
    facts.manoeuvre = "yaw manoeuvre";
    facts.source = "Cooper (2012) eq. 19";
    facts.example.inputs[0] = {Quantity::sideslip_ratio, 0.3};
    facts.example.inputs[1] = {Quantity::static_pressure, 700.0};
    facts.example.parameters = {-0.001773};
    facts.example.value = -0.37233;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * (state[Quantity::sideslip_ratio] * state[Quantity::static_pressure]);
  }
};

}  // namespace pcor::effects
