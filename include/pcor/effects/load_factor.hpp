#pragma once

#include <pcor/model/effect.hpp>
#include <pcor/physics/constants.hpp>

namespace pcor::effects {

struct LoadFactor {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "load-factor";
    facts.title = "static-port error in accelerated flight";
    facts.family = "load factor";
    facts.where = Where::static_defect;
    facts.formula = "per_g * normal_acceleration / 9.80665";
    facts.parameters[0] = {"per_g", "hPa", 0.0, -50.0, 50.0, 1.0};
    facts.needs = {Quantity::normal_acceleration, Quantity::count, Quantity::count, Quantity::count};
    facts.scalings[0] = {0, 1};  // with q
    facts.size = "0.2 to 1 hPa for 0.4 g, estimated; King Air above 1.5 hPa in accelerated flight";
    facts.look_alikes = "static-alpha, static-lag, lams-pod-flex";
    facts.manoeuvre = "pitch manoeuvre with two periods, 10 and 30 s; steady turn";
    facts.source = "Rodi and Leon, Atmos. Meas. Tech. 5, 2569 (2012)";
    facts.example.inputs[0] = {Quantity::normal_acceleration, 1.96133};
    facts.example.parameters = {1.5};
    facts.example.value = 0.3;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    return parameter[0] * (state[Quantity::normal_acceleration] * S(1.0 / constants::standard_gravity));
  }
};

}  // namespace pcor::effects
