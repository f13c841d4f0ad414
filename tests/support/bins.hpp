#pragma once

#include <cstddef>
#include <vector>

#include "numerics/binning.hpp"

namespace pcor::test {

inline constexpr double bin_step = 4.0;  // s: every record is a bin

inline internal::Binning bins_of(const std::vector<double>& residual) {
  std::vector<double> time(residual.size());
  for (std::size_t i = 0; i < time.size(); ++i) time[i] = 1000.0 + bin_step * static_cast<double>(i);
  return internal::Binning(residual, time, bin_step);
}

}  // namespace pcor::test
