#pragma once

#include <pcor/model/effect.hpp>

namespace pcor::effects {

// Formulas that several effects share, of the coefficients k0 and k1: an effect with such a base defines only
// `info()`. A formula with a minus corrects an error of a sensor.

/// k0
struct Constant {
  template <class State, class P>
  static auto value(const State&, const P* parameter) {
    return parameter[0];
  }
};

/// -k0
struct MinusConstant {
  template <class State, class P>
  static auto value(const State&, const P* parameter) {
    return -parameter[0];
  }
};

/// k0 times the product of quantities
template <Quantity... factors>
struct Proportional {
  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return parameter[0] * (... * state[factors]);
  }
};

/// -k0 times a quantity
template <Quantity factor>
struct MinusProportional {
  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    return -(parameter[0] * state[factor]);
  }
};

/// -k0 times the time, h
struct MinusDrift {
  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    return -(parameter[0] * (state[Quantity::time] * S(1.0 / 3600.0)));
  }
};

/// -k0 times the temperature of the transducer above 290 K, minus k1
struct MinusThermalDrift {
  template <class State, class P>
  static auto value(const State& state, const P* parameter) {
    using S = typename State::Scalar;
    return -(parameter[0] * (state[Quantity::transducer_temperature] - S(290.0)) + parameter[1]);
  }
};

}  // namespace pcor::effects
