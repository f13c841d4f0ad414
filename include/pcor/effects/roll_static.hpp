#pragma once

#include <cmath>

#include <pcor/model/effect.hpp>
#include <pcor/physics/constants.hpp>

namespace pcor::effects {

struct RollStatic {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "roll-static";
    facts.title = "left and right static ports differ in turns";
    facts.family = "roll";
    facts.where = Where::static_defect;
    facts.formula = "defect * sin(roll * pi / 180)";
    facts.parameters[0] = {"defect", "hPa", 0.0, -20.0, 20.0, 0.3};
    facts.needs = {Quantity::roll, Quantity::count, Quantity::count, Quantity::count};
    facts.scalings[0] = {0, 1};  // with q
    facts.size = "0 to 0.3 hPa, estimated";
    facts.look_alikes = "lams-azimuth, static-beta-odd, horizontal-gradient";
    facts.manoeuvre = "circles to the left and to the right";
    facts.source = "NCAR quality-assurance notes, circle manoeuvre";
    facts.example.inputs[0] = {Quantity::roll, 30.0};
    facts.example.parameters = {0.3};
    facts.example.value = 0.15;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    using std::sin;
    return parameter[0] * sin(state[Quantity::roll] * S(constants::radians_per_degree));
  }
};

}  // namespace pcor::effects
