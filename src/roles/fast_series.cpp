#include "roles/fast_series.hpp"

#include <algorithm>
#include <cmath>

#include <pcor/numerics/noise.hpp>
#include <pcor/realtime/look_ahead.hpp>
#include <pcor/realtime/rate_filter.hpp>
#include <pcor/realtime/sample_clock.hpp>
#include "numerics/missing.hpp"
#include "roles/recorded_series.hpp"

namespace pcor::internal {
namespace {

/// Calls `use` with the number and the rate of every `stride`-th sample. A record at another interval
/// starts a new segment, the same as a gap. A segment between two such records has no rate if it is shorter
/// than the window.
template <class Use>
void each_rate(RateFilter filter, const FastSeries& series, const std::vector<double>& time, double step,
               std::size_t stride, const Use& use) {
  const std::size_t window = filter.before() + 1 + filter.after();
  const auto is_after_gap = [&](std::size_t record) {
    return record == 0 || record == time.size() || time[record] - time[record - 1] > 1.5 * step;
  };
  SampleClock clock(1.0 / step);
  for (std::size_t record = 0; record < time.size();) {
    std::size_t next = record + 1;
    clock.reset();
    while (next < time.size() && !clock.is_uneven(time[next] - time[next - 1])) ++next;
    const bool is_known =
        (next - record) * series.in_record >= window || (is_after_gap(record) && is_after_gap(next));
    const std::size_t first = record * series.in_record;
    const std::size_t end = next * series.in_record;
    for (std::size_t i = first; is_known && i < end; i += stride)
      use(i, filter(series.values.data() + i, i - first, end - 1 - i));
    record = next;
  }
}

/// The mean square of values, those beyond six robust deviations counted as if they were there.
double clipped_variance(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const double limit = 6.0 * robust_standard_deviation(values);
  double sum = 0.0;
  for (const double value : values) sum += std::min(value * value, limit * limit);
  return sum / static_cast<double>(values.size());
}

}  // namespace

FastSeries read_fast(const Flight& flight, const ModelInput& input, int rate) {
  FastSeries series;
  series.in_record = static_cast<std::size_t>(rate);
  series.values = read_values(flight, input.variable, input.conversion, rate).values;
  for (double& value : series.values) value = usable_for_rates(input.quantity, value);
  return series;
}

SignalBand signal_band_of(const FastSeries& series, const std::vector<double>& time, double step) {
  constexpr double half_octave = 1.4142135623730951;
  constexpr double longest = 64.0;  // s
  constexpr double flat = 1.3;
  const double rate = static_cast<double>(series.in_record) / step;
  std::vector<double> periods;
  std::vector<double> variance;
  std::vector<double> gain;  // white noise
  for (double period = 2.0 / rate; period < longest; period *= half_octave) {
    const RateFilter filter(rate, 0.0, period);
    std::vector<double> rates;
    const auto stride = std::max<std::size_t>(1, static_cast<std::size_t>(0.25 * period * rate));
    each_rate(filter, series, time, step, stride, [&](std::size_t, double value) {
      if (std::isfinite(value)) rates.push_back(value);
    });
    periods.push_back(period);
    variance.push_back(clipped_variance(rates));
    gain.push_back(filter.gain());
  }
  // The power of each band, as if it were white noise.
  std::vector<double> power;
  for (std::size_t k = 0; k + 1 < periods.size(); ++k)
    power.push_back((variance[k] - variance[k + 1]) / (gain[k] - gain[k + 1]));
  if (power.size() < 2) return {2.0 / rate, variance.empty() ? 0.0 : variance[0], 0.0};
  // Where the spectrum still falls at its end, noise is below all of it.
  const double noise = power[1] < flat * power[0] ? power[0] : 0.5 * power[0];
  std::size_t k = 0;
  while (k + 1 < power.size() && power[k] < 2.0 * noise) ++k;
  return {periods[k], variance[k], std::min(variance[k], noise * gain[k])};
}

std::vector<double> rate_of(const FastSeries& series, const std::vector<double>& time, double step,
                            double min_period, double seconds) {
  const RateFilter filter(static_cast<double>(series.in_record) / step, seconds, min_period);
  std::vector<double> sum(time.size(), 0.0);
  std::vector<std::size_t> count(time.size(), 0);
  each_rate(filter, series, time, step, 1, [&](std::size_t sample, double rate) {
    if (!std::isfinite(rate)) return;
    sum[sample / series.in_record] += rate;
    ++count[sample / series.in_record];
  });
  for (std::size_t i = 0; i < sum.size(); ++i)
    sum[i] = 2 * count[i] > series.in_record ? sum[i] / static_cast<double>(count[i]) : nan;
  return sum;
}

}  // namespace pcor::internal
