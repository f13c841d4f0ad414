#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct AdifDrift {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "adif-drift";
    info.title = "change of the zero or the sensitivity of the radome";
    info.family = "drift";
    info.location = EffectLocation::attack_ratio;
    info.formula = "-(gain * attack_ratio + offset + per_hour * time / 3600)";
    info.parameters[0] = {"gain", "1", 0.0, -2.0, 2.0, 0.05};
    info.parameters[1] = {"offset", "1", 0.0, -0.5, 0.5, 0.01};
    info.parameters[2] = {"per_hour", "1/h", 0.0, -0.5, 0.5, 0.005};
    info.needs = {Quantity::attack_ratio, Quantity::time, Quantity::count, Quantity::count};
    info.size =
        "slope 13.85 to 16.0 from flight to flight (C-130): 5 % of a ratio of 0.25 is 0.19 hPa at 700 hPa";
    info.confounders = "static-alpha, transducer-thermal, lams-elevation, qcr-angle";
    info.manoeuvre = "angle of attack from pitch and vertical speed in a speed run";
    info.source = "NCAR memos AKRDC130 and PcorCalculation eq. 4-6; ARISTO memo table 2";
    info.example.inputs[0] = {Quantity::attack_ratio, -0.2};
    info.example.inputs[1] = {Quantity::time, 7200.0};
    info.example.parameters = {0.05, 0.01, 0.005};
    info.example.value = -0.01;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    return -(parameter[0] * state[Quantity::attack_ratio] + parameter[1] +
             parameter[2] * (state[Quantity::time] * S(1.0 / 3600.0)));
  }
};

}  // namespace pcor::effects
