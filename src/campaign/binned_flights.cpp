#include "campaign/binned_flights.hpp"

#include <algorithm>

#include "campaign/linear_rows.hpp"
#include "numerics/binned_rows.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

/// Flights from `first` until `last` that determine the noise.
std::vector<std::size_t> few_of(const std::vector<NoiseFlight>& flights, std::size_t first,
                                std::size_t last) {
  const auto begin = flights.begin();
  std::vector<std::size_t> few = flights_for_noise(
      {begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(last)});
  for (std::size_t& flight : few) flight += first;
  return few;
}

}  // namespace

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

std::vector<NoiseModel> noise_of_flights(const FlightPartition& share, const BinnedFlights& flights,
                                         const BinnedFit& fit, const FindNoise& find) {
  std::vector<NoiseModel> noise(flights.bins.size());
  for (std::size_t first = 0; first < noise.size();) {
    std::size_t last = first;
    while (last < noise.size() && flights.reference[last] == flights.reference[first]) ++last;
    const std::vector<std::size_t> few = few_of(flights.outlines, first, last);
    const auto rows_of = share.of_entries(few).of_each_flight<BinnedRows>(
        [&](std::size_t k) {
          const Eigen::MatrixXd columns = fit.columns(few[k]);
          BinnedRows some{flights.bins[few[k]], {columns.rows(), columns.cols() + 1}};
          some.rows << columns, fit.left(few[k]);
          return some;
        },
        fit.state);
    std::vector<Binning> bins;
    std::vector<Eigen::MatrixXd> columns;
    std::vector<Eigen::VectorXd> left;
    for (const BinnedRows& some : rows_of) {
      bins.push_back(some.bins);
      columns.emplace_back(some.rows.leftCols(some.rows.cols() - 1));
      left.emplace_back(some.rows.rightCols(1));
    }
    NoiseModel shared = find(bins, columns, left);
    shared.level.clear();
    for (; first < last; ++first) {
      noise[first] = shared;
      noise[first].level.resize(1);
      if (!share.owns(first)) continue;
      const Binning& own = flights.bins[first];
      noise[first].level[0] = level_of_bins(noise_levels(own, fit.left(first), shared), own);
    }
  }
  return noise;
}

NoiseModel noise_of_first_reference(const BinnedFlights& flights, const std::vector<NoiseModel>& noise) {
  NoiseModel first = noise.front();
  first.level.clear();
  for (std::size_t f = 0; f < flights.first_count(); ++f) first.level.push_back(noise[f].level[0]);
  return first;
}

}  // namespace pcor::internal
