#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "campaign/columns.hpp"
#include "numerics/binning.hpp"
#include "numerics/noise_flights.hpp"
#include "numerics/noise_model.hpp"
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

/// Binned inputs of the noise estimate.
struct BinnedFit {
  /// Columns fitted to a flight of this rank.
  std::function<Eigen::MatrixXd(std::size_t flight)> columns;
  /// Residual after the fit, hPa.
  std::function<Eigen::VectorXd(std::size_t flight)> left;
  /// Digest of the parameters of the fit, on which the ranks must agree.
  std::uint64_t state = 0;
};

using FindNoise =
    std::function<NoiseModel(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                             const std::vector<Eigen::VectorXd>& left)>;

/// Noise of each flight, separate for each reference. The common part is found from a few flights by `find`;
/// the level of a flight follows from the common part and its residual.
std::vector<NoiseModel> noise_of_flights(const FlightPartition& share, const BinnedFlights& flights,
                                         const BinnedFit& fit, const FindNoise& find);

/// Common noise of the flights against the first reference, with the levels of the flights of this rank.
NoiseModel noise_of_first_reference(const BinnedFlights& flights, const std::vector<NoiseModel>& noise);

}  // namespace pcor::internal
