#pragma once

#include <pcor/model/effect.hpp>
#include <pcor/physics/constants.hpp>

namespace pcor::effects {

struct TempOffset {
  static constexpr EffectFacts facts() {
    EffectFacts facts;
    facts.id = "temp-offset";
    facts.title = "offset and slope of the thermometer";
    facts.family = "zero";
    facts.where = Where::temperature;
    facts.formula = "-(offset + slope * (recovery_temperature - 273.15))";
    facts.parameters[0] = {"offset", "K", 0.0, -50.0, 50.0, 0.5};
    facts.parameters[1] = {"slope", "1", 0.0, -0.5, 0.5, 0.005};
    facts.parameters[0].doubt = 0.3;
    facts.needs = {Quantity::recovery_temperature, Quantity::count, Quantity::count, Quantity::count};
    facts.size = "0.3 to 0.55 K: 0.24 hPa/K (C-130), 0.42 hPa/K (GV)";
    facts.look_alikes =
        "lams-scale, qcf-gain, temp-deice-heat, recovery-factor, humidity-neglected, horizontal-gradient";
    facts.manoeuvre = "hydrostatic height in climbs and descents";
    facts.source = "Cooper (2012), table of temperatures; Cooper et al., Atmos. Meas. Tech. 7, 3215 (2014)";
    facts.example.inputs[0] = {Quantity::recovery_temperature, 263.15};
    facts.example.parameters = {0.5, 0.005};
    facts.example.value = -0.45;
    return facts;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    return -(parameter[0] + parameter[1] * (state[Quantity::recovery_temperature] - S(constants::ice_point)));
  }
};

}  // namespace pcor::effects
