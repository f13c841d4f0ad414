#pragma once

#include <pcor/model/effect.hpp>
#include <pcor/physics/constants.hpp>

namespace pcor::effects {

struct TempCalibration {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "temp-calibration";
    info.title = "calibration of the ambient temperature";
    info.family = "zero";
    info.location = EffectLocation::ambient_temperature;
    info.formula = "a0 + a1 * (ambient_temperature - 273.15) + a2 * (ambient_temperature - 273.15)^2";
    info.parameters[0] = {"a0", "K", 0.0, -5.0, 5.0, 0.5};
    info.parameters[1] = {"a1", "1", 0.0, -0.05, 0.05, 0.005};
    info.parameters[2] = {"a2", "1/K", 0.0, -0.001, 0.001, 0.0001};
    info.needs = {Quantity::ambient_temperature, Quantity::count, Quantity::count, Quantity::count};
    info.size = "0.3 to 0.55 K and a slope to 0.01: 0.24 hPa/K (C-130), 0.42 hPa/K (GV)";
    info.confounders =
        "temp-offset, recovery-factor, lams-scale, qcf-gain, temp-deice-heat, humidity-neglected, "
        "horizontal-gradient, hydrostatic-t-gradient, gps-height";
    info.manoeuvre =
        "climbs and descents through many temperatures, there and back, with GPS height: pcor temperature "
        "finds it by the hydrostatic equation";
    info.source = "Cooper (2012) eq. 24 and its addition on the GV: T + a0 + a1 T + a2 T^2, T in degC";
    info.example.inputs[0] = {Quantity::ambient_temperature, 253.15};
    info.example.parameters = {0.55, 0.01, 0.00025};
    info.example.value = 0.45;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    const S celsius = state[Quantity::ambient_temperature] - S(constants::ice_point);
    return parameter[0] + celsius * (parameter[1] + parameter[2] * celsius);
  }
};

}  // namespace pcor::effects
