#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "regimes/regime_search.hpp"

namespace pcor::internal {
namespace {

struct Band {
  double variance;  // deg2
  double time;      // s
  std::size_t min_period, max_period;
  double periodicity;
};

std::vector<double> product(const std::vector<double>& a, const std::vector<double>& b, std::size_t lag = 0) {
  std::vector<double> result(a.size(), nan);
  for (std::size_t i = 0; i + lag < a.size(); ++i) result[i] = a[i] * b[i + lag];
  return result;
}

// Removes changes slower than the band, and changes faster than a third of its shortest period.
std::vector<double> in_band(const std::vector<double>& values, const Band& band) {
  const std::vector<double> trend = smoothed_twice(values, band.max_period);
  const std::vector<double> smooth = running_mean(values, band.min_period / 3);
  std::vector<double> result(values.size(), nan);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isnan(values[i])) result[i] = smooth[i] - trend[i];
  }
  return result;
}

// Autocorrelation of the surroundings of each cell, three of the longest periods wide, at the best period of
// the band: 1 for a pure oscillation, about 0 for turbulence.
std::vector<double> local_periodicity(const std::vector<double>& values, const Band& band) {
  const std::size_t window = 3 * band.max_period;
  const std::vector<double> variance = running_mean(product(values, values), window);
  std::vector<double> best(values.size(), 0.0);
  for (std::size_t lag = band.min_period; lag <= band.max_period; ++lag) {
    const std::vector<double> covariance = running_mean(product(values, values, lag), window);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (covariance[i] > best[i] * variance[i]) best[i] = covariance[i] / variance[i];
    }
  }
  return best;
}

// Autocorrelation of a run at the lag `lag`.
double autocorrelation(const std::vector<double>& values, IndexRange run, std::size_t lag) {
  double covariance = 0.0, variance = 0.0;
  for (std::size_t i = run.first; i + lag < run.end; ++i) {
    const double pair = values[i] * values[i + lag];
    if (std::isnan(pair)) continue;
    covariance += pair;
    variance += (values[i] * values[i] + values[i + lag] * values[i + lag]) / 2.0;
  }
  return variance > 0.0 ? covariance / variance : 0.0;
}

// Vertex of the parabola through three values one apart, relative to the middle one.
double vertex(double left, double middle, double right) {
  const double curvature = left - 2.0 * middle + right;
  return curvature < 0.0 ? std::clamp((left - right) / (2.0 * curvature), -0.5, 0.5) : 0.0;
}

// First period with maximum autocorrelation of a run; 0 if the correlation is too low everywhere.
double period_of(const std::vector<double>& values, IndexRange run, const Band& band) {
  std::vector<double> correlation;
  for (std::size_t lag = band.min_period - 1; lag <= band.max_period + 1; ++lag) {
    correlation.push_back(autocorrelation(values, run, lag));
  }
  std::size_t best = 0;
  for (std::size_t i = 1; i + 1 < correlation.size(); ++i) {
    const bool peak = correlation[i] >= correlation[i - 1] && correlation[i] >= correlation[i + 1];
    if (peak && (best == 0 || correlation[i] > correlation[best] + 0.1)) best = i;
  }
  if (best == 0 || correlation[best] < band.periodicity) return 0.0;
  return static_cast<double>(band.min_period - 1 + best) +
         vertex(correlation[best - 1], correlation[best], correlation[best + 1]);
}

// Run from the zero before the first swing of half the amplitude to the zero after the last one, extended by
// at most one period.
IndexRange whole_swings(const std::vector<double>& values, IndexRange run, double amplitude,
                        std::size_t margin) {
  const std::size_t earliest = run.first - std::min(run.first, margin);
  const std::size_t latest = std::min(run.end + margin, values.size());
  const auto swings = [&](std::size_t i) { return std::abs(values[i]) >= amplitude / 2.0; };
  IndexRange whole{earliest, latest};
  while (whole.first < whole.end && !swings(whole.first)) ++whole.first;
  while (whole.end > whole.first && !swings(whole.end - 1)) --whole.end;
  if (whole.length() == 0) return run;
  while (whole.first > earliest && values[whole.first - 1] * values[whole.first] > 0.0) --whole.first;
  while (whole.end < latest && values[whole.end] * values[whole.end - 1] > 0.0) ++whole.end;
  return whole;
}

// Cells in flight without net climb.
std::vector<bool> about_level(const RegimeSearch& search) {
  const std::vector<double> climb =
      smoothed_twice(search.cells.vertical_speed, cells_in(search.criteria.climb_smoothing));
  std::vector<bool> level(search.flying);
  for (std::size_t i = 0; i < level.size(); ++i) {
    if (std::abs(climb[i]) > search.criteria.manoeuvre_climb) level[i] = false;
  }
  return level;
}

// Adds the oscillations of an angle with level wings, during which `moves` holds for the aircraft.
template <class Moves>
void add_oscillations(RegimeSearch& search, Regime regime, const std::vector<double>& angle,
                      const std::vector<bool>& usable, const Band& band, const Moves& moves) {
  std::vector<double> tilt = search.cells.roll;
  for (double& roll : tilt) roll = std::abs(roll);
  const std::vector<double> squares = product(angle, angle);
  const std::vector<double> variance = running_mean(squares, band.max_period);
  const std::vector<double> periodicity = local_periodicity(angle, band);
  const std::vector<IndexRange> strong = runs_where(angle.size(), [&](std::size_t i) {
    return usable[i] && !std::isnan(angle[i]) && variance[i] > band.variance &&
           periodicity[i] >= band.periodicity;
  });
  for (const IndexRange& run : merge_gaps(strong, band.min_period)) {
    const double amplitude = std::sqrt(2.0 * mean(squares, run));
    const IndexRange whole = whole_swings(angle, run, amplitude, band.max_period);
    if (whole.length() < cells_in(band.time)) continue;
    const double period = period_of(angle, whole, band);
    if (!(period > 0.0) || !moves(whole) || mean(tilt, whole) > search.criteria.manoeuvre_roll) continue;
    search.add(regime, whole,
               fmt::format("{:.0f} cycles of {:.3g} s, +-{:.1f} deg",
                           static_cast<double>(whole.length()) / period, period, amplitude));
  }
}

}  // namespace

void find_pitch_manoeuvres(RegimeSearch& search) {
  const RegimeCriteria& criteria = search.criteria;
  if (!has_value(search.cells.pitch)) return;
  const Band band{criteria.pitch_variance, criteria.pitch_time, cells_in(criteria.pitch_shortest_period),
                  cells_in(criteria.pitch_longest_period), criteria.periodicity};
  const std::vector<double> vertical_speed = in_band(search.cells.vertical_speed, band);
  const std::vector<double> squares = product(vertical_speed, vertical_speed);
  add_oscillations(
      search, Regime::pitch_manoeuvre, in_band(search.cells.pitch, band), about_level(search), band,
      [&](IndexRange run) { return !(std::sqrt(mean(squares, run)) < criteria.pitch_vertical_speed); });
}

void find_yaw_manoeuvres(RegimeSearch& search) {
  const RegimeCriteria& criteria = search.criteria;
  if (!has_value(search.cells.sideslip)) return;
  const Band band{criteria.yaw_variance, criteria.yaw_time, cells_in(criteria.yaw_shortest_period),
                  cells_in(criteria.yaw_longest_period), criteria.periodicity};
  const std::vector<double> sideslip = in_band(search.cells.sideslip, band);
  const std::vector<double> heading = in_band(search.cells.heading, band);
  const std::vector<double> heading_squares = product(heading, heading);
  const std::vector<double> sideslip_squares = product(sideslip, sideslip);
  const std::vector<double> products = product(sideslip, heading);
  const std::vector<double> heading_variance = running_mean(heading_squares, band.max_period);
  std::vector<bool> usable = about_level(search);
  for (std::size_t i = 0; i < usable.size(); ++i) {
    if (heading_variance[i] < criteria.yaw_variance / 2.0) usable[i] = false;
  }
  add_oscillations(search, Regime::yaw_manoeuvre, sideslip, usable, band, [&](IndexRange run) {
    const double variances = mean(sideslip_squares, run) * mean(heading_squares, run);
    return !(std::abs(mean(products, run) / std::sqrt(variances)) < criteria.yaw_heading_correlation);
  });
}

}  // namespace pcor::internal
