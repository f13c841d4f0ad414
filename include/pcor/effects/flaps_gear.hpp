#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct FlapsGear {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "flaps-gear";
    info.title = "flaps and landing gear";
    info.family = "configuration";
    info.location = EffectLocation::static_defect;
    info.formula = "defect * flaps / 50";
    info.parameters[0] = {"defect", "hPa", 0.0, -50.0, 50.0, 1.5};
    info.needs = {Quantity::flaps, Quantity::count, Quantity::count, Quantity::count};
    info.scalings[0] = {0, 1};  // proportional to q
    info.size = "C-130 1.3 to 1.7 hPa with flaps at 50 % and more; GV unknown";
    info.confounders = "static-alpha-quad, ground-effect, pcor-regime";
    info.manoeuvre = "level leg at one speed, repeated with flaps at 0 and 50 %";
    info.source = "NCAR nimbus, qcfrc.c (GOTHAAM); Cooper (2012) fig. 2";
    info.example.inputs[0] = {Quantity::flaps, 25.0};
    info.example.parameters = {1.5};
    info.example.value = 0.75;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    return parameter[0] * (state[Quantity::flaps] * S(0.02));
  }
};

}  // namespace pcor::effects
