#pragma once

#include <Eigen/Dense>
#include <vector>

#include "campaign/columns.hpp"
#include "parallel/flight_partition.hpp"

namespace pcor::internal {

/// Whether the flow makes an effect, so that its shape may differ from the formula: an effect at the static
/// ports or the pitot tube that does not depend on time.
bool has_uncertain_shape(const ModelEffect& effect);

/// Number of columns that describe the uncertain shape of one effect.
inline constexpr Eigen::Index shape_columns = 6;

/// Columns of the uncertain shapes of some effects, in bins of each local flight, hPa.
///
/// The flow makes an effect that resembles the formula of the catalogue. An effect u may grow with another
/// power of the dynamic pressure, the static pressure or its own driver, may have another slope on either
/// side of zero, may act a little earlier or later, and may be zero at another value of its driver:
///
///     0.3 u ln q, 0.3 u ln p, 0.3 u ln |u|, 0.3 u sign u, 0.15 s du/dt, rms of u against the same reference
///
/// Each logarithm, and the sign, is less its mean over the flights, weighted by u^2, so that the columns do
/// not change the size of the effect. The coefficient of each column has a normal prior of standard
/// deviation 1. A value that is not known gives 0.
///
/// @param flights in the order of their references
/// @param effects coefficients of all columns of the flights; each vector holds those of one effect, and
/// zeros
std::vector<Eigen::MatrixXd> shape_uncertainty(const FlightPartition& partition,
                                               const std::vector<const FlightColumns*>& flights,
                                               const BinnedFlights& binned,
                                               const std::vector<Eigen::VectorXd>& effects);

}  // namespace pcor::internal
