#pragma once

#include <pcor/model/effect.hpp>
#include <pcor/physics/constants.hpp>

namespace pcor::effects {

struct TempOffset {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "temp-offset";
    info.title = "offset and slope of the thermometer";
    info.family = "zero";
    info.location = EffectLocation::temperature;
    info.formula = "-(offset + slope * (recovery_temperature - 273.15))";
    info.parameters[0] = {"offset", "K", 0.0, -50.0, 50.0, 0.5};
    info.parameters[1] = {"slope", "1", 0.0, -0.5, 0.5, 0.005};
    info.parameters[0].calibration_uncertainty = 0.3;
    info.needs = {Quantity::recovery_temperature, Quantity::count, Quantity::count, Quantity::count};
    info.size = "0.3 to 0.55 K: 0.24 hPa/K (C-130), 0.42 hPa/K (GV)";
    info.confounders =
        "lams-scale, qcf-gain, temp-deice-heat, recovery-factor, humidity-neglected, horizontal-gradient";
    info.manoeuvre = "hydrostatic height in climbs and descents";
    info.source = "Cooper (2012), table of temperatures; Cooper et al., Atmos. Meas. Tech. 7, 3215 (2014)";
    info.example.inputs[0] = {Quantity::recovery_temperature, 263.15};
    info.example.parameters = {0.5, 0.005};
    info.example.value = -0.45;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    return -(parameter[0] + parameter[1] * (state[Quantity::recovery_temperature] - S(constants::ice_point)));
  }
};

}  // namespace pcor::effects
