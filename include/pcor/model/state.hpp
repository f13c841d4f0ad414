#pragma once

#include <array>

#include <pcor/model/quantity.hpp>
#include <pcor/physics/scalar.hpp>

namespace pcor {

/// Values of all quantities at one sample, in the units of `quantity_info`; unknown ones are NaN.
template <class S>
class State {
 public:
  using Scalar = S;

  State() { values_.fill(missing<S>()); }

  S& operator[](Quantity quantity) { return values_[index(quantity)]; }
  const S& operator[](Quantity quantity) const { return values_[index(quantity)]; }

 private:
  std::array<S, state_capacity> values_;
};

}  // namespace pcor
