#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

struct LamsScale {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "lams-scale";
    facts.title = "scale of the airspeed from the laser";
    facts.family = "beam speed";
    facts.where = Where::beam_speed;
    facts.formula = "-scale * lams_airspeed";
    facts.parameters[0] = {"scale", "1", 0.0, -0.5, 0.5, 0.001};
    facts.parameters[0].doubt = 0.002;
    facts.needs = {Quantity::lams_airspeed, Quantity::count, Quantity::count, Quantity::count};
    facts.size =
        "calibration within 0.1 m/s; index of refraction 0.024 m/s at 700 hPa; the constant part of the flow "
        "ahead of the aircraft 0.004";
    facts.look_alikes = "static-mach2, static-qp, temp-offset, qcf-gain, lams-induction";
    facts.manoeuvre = "reverse headings and circles only";
    facts.source = "NCAR wind uncertainty technical note sec. 2.4.5";
    facts.example.inputs[0] = {Quantity::lams_airspeed, 120.0};
    facts.example.parameters = {0.001};
    facts.example.value = -0.12;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return -(parameter[0] * state[Quantity::lams_airspeed]);
  }
};

}  // namespace pcor::effects
