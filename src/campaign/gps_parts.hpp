#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <vector>

#include "campaign/gps_rows.hpp"

namespace pcor::internal {

/// Evidence of one flight against wind or height about the error of delta-p in parts of its samples.
///
/// @param used samples of the comparison
/// @param parts samples of each part; the first part has all samples
/// @return for each part the products of whitened columns: the shared nuisances, in units of their priors; 1
/// hPa added to the static defect in all samples, and in the part; the residual. Products of flights are
/// additive. A part without samples has an empty matrix; no matrix if the flight has no row.
std::vector<Eigen::MatrixXd> gps_products_of_parts(GpsKind kind, const FlightSamples& samples,
                                                   const ModelDefinition& model,
                                                   const std::vector<std::size_t>& used,
                                                   const std::vector<std::vector<std::size_t>>& parts);

}  // namespace pcor::internal
