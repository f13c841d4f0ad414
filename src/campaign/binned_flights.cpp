#include "campaign/binned_flights.hpp"

#include <algorithm>

#include "campaign/linear_rows.hpp"

namespace pcor::internal {
std::size_t BinnedFlights::first_count() const {
  return static_cast<std::size_t>(
      std::find_if(reference.begin(), reference.end(), [](std::size_t r) { return r != 0; }) -
      reference.begin());
}

BinnedFlights in_bins(const FlightPartition& share, const std::vector<FlightColumns>& flights,
                      const std::function<std::vector<double>(std::size_t flight)>& residual_of) {
  BinnedFlights binned;
  binned.bins.resize(flights.size());
  binned.residuals.resize(flights.size());
  binned.outlines = share.of_each_flight<NoiseFlight>([&](std::size_t f) {
    const std::vector<double> residual = residual_of(f);
    const Binning& bins = binned.bins[f] = bins_of(*flights[f].samples, flights[f].window, residual);
    binned.residuals[f] = bins.means(residual);
    return NoiseFlight{bins.size() > 0 ? bins.time().front() : 0.0, bins.size()};
  });
  for (std::size_t f = 0; f < flights.size(); ++f) {
    binned.reference.push_back(flights[f].reference);
    binned.columns.push_back(binned_columns(flights[f], binned.bins[f]));
  }
  return binned;
}

}  // namespace pcor::internal
