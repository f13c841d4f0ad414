#pragma once

#include <vector>

#include <pcor/report/report.hpp>
#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

/// Wind of a flight at about forty times: ground velocity minus velocity through the air, which points along
/// the heading and, if the sideslip is known, has a lateral component. Accurate to a few m/s, for pictures.
/// Empty if the flight does not record its inputs.
std::vector<ReportBarb> wind_of(const FlightSamples& flight);

}  // namespace pcor::internal
