#pragma once

#include <cstddef>
#include <vector>

namespace pcor {

/// A series at the rate of its sensor: some samples in each record.
struct FastSeries {
  std::vector<double> values{};
  std::size_t in_record = 1;
  double min_period = 0.0;  ///< s, to which its rates go
};

}  // namespace pcor
