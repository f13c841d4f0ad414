#include <pcor/numerics/noise.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include "numerics/local_noise.hpp"
#include "numerics/median.hpp"
#include "numerics/missing.hpp"

namespace pcor {

using namespace internal;

namespace {

constexpr std::array<std::size_t, 7> lags{1, 2, 4, 8, 16, 32, 64};
constexpr double plateau_growth = 1.15;
constexpr std::size_t min_differences = 30;
constexpr std::size_t orders_in_vain = 5;

/// The differences over `lag` samples that begin in [first, last) of the series; `every` is the step from one
/// to the next within a stretch.
std::vector<double> differences(const std::vector<double>& values, const std::vector<Segment>& segments,
                                std::size_t lag, std::size_t first, std::size_t last, std::size_t every = 1) {
  std::vector<double> result;
  for (const Segment& segment : segments) {
    const std::size_t end = segment.first + segment.count;
    if (segment.count <= lag) continue;
    const std::size_t to = std::min(end - lag, last);
    for (std::size_t i = std::max(segment.first, first); i < to; i += every)
      result.push_back(values[i + lag] - values[i]);
  }
  return result;
}

/// Variances of the differences over 1, 2, 4 ... samples, up to the lag at which they level off: there the
/// autocorrelation has vanished. NaN if there are too few differences.
std::vector<double> difference_variances(const std::vector<double>& values,
                                         const std::vector<Segment>& segments) {
  // This number of differences determines the variance to 2 %.
  constexpr std::size_t enough = 8192;
  const std::size_t every = 1 + values.size() / enough;
  std::vector<double> result;
  for (const std::size_t lag : lags) {
    std::vector<double> change = differences(values, segments, lag, 0, values.size(), every);
    // Segments shorter than the lag have no differences; the lags up to it are used.
    if (change.size() < min_differences) break;
    const double deviation = robust_standard_deviation(std::move(change));
    result.push_back(deviation * deviation);
    if (result.size() > 1 && !(result.back() > plateau_growth * result[result.size() - 2])) break;
  }
  if (result.empty()) result.push_back(nan);
  return result;
}

}  // namespace

std::vector<Segment> contiguous_segments(const std::vector<double>& values, const std::vector<double>& time,
                                         double step) {
  std::vector<Segment> result;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    const double since = i > 0 && !std::isnan(values[i - 1]) ? time[i] - time[i - 1] : 0.0;
    const bool is_continuous = since > 0.0 && since <= 1.5 * step;
    if (!is_continuous) result.push_back({i, 0});
    ++result.back().count;
  }
  return result;
}

double robust_standard_deviation(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  return deviation_of_median * median(std::move(values));
}

NoiseFloor noise_floor(const std::vector<double>& values, const std::vector<double>& time, double step) {
  const std::vector<Segment> segments = contiguous_segments(values, time, step);
  NoiseFloor floor;
  floor.local_rms.assign(values.size(), nan);
  const std::vector<double> whole_variance = difference_variances(values, segments);
  const std::size_t plateau = lags[whole_variance.size() - 1];
  const double whole = std::sqrt(0.5 * whole_variance.back());
  floor.rms = whole;
  if (!(whole > 0.0)) {
    for (const Segment& segment : segments)
      std::fill_n(floor.local_rms.begin() + static_cast<std::ptrdiff_t>(segment.first), segment.count, whole);
    return floor;
  }
  const std::size_t block = local_noise_samples(step);
  std::vector<double> normal(values.size(), nan);
  double square_sum = 0.0;
  std::size_t count = 0;
  for (std::size_t first = 0; first < values.size(); first += block) {
    const std::size_t last = std::min(first + block, values.size());
    std::vector<double> change = differences(values, segments, plateau, first, last);
    double here = whole;
    if (change.size() >= min_differences)
      here = std::sqrt(0.5) * robust_standard_deviation(std::move(change));
    if (!(here > 0.0)) here = whole;
    const double level = local_noise_level(here, whole);
    for (std::size_t i = first; i < last; ++i) {
      if (std::isnan(values[i])) continue;
      floor.local_rms[i] = level;
      normal[i] = values[i] / level;
      square_sum += here * here;
      ++count;
    }
  }
  floor.rms = std::sqrt(square_sum / static_cast<double>(count));

  // rho_k = 1 - D(k)/D(plateau) at the lags, and straight lines between them.
  const std::vector<double> variance = difference_variances(normal, segments);
  double before = 1.0;
  double sum = 0.0;
  std::size_t lag_before = 0;
  for (std::size_t i = 0; i < variance.size(); ++i) {
    const double correlation = std::clamp(1.0 - variance[i] / variance.back(), 0.0, 1.0);
    const auto width = static_cast<double>(lags[i] - lag_before);
    // The lags above lag_before up to and with lags[i].
    sum += 0.5 * (width - 1.0) * before + 0.5 * (width + 1.0) * correlation;
    before = correlation;
    lag_before = lags[i];
  }
  floor.autocorrelation_time = 1.0 + 2.0 * sum;
  return floor;
}

std::vector<double> autoregression(const std::vector<double>& values, const std::vector<Segment>& segments,
                                   std::size_t max_order) {
  constexpr double limit = 4.5;  // robust standard deviations
  std::vector<double> kept;
  for (const Segment& segment : segments)
    for (std::size_t i = 0; i < segment.count; ++i) kept.push_back(values[segment.first + i]);
  const double bound = limit * robust_standard_deviation(kept);
  double power = 0.0;
  for (double& value : kept) {
    if (bound > 0.0) value = std::clamp(value, -bound, bound);
    power += value * value;
  }
  std::vector<double> best;
  if (kept.empty()) return best;
  const auto count = static_cast<double>(kept.size());
  power /= count;
  if (!(power > 0.0)) return best;

  // Burg: forward and backward prediction errors of each order, over all stretches together.
  std::vector<double> forward = kept;
  std::vector<double> backward = kept;
  std::vector<double> coefficients;
  double best_criterion = count * std::log(power);
  // At least ten values per coefficient: with fewer the process would fit the noise.
  const std::size_t maximum = std::min(max_order, kept.size() / 10);
  for (std::size_t order = 1; order <= maximum; ++order) {
    double across = 0.0;
    double total = 0.0;
    std::size_t begin = 0;
    for (const Segment& segment : segments) {
      for (std::size_t i = begin + order; i < begin + segment.count; ++i) {
        across += forward[i] * backward[i - 1];
        total += forward[i] * forward[i] + backward[i - 1] * backward[i - 1];
      }
      begin += segment.count;
    }
    if (!(total > 0.0)) break;
    const double reflection = 2.0 * across / total;
    begin = 0;
    for (const Segment& segment : segments) {
      for (std::size_t i = begin + segment.count; i-- > begin + order;) {
        const double ahead = forward[i];
        forward[i] = ahead - reflection * backward[i - 1];
        backward[i] = backward[i - 1] - reflection * ahead;
      }
      begin += segment.count;
    }
    const std::vector<double> lower = coefficients;
    coefficients.push_back(reflection);
    for (std::size_t i = 0; i < lower.size(); ++i)
      coefficients[i] = lower[i] - reflection * lower[lower.size() - 1 - i];
    power *= 1.0 - reflection * reflection;
    if (!(power > 0.0)) break;
    const double criterion = count * std::log(power) + static_cast<double>(order) * std::log(count);
    if (criterion < best_criterion) {
      best_criterion = criterion;
      best = coefficients;
    }
    if (order >= best.size() + orders_in_vain) break;
  }
  return best;
}

}  // namespace pcor
