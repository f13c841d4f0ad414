#pragma once

#include <pcor/model/effect.hpp>
#include <pcor/physics/constants.hpp>

namespace pcor::effects {

struct LamsPodFlex {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "lams-pod-flex";
    info.title = "the wing bends under load and turns the laser pod";
    info.family = "beam angle";
    info.location = EffectLocation::beam_elevation;
    info.formula = "per_g * normal_acceleration / 9.80665";
    info.parameters[0] = {"per_g", "deg", 0.0, -45.0, 45.0, 0.3};
    info.needs = {Quantity::normal_acceleration, Quantity::count, Quantity::count, Quantity::count};
    info.size =
        "0.1 to 0.5 deg, estimated; the part that follows the fuel needs the mass of the aircraft and stays "
        "in time-drift";
    info.confounders = "load-factor, lams-elevation, time-drift";
    info.manoeuvre = "circles, pitch manoeuvre; attitude sensor in the pod";
    info.source = "NCAR wind uncertainty technical note sec. 2.3-2.4";
    info.example.inputs[0] = {Quantity::normal_acceleration, 4.903325};
    info.example.parameters = {0.3};
    info.example.value = 0.15;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    return parameter[0] * (state[Quantity::normal_acceleration] * S(1.0 / constants::standard_gravity));
  }
};

}  // namespace pcor::effects
