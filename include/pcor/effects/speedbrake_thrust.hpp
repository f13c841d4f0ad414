#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct SpeedbrakeThrust {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "speedbrake-thrust";
    info.title = "thrust of the engines and propellers";
    info.family = "thrust";
    info.location = EffectLocation::static_defect;
    info.formula = "defect * engine_torque / 100";
    info.parameters[0] = {"defect", "hPa", 0.0, -50.0, 50.0, 0.5};
    info.needs = {Quantity::engine_torque, Quantity::count, Quantity::count, Quantity::count};
    info.size = "C-130 propwash 0.2 to 1 hPa at full torque, estimated";
    info.confounders = "static-lag, horizontal-gradient, static-alpha";
    info.manoeuvre = "change of power at constant speed and weight: descent against climb at one airspeed";
    info.source = "NCAR memo Recommendation161121; Rodi and Leon, Atmos. Meas. Tech. 5, 2569 (2012)";
    info.example.inputs[0] = {Quantity::engine_torque, 80.0};
    info.example.parameters = {0.5};
    info.example.value = 0.4;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    return parameter[0] * (state[Quantity::engine_torque] * S(0.01));
  }
};

}  // namespace pcor::effects
