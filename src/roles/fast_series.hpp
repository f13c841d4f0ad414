#pragma once

#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/roles/fast_series.hpp>
#include "roles/model_inputs.hpp"

namespace pcor::internal {

/// The recorded values of a quantity, `rate` samples per record, in the unit of the quantity.
FastSeries read_fast(const Flight& flight, const ModelInput& input, int rate);

/// Periods in which the rate of change of a series is mainly signal.
struct SignalBand {
  double min_period = 0.0;     ///< s, shortest period with more signal than noise
  double rate_variance = 0.0;  ///< variance of the rate of change down to that period, per second squared
  double rate_noise = 0.0;     ///< contribution of noise to this variance
};

/// The band in which a series has more signal than noise: a cut-off there minimises the error of the rate of
/// change (Wiener). The flat part of the spectrum is taken as noise.
/// @param time of the records @param step s, from record to record
SignalBand signal_band_of(const FastSeries& series, const std::vector<double>& time, double step);

/// Mean rate of change of a series over `seconds` by `RateFilter`, per second, averaged over each record; the
/// derivative for 0 s. Gaps in time are not bridged: rates next to a gap use one side only. NaN if more than
/// half of the samples of a record have no rate.
std::vector<double> rate_of(const FastSeries& series, const std::vector<double>& time, double step,
                            double min_period, double seconds = 0.0);

}  // namespace pcor::internal
