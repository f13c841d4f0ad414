#include "roles/resolution.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pcor::internal {

double rounding_of(double step) { return step / std::sqrt(12.0); }

void note_coarse(Quantity quantity, const std::string& variable, const std::vector<double>& values,
                 Notes& notes) {
  if (quantity != Quantity::static_pressure && quantity != Quantity::dynamic_pressure) return;
  const double step = resolution_of(values);
  if (step < coarse_pressure) return;
  notes.push_back(
      fmt::format("{} is recorded in steps of {:.2g} hPa: rounding alone contributes {:.2g} hPa rms of noise",
                  variable, step, rounding_of(step)));
}

double resolution_of(const std::vector<double>& values) {
  constexpr std::size_t min_values = 10;
  std::vector<double> sorted;
  std::copy_if(values.begin(), values.end(), std::back_inserter(sorted),
               [](double x) { return std::isfinite(x); });
  if (sorted.empty()) return 0.0;
  std::sort(sorted.begin(), sorted.end());
  const double rounding = 4e-7 * std::max(std::abs(sorted.front()),
                                          std::abs(sorted.back()));  // relative rounding of 32-bit floats
  const double range = sorted.back() - sorted.front();
  sorted.erase(
      std::unique(sorted.begin(), sorted.end(), [&](double a, double b) { return b - a <= rounding; }),
      sorted.end());
  if (sorted.size() < min_values) return 0.0;
  double step = range;
  for (std::size_t i = 1; i < sorted.size(); ++i) step = std::min(step, sorted[i] - sorted[i - 1]);
  for (const double value : sorted) {
    const double remainder = std::remainder(value - sorted.front(), step);
    const double count = (value - sorted.front()) / step;
    if (std::abs(remainder) > rounding * (1.0 + count) + 0.02 * step) return 0.0;
  }
  return step;
}

}  // namespace pcor::internal
