#pragma once

namespace pcor::internal {

/// Whether a fit leaves more than there was before: the rms grew by more than 2 %. A refit then asks the rms
/// of the bulk and the held-out flights, too; a what-if has the rms alone.
inline bool is_larger(double rms, double before) {
  constexpr double larger = 1.02;
  return rms > larger * before;
}

}  // namespace pcor::internal
