#pragma once

#include <limits>

namespace pcor::internal {

/// What stands where a series has no value.
inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();

inline constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace pcor::internal
