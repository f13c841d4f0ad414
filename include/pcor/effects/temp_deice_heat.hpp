#pragma once

#include <cmath>

#include <pcor/model/effect.hpp>
#include <pcor/physics/scalar.hpp>

namespace pcor::effects {

struct TempDeiceHeat {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "temp-deice-heat";
    info.title = "heat of the de-icing in a heated thermometer";
    info.family = "heating";
    info.location = EffectLocation::temperature;
    info.formula =
        "-scale * 10^(-1.7841 * log10(max(0.26959 * static_pressure * mach * (1 + mach^2 / 5) / "
        "recovery_temperature, 0.18)) - 1.4025)";
    info.parameters[0] = {"scale", "1", 0.0, 0.0, 20.0, 1.0};
    info.needs = {Quantity::static_pressure, Quantity::mach, Quantity::recovery_temperature, Quantity::count};
    info.size = "0.38 to 0.84 K over the envelope; less with the constants of the GV, for which scale is 0.6";
    info.confounders = "temp-offset, qcf-zero, static-leak";
    info.manoeuvre = "heater off and on; two thermometers";
    info.source =
        "NCAR nimbus, atfh.c and initAC.c (Rosemount 102DB1CB): 10^(-1.7841 log10 Z - 1.4025), Z = 0.26959 p "
        "M/T";
    info.example.inputs[0] = {Quantity::static_pressure, 700.0};
    info.example.inputs[1] = {Quantity::mach, 0.36};
    info.example.inputs[2] = {Quantity::recovery_temperature, 275.0};
    info.example.parameters = {1.0};
    info.example.value = -0.4581720094401175;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    using std::exp;
    using std::log;
    constexpr double ln10 = 2.302585092994045684;
    const auto& mach = state[Quantity::mach];
    const S density = state[Quantity::static_pressure] * mach * (mach * mach * S(0.2) + S(1.0)) /
                      state[Quantity::recovery_temperature] * S(0.26959);
    const S flow = select(density < S(0.18), S(0.18), density);
    return -(parameter[0] * exp(log(flow) * S(-1.7841) + S(-1.4025 * ln10)));
  }
};

}  // namespace pcor::effects
