#pragma once

#include <vector>

#include <pcor/report/report.hpp>
#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

/// The wind of a flight about every fortieth of it: the speed over the ground less that through the air,
/// which goes along the heading and, where the sideslip is known, beside it. Good to some m/s, for pictures.
/// None where the flight does not record what it takes.
std::vector<ReportBarb> wind_of(const FlightSamples& flight);

}  // namespace pcor::internal
