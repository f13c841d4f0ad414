#pragma once

#include <pcor/physics/scalar.hpp>

namespace pcor::effects {

/// 1 where the `liquid_water` content, g/m3, is that of a cloud, else 0; NaN where it is missing. Above 0.05
/// g/m3 a probe of liquid water shows more than its zero drifts.
template <class S>
S in_cloud(const S& liquid_water) {
  const S cloud = select(liquid_water > S(0.05), S(1.0), S(0.0));
  return select(is_missing(liquid_water), liquid_water, cloud);
}

}  // namespace pcor::effects
