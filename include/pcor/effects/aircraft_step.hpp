#pragma once

#include <pcor/model/effect.hpp>
#include <pcor/physics/scalar.hpp>

namespace pcor::effects {

struct AircraftStep {
  static constexpr EffectInfo info() {
    EffectInfo info;
    info.id = "aircraft-step";
    info.title = "step of delta-p on a date: something on the aircraft was changed";
    info.family = "step";
    info.location = EffectLocation::static_defect;
    info.formula = "if(date < since, 0, step) * static_pressure";
    info.parameters[0] = {"step", "1", 0.0, -0.5, 0.5, 0.0017};
    info.parameters[1] = {"since", "d", 0.0, -14610.0, 36525.0, 0.0, true};
    info.needs = {Quantity::date, Quantity::static_pressure, Quantity::count, Quantity::count};
    info.size =
        "C-130 1.1 to 1.3 hPa between 2011 and 2016, of unknown cause; since is in days since 2000-01-01";
    info.confounders = "static-constant, psfd-bias, qcf-zero, aircraft-change";
    info.manoeuvre =
        "level legs at one speed, attack and level in both flights, and the avionics pressure in both";
    info.source = "ARISTO memo sec. 4.1 and 4.4";
    info.example.inputs[0] = {Quantity::date, 4324.0};
    info.example.inputs[1] = {Quantity::static_pressure, 700.0};
    info.example.parameters = {0.0017, 4323.5};
    info.example.value = 1.19;
    return info;
  }

  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    using R = Promoted<S, P>;
    const auto date = R(state[Quantity::date]);
    const R after = select(date < R(parameter[1]), R(0.0), R(1.0));
    return parameter[0] * (select(is_missing(date), date, after) * state[Quantity::static_pressure]);
  }
};

}  // namespace pcor::effects
