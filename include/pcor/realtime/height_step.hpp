#pragma once

#include <pcor/physics/hydrostatic.hpp>
#include <pcor/physics/moist_air.hpp>
#include <pcor/realtime/functor.hpp>

namespace pcor {

/// Step of geopotential height per kelvin (m/K) since the previous sample, from the corrected pressures and
/// the humidity of both: `hydrostatic_step`. NaN at a start, after a gap, and if either pressure is missing:
/// a bit gives the reason, except at the first sample, and if only the previous pressure is missing.
class HeightStep final : public Functor {
 public:
  HeightStep()
      : Functor({Quantity::corrected_static_pressure, Quantity::humidity}, {Quantity::height_step}) {}

  void reset() noexcept override { pressure_ = missing<double>(); }

  void compute(State<double>& state, QualityFlags&) noexcept override {
    const double pressure = state[Quantity::corrected_static_pressure];
    const double humidity = state[Quantity::humidity];
    const double gas_constant = moist_air(0.5 * (humidity_ + humidity)).gas_constant;
    state[Quantity::height_step] = finite_or_missing(hydrostatic_step(pressure_, pressure, gas_constant));
    pressure_ = pressure;
    humidity_ = humidity;
  }

 private:
  double pressure_ = missing<double>();
  double humidity_ = missing<double>();
};

}  // namespace pcor
