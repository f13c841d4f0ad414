#pragma once

#include <string>
#include <vector>

#include <pcor/report/report.hpp>

namespace pcor::internal {

/// Pictures of residuals and flights that several reports have. Each is added where the report has its
/// columns.

/// Of each regime the mean and the scatter of residuals.
void add_regimes(Report& report, const std::vector<std::string>& residuals);

/// At which periods residuals are, and whether they are distributed as noise is.
void add_distributions(Report& report, const std::vector<std::string>& residuals);

/// Height and speed, and what was flown: the columns "altitude" and "airspeed" or "true_airspeed".
void add_strip(Report& report);

/// The track, the columns "latitude" and "longitude", with one column by colour, and the wind on request.
void add_track(Report& report, const std::string& title, const std::string& caption,
               const std::string& colour, std::vector<ReportBarb> wind = {}, bool diverging = true);

}  // namespace pcor::internal
