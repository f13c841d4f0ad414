#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <memory>
#include <vector>

#include <pcor/campaign/flight_set.hpp>
#include "campaign/gps_rows.hpp"

namespace pcor::internal {

/// The coefficients that a GPS system has columns of.
struct GpsColumns {
  std::vector<std::size_t> places{};  ///< among the parameters of the model
  /// As large as each is met in practice, in its unit; 0 where nobody knows.
  std::vector<double> usual{};
  /// So many of them, the first, are the model's own. The noise is found beside these; the others are effects
  /// that are tested, with neutral parameters in the model.
  std::size_t own = 0;
};

/// What a flight says through wind or height, in rows of independent noise with variance one.
struct GpsFlightSystem {
  std::size_t flight = 0;     ///< among those of the set
  std::size_t reference = 0;  ///< among the references
  /// Columns: the coefficients in their order, then the nuisances that all flights share (the first
  /// `gps_shared_nuisances` of `gps_nuisances`), then the residual. Shear and slopes of isobars, which each
  /// flight has of its own, are eliminated with their priors. A column is by how much a unit of the
  /// coefficient makes the residual smaller.
  RowByRow rows{};
  std::vector<Eigen::Index> minutes{};  ///< of each row, since the start of the flight
};

/// A generalised least-squares problem, to be added to the sums of other references: the sums of squares and
/// products of all rows are those of the likelihood at the noise that was found.
struct GpsSystem {
  std::vector<GpsFlightSystem> flights{};
  /// The prior of the shared nuisances, rows with the same columns: to be added once, whatever the number of
  /// flights and references. Coefficients have none.
  RowByRow prior{};
};

/// The system of one flight; no rows where no sample takes part.
///
/// Columns are those of `gps_rows`: without gusts and sensor noise that the residual holds, so the gain of an
/// effect that is not there is distributed as chi2. Noise and outliers are those of the flight at the
/// coefficients of the model, free within their usual sizes.
/// @param model with the tested effects
GpsFlightSystem gps_flight_system(const std::shared_ptr<const FlightSamples>& samples,
                                  const ModelDefinition& model, const Reference& reference,
                                  const MaskOptions& mask, const GpsColumns& columns);

/// The systems of the flights that this process owns, against those of the references that are of GPS.
/// @throws Error if a flight lacks what a reference reads
GpsSystem gps_system(const FlightSet& flights, const ModelDefinition& model, const References& references,
                     const MaskOptions& mask, const GpsColumns& columns);

}  // namespace pcor::internal
