#pragma once

#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include "campaign/columns.hpp"

namespace pcor::internal {

/// Compares the mean of each flight, after model and drift, with those of the others. The scatter of the
/// other means counts if it exceeds the effect of drift, with degrees of freedom from the number of flights
/// (Satterthwaite 1946, Biometrics Bulletin 2, 110). A step that the model explains is not reported. All
/// flights are against one reference. The p value is that of the largest step of all flights under drift and
/// scatter alone.
///
/// @param binned with the columns of the model; @param noise of each local flight
/// @return one step per flight, without its name; p value 1 if there is no other flight. If there are two
/// flights, only the second has a step, because both differ by the same amount.
std::vector<FlightOffset> find_mean_offsets(const FlightPartition& partition, const BinnedFlights& binned,
                                            const NoiseModel& noise);

}  // namespace pcor::internal
