#include "regimes/search.hpp"

namespace pcor::internal {

std::vector<Found> find_clouds(const Cells& cells, const std::vector<bool>& flying,
                               const RegimeCriteria& criteria) {
  const std::vector<Run> wet = runs_where(cells.count(), [&](std::size_t i) {
    return flying[i] && cells.liquid_water[i] >= criteria.cloud_liquid_water;
  });
  std::vector<Found> found;
  for (const Run& run : bridged(wet, cells_in(criteria.bridged))) found.push_back({Regime::cloud, run});
  return found;
}

}  // namespace pcor::internal
