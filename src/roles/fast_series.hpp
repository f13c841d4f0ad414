#pragma once

#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/roles/fast_series.hpp>
#include "roles/model_inputs.hpp"

namespace pcor::internal {

/// What is recorded of a quantity, at `rate` samples in a record, in the unit of the quantity.
FastSeries read_fast(const Flight& flight, const ModelInput& input, int rate);

/// How far the rates of change of a series are signal.
struct SignalBand {
  double min_period = 0.0;     ///< s, at which it is rather more signal than noise
  double rate_variance = 0.0;  ///< of its rates of change down to that period, per second squared
  double rate_noise = 0.0;     ///< what of that is noise
};

/// The band in which a series is rather more signal than noise: to cut its rate of change off there leaves
/// least error (Wiener), and one that can be fitted to. Noise is where the spectrum is flat.
/// @param time of the records @param step s, from record to record
SignalBand signal_band_of(const FastSeries& series, const std::vector<double>& time, double step);

/// The mean rate of change of a series over `seconds`, per second, as `RateFilter` has it, in the mean over
/// each record: with 0 s the derivative. Gaps in time are bridged by nothing: the rates beside them are of
/// what is on one side. NaN where more than half of a record has none.
std::vector<double> rate_of(const FastSeries& series, const std::vector<double>& time, double step,
                            double min_period, double seconds = 0.0);

}  // namespace pcor::internal
