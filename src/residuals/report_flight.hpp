#pragma once

#include <cstddef>
#include <vector>

#include <pcor/report/report.hpp>
#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

/// Adds a flight to a report: its name, the times of some records, at least one, and the intervals that
/// contain one of them.
void add_flight(Report& report, const FlightSamples& flight, const std::vector<std::size_t>& records);

/// Wind of a flight at about forty times: ground velocity minus velocity through the air, which points along
/// the heading and, if the sideslip is known, has a lateral component. Accurate to a few m/s, for pictures.
/// Empty if the flight does not record its inputs.
std::vector<ReportBarb> wind_of(const FlightSamples& flight);

}  // namespace pcor::internal
