#pragma once

#include <pcor/physics/scalar.hpp>

namespace pcor::effects {

/// Cloud indicator: 1 if the `liquid_water` content, g/m3, exceeds 0.05 g/m3, above the zero drift of liquid
/// water probes; otherwise 0; NaN if missing.
template <class S>
S in_cloud(const S& liquid_water) {
  const S cloud = select(liquid_water > S(0.05), S(1.0), S(0.0));
  return select(is_missing(liquid_water), liquid_water, cloud);
}

}  // namespace pcor::effects
