#pragma once

#include <string>
#include <vector>

#include <pcor/report/report.hpp>

namespace pcor::internal {

/// Pictures of residuals and flights common to several reports. Each is added if the report has its columns.

/// Mean and scatter of residuals in each regime.
void add_regimes(Report& report, const std::vector<std::string>& residuals);

/// Integrated autocorrelation time of the noise of a residual, in samples (`NoiseFloor`), for error bars of
/// means: variations faster than those of any effect. 1 without the column.
double noise_autocorrelation(const Report& report, const std::string& residual);

/// Distribution of residuals over periods, and comparison with normal noise.
void add_distributions(Report& report, const std::vector<std::string>& residuals);

/// Height, speed and regimes: the columns "altitude" and "true_airspeed".
void add_strip(Report& report);

/// Track, from the columns "latitude" and "longitude", with one column by colour.
void add_track(Report& report, const std::string& title, const std::string& caption,
               const std::string& colour, bool diverging = true);

}  // namespace pcor::internal
