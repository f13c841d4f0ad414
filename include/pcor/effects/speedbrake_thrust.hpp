#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct SpeedbrakeThrust {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "speedbrake-thrust";
    facts.title = "thrust of the engines and propellers";
    facts.family = "thrust";
    facts.where = Where::static_defect;
    facts.formula = "defect * engine_torque / 100";
    facts.parameters[0] = {"defect", "hPa", 0.0, -50.0, 50.0, 0.5};
    facts.needs = {Quantity::engine_torque, Quantity::count, Quantity::count, Quantity::count};
    facts.size = "C-130 propwash 0.2 to 1 hPa at full torque, estimated";
    facts.look_alikes = "static-lag, horizontal-gradient, static-alpha";
    facts.manoeuvre = "change of power at constant speed and weight: descent against climb at one airspeed";
    facts.source = "NCAR memo Recommendation161121; Rodi and Leon, Atmos. Meas. Tech. 5, 2569 (2012)";
    facts.example.inputs[0] = {Quantity::engine_torque, 80.0};
    facts.example.parameters = {0.5};
    facts.example.value = 0.4;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    return parameter[0] * (state[Quantity::engine_torque] * S(0.01));
  }
};

}  // namespace pcor::effects
