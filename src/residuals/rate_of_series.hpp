#pragma once

#include <vector>

#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

/// The shortest period, s, at which a series is rather more signal than noise: to cut its rate of change off
/// there leaves least error (Wiener), and one that can be fitted to. Noise is where the spectrum is flat.
/// @param time of the records @param step s, from record to record
double shortest_period_of(const FastSeries& series, const std::vector<double>& time, double step);

/// The mean rate of change of a series over `seconds`, per second, as `RateFilter` has it, in the mean over
/// each record: with 0 s the derivative. Gaps in time are bridged by nothing: the rates beside them are of
/// what is on one side. NaN where more than half of a record has none.
std::vector<double> rate_of(const FastSeries& series, const std::vector<double>& time, double step,
                            double shortest_period, double seconds = 0.0);

}  // namespace pcor::internal
