#pragma once

#include "numerics/binning.hpp"

namespace pcor::internal {

/// Whether two series were measured at the same time, as those of several references of one flight are.
inline bool is_of_same_time(const Binning& a, const Binning& b) {
  return a.size() > 0 && b.size() > 0 && a.time().front() < b.time().back() &&
         b.time().front() < a.time().back();
}

}  // namespace pcor::internal
