#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <memory>
#include <vector>

#include <pcor/campaign/flight_set.hpp>
#include "campaign/gps_rows.hpp"

namespace pcor::internal {

/// Coefficients of the law and of tested effects, the columns of a GPS system.
struct GpsColumns {
  std::vector<std::size_t> places{};  ///< numbers among the parameters of the model
  /// Typical size of each coefficient in its unit; 0: unknown.
  std::vector<double> usual{};
  /// Number of coefficients of the law; they come first. The noise is fitted with these. The other
  /// coefficients are those of tested effects, at their neutral values in the model.
  std::size_t own = 0;
};

/// Rows of one flight against wind or height, whitened: their noise is independent, with variance 1.
struct GpsFlightSystem {
  std::size_t flight = 0;     ///< number in the set
  std::size_t reference = 0;  ///< number among the references
  /// Columns: the coefficients in their order, the nuisances that all flights share (the first
  /// `gps_shared_nuisances` of `gps_nuisances`), the residual. Shear and slopes of isobars differ between
  /// flights; they are eliminated with their priors. A column is the decrease of the residual per unit of
  /// the coefficient.
  RowByRow rows{};
  std::vector<Eigen::Index> minutes{};  ///< minute of each row since the start of the flight
};

/// A generalised least-squares problem: the sums of squares and products of its rows add to those of other
/// references.
struct GpsSystem {
  std::vector<GpsFlightSystem> flights{};
  /// Prior of the shared nuisances as rows with the same columns. Add them once for all flights and
  /// references. The coefficients have no prior.
  RowByRow prior{};
};

/// The system of one flight; without rows if no sample is used.
///
/// The columns are those of `gps_rows`, without gusts and sensor noise that the residual contains: the gain
/// of an absent effect is distributed as chi2. Noise and outliers are fitted to the flight, with the
/// coefficients of the law free within a prior of their typical sizes about the values of the model.
/// @param model the law with the tested effects
GpsFlightSystem gps_flight_system(const std::shared_ptr<const FlightSamples>& samples,
                                  const ModelDefinition& model, const Reference& reference,
                                  const MaskOptions& mask, const GpsColumns& columns);

/// The systems of the flights that this process owns, for each reference that is wind or height.
/// @throws Error if a flight lacks a variable of a reference
GpsSystem gps_system(const FlightSet& flights, const ModelDefinition& model, const References& references,
                     const MaskOptions& mask, const GpsColumns& columns);

}  // namespace pcor::internal
