#include "numerics/median.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

/// Keeps the values that meet a condition. Without a branch: mispredicted branches would dominate the cost.
template <class Condition>
void keep(std::vector<double>& values, const Condition& condition) {
  std::size_t kept = 0;
  for (const double value : values) {
    values[kept] = value;
    kept += static_cast<std::size_t>(condition(value));
  }
  values.resize(kept);
}

/// One of the values, near the requested rank and a little towards the middle of all, so that most rounds
/// keep the smaller part.
double pivot(const std::vector<double>& values, std::size_t rank) {
  constexpr std::size_t size = 31;
  std::array<double, size> sample{};
  for (std::size_t i = 0; i < size; ++i) sample[i] = values[(2 * i + 1) * values.size() / (2 * size)];
  const double share = static_cast<double>(rank) / static_cast<double>(values.size());
  const double doubt = std::sqrt(share * (1.0 - share) * size);
  const double position = share * size + (share < 0.5 ? doubt : -doubt);
  auto* const at = sample.begin() + std::clamp(static_cast<std::ptrdiff_t>(position), std::ptrdiff_t{0},
                                               static_cast<std::ptrdiff_t>(size - 1));
  std::nth_element(sample.begin(), at, sample.end());
  return *at;
}

}  // namespace

double median(std::vector<double> values) {
  keep(values, [](double value) { return !std::isnan(value); });
  if (values.empty()) return nan;
  constexpr std::size_t many = 100;  // below this size, selection from a sample of 31 saves no time
  constexpr int max_rounds = 50;     // ten million values take about twelve
  std::size_t rank = values.size() / 2;
  for (int round = 0; round < max_rounds && values.size() >= many; ++round) {
    const double bound = pivot(values, rank);
    std::size_t below = 0;
    std::size_t equal = 0;
    for (const double value : values) {
      below += value < bound ? 1U : 0U;
      equal += value == bound ? 1U : 0U;
    }
    if (rank < below) {
      keep(values, [bound](double value) { return value < bound; });
    } else if (rank < below + equal) {
      return bound;
    } else {
      keep(values, [bound](double value) { return value > bound; });
      rank -= below + equal;
    }
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace pcor::internal
