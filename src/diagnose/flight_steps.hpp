#pragma once

#include <Eigen/Dense>
#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include "numerics/binning.hpp"
#include "numerics/noise_model.hpp"
#include "parallel/flight_partition.hpp"

namespace pcor::internal {

/// Compares the mean of each flight, after model and drift, with those of the others. The scatter of the
/// other means counts if it exceeds the effect of drift, with degrees of freedom from the number of flights
/// (Satterthwaite 1946, Biometrics Bulletin 2, 110). A step that the model explains is not reported. All
/// flights are against one reference. The p value is that of the largest step of all flights under drift and
/// scatter alone.
///
/// @param columns of the model, in bins, of each local flight; @param residuals likewise, hPa; @param noise
/// likewise
/// @return one step per flight, without its name; p value 1 if there is no other flight. If there are two
/// flights, only the second has a step, because both differ by the same amount.
std::vector<FlightOffset> find_mean_offsets(const FlightPartition& share, const std::vector<Binning>& bins,
                                            const std::vector<Eigen::MatrixXd>& columns,
                                            const std::vector<Eigen::VectorXd>& residuals,
                                            const NoiseModel& noise);

}  // namespace pcor::internal
