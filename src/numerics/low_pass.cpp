#include "numerics/low_pass.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "numerics/missing.hpp"

namespace pcor::internal {

std::vector<double> low_passed(const std::vector<double>& values, double deviation) {
  const auto half_width = static_cast<std::size_t>(std::ceil(3.0 * deviation));
  std::vector<double> weight;
  for (std::size_t k = 0; k <= half_width; ++k)
    weight.push_back(std::exp(-0.5 * std::pow(static_cast<double>(k) / deviation, 2)));
  std::vector<double> result(values.size(), nan);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    double sum = 0.0;
    double weights = 0.0;
    for (std::size_t j = i - std::min(i, half_width); j < std::min(i + half_width + 1, values.size()); ++j) {
      if (std::isnan(values[j])) continue;
      const double w = weight[j > i ? j - i : i - j];
      sum += w * values[j];
      weights += w;
    }
    result[i] = sum / weights;
  }
  return result;
}

}  // namespace pcor::internal
