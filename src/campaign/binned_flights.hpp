#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <functional>
#include <vector>

#include "campaign/columns.hpp"
#include "numerics/binning.hpp"
#include "numerics/noise_flights.hpp"
#include "parallel/flight_partition.hpp"

namespace pcor::internal {

/// Binned flights of all ranks, each against one reference, grouped by reference. A rank has the bins of its
/// flights; for other flights it has the outline, and their bins are empty.
struct BinnedFlights {
  std::vector<Binning> bins{};
  std::vector<Eigen::MatrixXd> columns{};    ///< base and candidates, in bins
  std::vector<Eigen::VectorXd> residuals{};  ///< hPa, in bins
  std::vector<std::size_t> reference{};      ///< reference of each flight
  std::vector<NoiseFlight> outlines{};       ///< outlines of all flights

  /// Number of flights against the first reference, which come first.
  std::size_t first_count() const;
};

/// Bins in which the residual of each flight of this rank has values, hPa. @param residual_of returns the
/// residual
BinnedFlights in_bins(const FlightPartition& share, const std::vector<FlightColumns>& flights,
                      const std::function<std::vector<double>(std::size_t flight)>& residual_of);

}  // namespace pcor::internal
