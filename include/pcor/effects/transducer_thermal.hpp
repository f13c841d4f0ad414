#pragma once

#include <pcor/effects/shared_formulas.hpp>

namespace pcor::effects {

struct TransducerThermal : MinusThermalDrift {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "transducer-thermal";
    info.title = "drift of the dynamic transducer with its temperature";
    info.family = "thermal drift";
    info.location = EffectLocation::dynamic_transducer;
    info.formula = "-per_kelvin * (transducer_temperature - 290) - zero";
    info.parameters[0] = {"per_kelvin", "hPa/K", 0.0, -2.0, 2.0, 0.02};
    info.parameters[1] = {"zero", "hPa", 0.0, -50.0, 50.0, 0.1};
    info.needs = {Quantity::transducer_temperature, Quantity::count, Quantity::count, Quantity::count};
    info.size = "estimated 0.01 to 0.03 hPa/K; zero is the error at 290 K";
    info.confounders = "adif-drift, time-drift, qcf-zero";
    info.manoeuvre = "level legs early and late at one speed, attack and level";
    info.source = "Haering, NASA TM-104316, 1995; estimate";
    info.example.inputs[0] = {Quantity::transducer_temperature, 300.0};
    info.example.parameters = {0.02, 0.1};
    info.example.value = -0.3;
    return info;
  }
};

}  // namespace pcor::effects
