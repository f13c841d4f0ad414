#include "residuals/masks.hpp"

#include <pcor/numerics/noise.hpp>

#include <algorithm>
#include <cmath>

#include "numerics/local_noise.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

constexpr double longest = 20.0;    // s
constexpr double min_noise = 0.2;   // hPa: gusts change the defect of a port as well, by less than 1 hPa
constexpr double jump_limit = 5.0;  // robust standard deviations: exceeded by 6 in 10 million normal samples
constexpr double margin = 3.0;      // s
constexpr double near_jump = 3.0;   // robust standard deviations, for samples near a jump beyond the limit

/// Jump of each sample from the mean of its neighbours, in robust standard deviations; NaN if unknown, at the
/// ends and next to gaps.
std::vector<double> jumps_of(const std::vector<double>& values, const std::vector<double>& time,
                             double step) {
  std::vector<double> jumps(values.size(), nan);
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    if (time[i + 1] - time[i - 1] <= 2.5 * step)
      jumps[i] = std::abs(values[i] - 0.5 * (values[i - 1] + values[i + 1]));
  }
  const std::size_t block = local_noise_samples(step);
  for (std::size_t first = 0; first < jumps.size(); first += block) {
    double* const begin = jumps.data() + first;
    double* const end = jumps.data() + std::min(first + block, jumps.size());
    const double deviation = std::max(min_noise, robust_standard_deviation({begin, end}));
    for (double* jump = begin; jump != end; ++jump) *jump /= deviation;
  }
  return jumps;
}

}  // namespace

std::vector<std::size_t> find_bursts(const std::vector<double>& residual,
                                     const std::vector<const std::vector<double>*>& pressures,
                                     const std::vector<double>& time, double step) {
  std::vector<double> of_pressures(residual.size());
  for (const std::vector<double>* const pressure : pressures) {
    const std::vector<double> jumps = jumps_of(*pressure, time, step);
    for (std::size_t i = 0; i < jumps.size(); ++i) of_pressures[i] = std::max(of_pressures[i], jumps[i]);
  }
  std::vector<double> both = jumps_of(residual, time, step);
  std::vector<std::size_t> jumps;
  for (std::size_t i = 0; i < both.size(); ++i) {
    both[i] = std::min(both[i], of_pressures[i]);
    if (both[i] > near_jump) jumps.push_back(i);
  }
  const auto beyond = static_cast<std::size_t>(std::lround(margin / step));
  std::vector<std::size_t> bursts;
  for (std::size_t first = 0, last = 0; first < jumps.size(); first = last + 1) {
    last = first;
    while (last + 1 < jumps.size() && time[jumps[last + 1]] - time[jumps[last]] <= longest) ++last;
    const std::size_t begin = jumps[first];
    const std::size_t end = jumps[last] + 1;
    if (time[end - 1] - time[begin] > longest + 2.0 * step) continue;
    const auto is_beyond = [&](std::size_t i) { return both[i] >= jump_limit; };
    if (std::none_of(&jumps[first], &jumps[last] + 1, is_beyond)) continue;
    const std::size_t from = bursts.empty() ? 0 : bursts.back() + 1;
    const std::size_t to = std::min(end + beyond, residual.size());
    for (std::size_t i = std::max(from, begin - std::min(begin, beyond)); i < to; ++i) bursts.push_back(i);
  }
  return bursts;
}

}  // namespace pcor::internal
