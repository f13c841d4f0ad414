#pragma once

#include <pcor/model/effect.hpp>
#include <pcor/physics/constants.hpp>

namespace pcor::effects {

struct LineHead {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "line-head";
    info.title = "weight and inertia of the air in the static line";
    info.family = "load factor";
    info.location = EffectLocation::static_line;
    info.formula =
        "-(aft * longitudinal_acceleration + below * (9.80665 + normal_acceleration)) * static_pressure / "
        "(8314.462618 / 28.9637 * 290)";
    info.parameters[0] = {"aft", "m", 0.0, -60.0, 60.0, 5.0};
    info.parameters[1] = {"below", "m", 0.0, -20.0, 20.0, 1.0};
    info.needs = {Quantity::longitudinal_acceleration, Quantity::normal_acceleration,
                  Quantity::static_pressure, Quantity::count};
    info.size =
        "0.12 hPa for each metre at sea level, 0.04 at 300 hPa, with the transducer at aft and below behind "
        "and under the port; the line lies in the cabin, so its air is at 290 K";
    info.confounders = "load-factor, static-alpha, static-constant";
    info.manoeuvre = "acceleration at constant angle of attack";
    info.source = "hydrostatics of the line, dp = rho a h; estimate";
    info.example.inputs[0] = {Quantity::longitudinal_acceleration, 2.0};
    info.example.inputs[1] = {Quantity::normal_acceleration, 1.19335};
    info.example.inputs[2] = {Quantity::static_pressure, 2.9 * constants::gas_constant_dry_air};
    info.example.parameters = {5.0, 1.0};
    info.example.value = -0.21;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    // 1/(R T) of the air in the line, s2/m2
    constexpr double line = 1.0 / (constants::gas_constant_dry_air * 290.0);
    return -((parameter[0] * state[Quantity::longitudinal_acceleration] +
              parameter[1] * (state[Quantity::normal_acceleration] + S(constants::standard_gravity))) *
             (state[Quantity::static_pressure] * S(line)));
  }
};

}  // namespace pcor::effects
