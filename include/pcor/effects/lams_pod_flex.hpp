#pragma once

#include <pcor/model/effect.hpp>
#include <pcor/physics/constants.hpp>

namespace pcor::effects {

struct LamsPodFlex {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "lams-pod-flex";
    facts.title = "the wing bends under load and turns the laser pod";
    facts.family = "beam angle";
    facts.where = Where::beam_elevation;
    facts.formula = "per_g * normal_acceleration / 9.80665";
    facts.parameters[0] = {"per_g", "deg", 0.0, -45.0, 45.0, 0.3};
    facts.needs = {Quantity::normal_acceleration, Quantity::count, Quantity::count, Quantity::count};
    facts.size =
        "0.1 to 0.5 deg, estimated; the part that follows the fuel needs the mass of the aircraft and stays "
        "in time-drift";
    facts.look_alikes = "load-factor, lams-elevation, time-drift";
    facts.manoeuvre = "circles, pitch manoeuvre; attitude sensor in the pod";
    facts.source = "NCAR wind uncertainty technical note sec. 2.3-2.4";
    facts.example.inputs[0] = {Quantity::normal_acceleration, 4.903325};
    facts.example.parameters = {0.3};
    facts.example.value = 0.15;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    return parameter[0] * (state[Quantity::normal_acceleration] * S(1.0 / constants::standard_gravity));
  }
};

}  // namespace pcor::effects
