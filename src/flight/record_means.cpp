#include "flight/record_means.hpp"

#include <algorithm>
#include <cmath>

namespace pcor::internal {
namespace {

double mean_on_circle(const std::vector<double>& values, const std::array<double, 2>& range) {
  const double turn = 2 * std::acos(-1.), width = range[1] - range[0];
  double sine = 0, cosine = 0;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    const double angle = turn * (value - range[0]) / width;
    sine += std::sin(angle);
    cosine += std::cos(angle);
  }
  // Nothing there, or directions that cancel: there is no mean direction.
  if (std::hypot(sine, cosine) < 1e-9 * static_cast<double>(values.size())) return nan;
  const double angle = std::atan2(sine, cosine) / turn;
  return range[0] + width * (angle < 0 ? angle + 1 : angle);
}

}  // namespace

void average(const std::vector<double>& samples, std::size_t count,
             const std::optional<std::array<double, 2>>& circle, double* out) {
  if (count == 0) return;
  std::vector<double> group(samples.size() / count);
  for (std::size_t i = 0; i < count; ++i) {
    std::copy_n(samples.data() + i * group.size(), group.size(), group.begin());
    out[i] = circle ? mean_on_circle(group, *circle) : mean_of(group);
  }
}

void RecordMeans::add(const std::vector<double>& samples, std::size_t records,
                      const std::optional<std::array<double, 2>>& circle, const RejectedCounts& rejected) {
  excluded += rejected;
  for (const double value : samples) {
    if (value < minimum) minimum = value;
    if (value > maximum) maximum = value;
  }
  values.resize(values.size() + records);
  average(samples, records, circle, values.data() + values.size() - records);
}

}  // namespace pcor::internal
