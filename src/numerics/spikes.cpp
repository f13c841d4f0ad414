#include "numerics/spikes.hpp"

#include <algorithm>
#include <cmath>

#include <pcor/numerics/noise.hpp>
#include "numerics/local_noise.hpp"

namespace pcor::internal {
namespace {

constexpr double limit = 4.5;
constexpr std::size_t fewest = 60;
constexpr std::size_t max_in_a_row = 3;

}  // namespace

std::vector<double> without_outliers(const std::vector<double>& residual,
                                     const std::vector<double>& predicted, const std::vector<double>& time,
                                     double step, std::size_t& count) {
  count = 0;
  std::vector<double> difference(residual.size());
  for (std::size_t i = 0; i < difference.size(); ++i) difference[i] = residual[i] - predicted[i];
  const std::vector<Segment> segments = contiguous_segments(difference, time, step);
  const std::vector<double> coefficients = autoregression(difference, segments);
  const std::size_t order = coefficients.size();
  const auto expected = [&](const Segment& segment, std::size_t t) {
    double value = 0.0;
    for (std::size_t k = 0; k < std::min(t, order); ++k)
      value += coefficients[k] * difference[segment.first + t - 1 - k];
    return value;
  };

  // Level of the innovations, from the unmodified series: robust against its outliers.
  std::vector<double> innovation(difference.size(), std::nan(""));
  for (const Segment& segment : segments) {
    for (std::size_t t = 0; t < segment.count; ++t)
      innovation[segment.first + t] = difference[segment.first + t] - expected(segment, t);
  }
  const double common = robust_standard_deviation(innovation);
  std::vector<double> level(difference.size(), common);
  const std::size_t block = local_noise_samples(step);
  for (std::size_t first = 0; first < difference.size(); first += block) {
    const auto begin = innovation.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end =
        innovation.begin() + static_cast<std::ptrdiff_t>(std::min(first + block, difference.size()));
    const auto present = std::count_if(begin, end, [](double x) { return !std::isnan(x); });
    if (present < static_cast<std::ptrdiff_t>(fewest)) continue;
    const double here = robust_standard_deviation({begin, end});
    std::fill(level.begin() + (begin - innovation.begin()), level.begin() + (end - innovation.begin()), here);
  }

  std::vector<double> result = residual;
  for (const Segment& segment : segments) {
    std::size_t in_a_row = 0;
    for (std::size_t t = order; t < segment.count; ++t) {
      const std::size_t i = segment.first + t;
      const double foreseen = expected(segment, t);
      if (!(std::abs(difference[i] - foreseen) > limit * level[i])) {
        in_a_row = 0;
        continue;
      }
      if (in_a_row == max_in_a_row) {
        // A lasting change is not an outlier: the residual has moved, and the earlier values are restored.
        for (std::size_t back = i - in_a_row; back < i; ++back) {
          difference[back] = residual[back] - predicted[back];
          result[back] = residual[back];
        }
        count -= in_a_row;
        in_a_row = 0;
        continue;
      }
      difference[i] = foreseen;
      result[i] = predicted[i] + foreseen;
      ++in_a_row;
      ++count;
    }
  }
  return result;
}

}  // namespace pcor::internal
