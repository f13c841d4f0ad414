#include "numerics/low_pass.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "numerics/missing.hpp"

namespace pcor::internal {

std::vector<double> low_passed(const std::vector<double>& values, double deviation) {
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(3.0 * deviation));
  std::vector<double> weight;
  for (std::ptrdiff_t k = 0; k <= reach; ++k)
    weight.push_back(std::exp(-0.5 * std::pow(static_cast<double>(k) / deviation, 2)));
  const auto size = static_cast<std::ptrdiff_t>(values.size());
  std::vector<double> result(values.size(), nan);
  for (std::ptrdiff_t i = 0; i < size; ++i) {
    double sum = 0.0;
    double weights = 0.0;
    for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, i - reach); j <= std::min(size - 1, i + reach); ++j) {
      const double value = values[static_cast<std::size_t>(j)];
      if (std::isnan(value)) continue;
      const double w = weight[static_cast<std::size_t>(std::abs(j - i))];
      sum += w * value;
      weights += w;
    }
    if (weights > 0.0 && !std::isnan(values[static_cast<std::size_t>(i)]))
      result[static_cast<std::size_t>(i)] = sum / weights;
  }
  return result;
}

}  // namespace pcor::internal
