#include "report/shown_flights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pcor::internal {

std::vector<std::size_t> flights_to_show(const std::vector<FlightToShow>& flights, std::size_t most) {
  std::vector<std::size_t> all(flights.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  if (flights.size() <= most) return all;
  all.erase(
      std::remove_if(all.begin(), all.end(), [&](std::size_t f) { return std::isnan(flights[f].failure); }),
      all.end());
  std::stable_sort(all.begin(), all.end(),
                   [&](std::size_t a, std::size_t b) { return flights[a].failure > flights[b].failure; });
  std::vector<std::size_t> chosen(all.begin(),
                                  all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), most / 2)));
  all.erase(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(chosen.size()));
  std::stable_sort(all.begin(), all.end(),
                   [&](std::size_t a, std::size_t b) { return flights[a].begin < flights[b].begin; });
  const std::size_t spread = std::min(all.size(), most - chosen.size());
  for (std::size_t k = 0; k < spread; ++k) chosen.push_back(all[(2 * k + 1) * all.size() / (2 * spread)]);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

std::string shown_text(std::size_t shown, std::size_t flights) {
  if (shown >= flights) return "";
  return fmt::format(
      "The pictures, and what is selected in them, are of {} of the {} flights: those with the largest "
      "residuals, and others spread over the time in which they were flown. All other numbers are of all "
      "flights.",
      shown, flights);
}

}  // namespace pcor::internal
