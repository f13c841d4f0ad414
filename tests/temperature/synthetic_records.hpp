#pragma once

#include <algorithm>

#include "support/synthetic_air.hpp"
#include "temperature/height_record.hpp"

namespace made {

inline HeightRecord record_of(const AirPlan& plan) { return height_record(air(plan), {}, {}); }

inline double range_of_excess(const HeightRecord& record) {
  const auto [minimum, maximum] =
      std::minmax_element(record.blocks.begin(), record.blocks.end(),
                          [](const HeightBlock& a, const HeightBlock& b) { return a.excess < b.excess; });
  return maximum->excess - minimum->excess;
}

}  // namespace made
