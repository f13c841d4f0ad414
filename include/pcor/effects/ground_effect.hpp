#pragma once

#include <pcor/model/effect.hpp>
#include <pcor/physics/scalar.hpp>

namespace pcor::effects {

struct GroundEffect {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "ground-effect";
    info.title = "image of the wing vortices in the ground";
    info.family = "ground effect";
    info.location = EffectLocation::static_defect;
    info.formula = "defect * (span / (4 * max(height_above_ground, span / 4)))^2";
    info.parameters[0] = {"defect", "hPa", 0.0, -20.0, 20.0, 0.3};
    info.parameters[1] = {"span", "m", 40.0, 10.0, 80.0, 40.0, true, {20.0, 28.0, 52.0, 70.0}};
    info.needs = {Quantity::height_above_ground, Quantity::count, Quantity::count, Quantity::count};
    info.size =
        "below 0.5 hPa, and only within one span (C-130 40 m, GV 28 m) of the ground; a sample without "
        "height has no delta-p";
    info.confounders = "flaps-gear";
    info.manoeuvre = "fly-by of a tower or low pass at constant speed";
    info.source = "Gracey, NASA RP-1046; Haering, NASA TM-104316, 1995";
    info.example.inputs[0] = {Quantity::height_above_ground, 20.0};
    info.example.parameters = {0.4, 40.0};
    info.example.value = 0.1;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    using R = Promoted<S, P>;
    const auto height = R(state[Quantity::height_above_ground]);
    const R nearest(parameter[1] * P(0.25));
    const R ratio = nearest / select(height < nearest, nearest, height);
    return parameter[0] * (ratio * ratio);
  }
};

}  // namespace pcor::effects
