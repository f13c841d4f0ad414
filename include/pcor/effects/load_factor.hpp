#pragma once

#include <pcor/model/effect.hpp>
#include <pcor/physics/constants.hpp>

namespace pcor::effects {

struct LoadFactor {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "load-factor";
    info.title = "static-port error in accelerated flight";
    info.family = "load factor";
    info.location = EffectLocation::static_defect;
    info.formula = "per_g * normal_acceleration / 9.80665";
    info.parameters[0] = {"per_g", "hPa", 0.0, -50.0, 50.0, 1.0};
    info.needs = {Quantity::normal_acceleration, Quantity::count, Quantity::count, Quantity::count};
    info.scalings[0] = {0, 1};  // proportional to q
    info.size = "0.2 to 1 hPa for 0.4 g, estimated; King Air above 1.5 hPa in accelerated flight";
    info.confounders = "static-alpha, static-lag, lams-pod-flex";
    info.manoeuvre = "pitch manoeuvre with two periods, 10 and 30 s; steady turn";
    info.source = "Rodi and Leon, Atmos. Meas. Tech. 5, 2569 (2012)";
    info.example.inputs[0] = {Quantity::normal_acceleration, 1.96133};
    info.example.parameters = {1.5};
    info.example.value = 0.3;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    return parameter[0] * (state[Quantity::normal_acceleration] * S(1.0 / constants::standard_gravity));
  }
};

}  // namespace pcor::effects
