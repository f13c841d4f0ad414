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

/// Flights of a team in bins, each against one reference, those against one reference one after another. A
/// member has the bins of its own flights; of the others it knows which there are, and its bins are none.
struct BinnedFlights {
  std::vector<Binning> bins{};
  std::vector<Eigen::MatrixXd> columns{};    ///< base and candidates, in bins
  std::vector<Eigen::VectorXd> residuals{};  ///< hPa, in bins
  std::vector<std::size_t> reference{};      ///< of each flight
  std::vector<NoiseFlight> outlines{};       ///< of all flights

  /// The flights against the first reference: the first so many.
  std::size_t first_count() const;
};

/// The bins in which a residual of each own flight has values, hPa. @param residual_of gives it
BinnedFlights in_bins(const FlightPartition& share, const std::vector<FlightColumns>& flights,
                      const std::function<std::vector<double>(std::size_t flight)>& residual_of);

/// What a noise is found from, in bins.
struct BinnedFit {
  /// The columns that are fitted to an own flight.
  std::function<Eigen::MatrixXd(std::size_t flight)> columns;
  /// What they leave of its residual, hPa.
  std::function<Eigen::VectorXd(std::size_t flight)> left;
  /// Digest of what they leave it at, in which the members have to agree.
  std::uint64_t state = 0;
};

using FindNoise =
    std::function<NoiseModel(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                             const std::vector<Eigen::VectorXd>& left)>;

/// The noise of each flight, each reference having one of its own. What flights share of it is found from a
/// few of them by `find`; the level of an own flight follows from that and its own residual.
std::vector<NoiseModel> noise_of_flights(const FlightPartition& share, const BinnedFlights& flights,
                                         const BinnedFit& fit, const FindNoise& find);

/// That of the flights against the first reference as one, with the levels of the own.
NoiseModel noise_of_first_reference(const BinnedFlights& flights, const std::vector<NoiseModel>& noise);

}  // namespace pcor::internal
