#pragma once

#include <cmath>

#include <pcor/model/effect.hpp>
#include <pcor/physics/constants.hpp>

namespace pcor::effects {

struct RollStatic {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "roll-static";
    info.title = "left and right static ports differ in turns";
    info.family = "roll";
    info.location = EffectLocation::static_defect;
    info.formula = "defect * sin(roll * pi / 180)";
    info.parameters[0] = {"defect", "hPa", 0.0, -20.0, 20.0, 0.3};
    info.needs = {Quantity::roll, Quantity::count, Quantity::count, Quantity::count};
    info.scalings[0] = {0, 1};  // proportional to q
    info.size = "0 to 0.3 hPa, estimated";
    info.confounders = "lams-azimuth, static-beta-odd, horizontal-gradient";
    info.manoeuvre = "circles to the left and to the right";
    info.source = "NCAR quality-assurance notes, circle manoeuvre";
    info.example.inputs[0] = {Quantity::roll, 30.0};
    info.example.parameters = {0.3};
    info.example.value = 0.15;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    using std::sin;
    return parameter[0] * sin(state[Quantity::roll] * S(constants::radians_per_degree));
  }
};

}  // namespace pcor::effects
