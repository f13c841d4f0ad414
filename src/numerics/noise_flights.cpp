#include "numerics/noise_flights.hpp"

#include <algorithm>
#include <numeric>

namespace pcor::internal {

std::vector<std::size_t> flights_for_noise(const std::vector<NoiseFlight>& flights, std::size_t maximum) {
  std::vector<std::size_t> all(flights.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  all.erase(std::remove_if(all.begin(), all.end(), [&](std::size_t f) { return flights[f].bins == 0; }),
            all.end());
  if (all.empty() && !flights.empty()) return {0};
  if (all.size() <= maximum) return all;
  const std::size_t bins =
      std::accumulate(flights.begin(), flights.end(), std::size_t{0},
                      [](std::size_t sum, const NoiseFlight& flight) { return sum + flight.bins; });
  const std::size_t count = all.size();
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](std::size_t f) { return 4 * flights[f].bins * count < bins; }),
            all.end());
  std::stable_sort(all.begin(), all.end(),
                   [&](std::size_t a, std::size_t b) { return flights[a].begin < flights[b].begin; });
  const std::size_t every = (all.size() + maximum - 1) / maximum;
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; k < all.size(); k += every) chosen.push_back(all[k]);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace pcor::internal
