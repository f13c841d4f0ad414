#pragma once

#include <pcor/model/effect.hpp>
#include <pcor/physics/constants.hpp>

namespace pcor::effects {

struct LineHead {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "line-head";
    facts.title = "weight and inertia of the air in the static line";
    facts.family = "load factor";
    facts.where = Where::static_line;
    facts.formula =
        "-(aft * longitudinal_acceleration + below * (9.80665 + normal_acceleration)) * static_pressure / "
        "(8314.462618 / 28.9637 * 290)";
    facts.parameters[0] = {"aft", "m", 0.0, -60.0, 60.0, 5.0};
    facts.parameters[1] = {"below", "m", 0.0, -20.0, 20.0, 1.0};
    facts.needs = {Quantity::longitudinal_acceleration, Quantity::normal_acceleration,
                   Quantity::static_pressure, Quantity::count};
    facts.size =
        "0.12 hPa for each metre at sea level, 0.04 at 300 hPa, with the transducer at aft and below behind "
        "and under the port; the line lies in the cabin, so its air is at 290 K";
    facts.look_alikes = "load-factor, static-alpha, static-constant";
    facts.manoeuvre = "acceleration at constant angle of attack";
    facts.source = "hydrostatics of the line, dp = rho a h; estimate";
    facts.example.inputs[0] = {Quantity::longitudinal_acceleration, 2.0};
    facts.example.inputs[1] = {Quantity::normal_acceleration, 1.19335};
    facts.example.inputs[2] = {Quantity::static_pressure, 2.9 * constants::gas_constant_dry_air};
    facts.example.parameters = {5.0, 1.0};
    facts.example.value = -0.21;
    return facts;
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
