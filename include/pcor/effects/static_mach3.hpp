#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct StaticMach3 {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "static-mach3";
    facts.title = "static-port error with the cube of the Mach number";
    facts.family = "Mach number";
    facts.where = Where::static_defect;
    facts.formula = "m3 * mach^3 * static_pressure";
    facts.parameters[0] = {"m3", "1", 0.0, -2.0, 2.0, -0.09};
    facts.needs = {Quantity::mach, Quantity::static_pressure, Quantity::count, Quantity::count};
    facts.size = "GV -0.0875: -10 hPa at 250 hPa, Mach 0.78, nearly cancelled by static-qp";
    facts.look_alikes =
        "static-qp, static-mach, static-mach2, lams-scale, temp-offset, recovery-factor, qcf-gain";
    facts.manoeuvre = "speed run at two altitudes";
    facts.source = "Cooper (2012) eq. 20; NCAR processing algorithms eq. 4.5";
    facts.example.inputs[0] = {Quantity::mach, 0.75};
    facts.example.inputs[1] = {Quantity::static_pressure, 250.0};
    facts.example.parameters = {-0.2437};
    facts.example.value = -25.702734375;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * (state[Quantity::mach] * state[Quantity::mach] * state[Quantity::mach] *
                           state[Quantity::static_pressure]);
  }
};

}  // namespace pcor::effects
