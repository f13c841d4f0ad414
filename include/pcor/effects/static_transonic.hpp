#pragma once

#include <pcor/model/effect.hpp>
#include <pcor/physics/scalar.hpp>

namespace pcor::effects {

struct StaticTransonic {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "static-transonic";
    info.title = "supersonic pocket near the static port at high Mach number";
    info.family = "Mach number";
    info.location = EffectLocation::static_defect;
    info.formula = "strength * max(mach - onset, 0)^2 * static_pressure";
    info.parameters[0] = {"strength", "1", 0.0, -100.0, 100.0, 1.0};
    info.parameters[1] = {"onset", "1", 0.82, 0.7, 0.95, 0.82, true, {0.74, 0.8, 0.85, 0.91}};
    info.needs = {Quantity::mach, Quantity::static_pressure, Quantity::count, Quantity::count};
    info.size = "estimated 0.1 to 1 hPa on the GV from Mach 0.82 to 0.86";
    info.confounders = "static-mach3, static-mach2, lams-fold";
    info.manoeuvre = "speed run past Mach 0.82 at high altitude; one Mach number at two angles of attack";
    info.source = "Haering, NASA TM-104316, 1995; Gracey, NASA RP-1046";
    info.example.inputs[0] = {Quantity::mach, 0.86};
    info.example.inputs[1] = {Quantity::static_pressure, 250.0};
    info.example.parameters = {1.0, 0.82};
    info.example.value = 0.4;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    using R = Promoted<S, P>;
    const R above = state[Quantity::mach] - parameter[1];
    const R excess = select(above < R(0.0), R(0.0), above);
    return parameter[0] * (excess * excess * state[Quantity::static_pressure]);
  }
};

}  // namespace pcor::effects
