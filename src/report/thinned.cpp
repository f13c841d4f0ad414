#include "report/thinned.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace pcor::internal::report {
namespace {

/// Samples between two kept ones, by their indices among the samples with values.
struct Line {
  std::size_t first = 0;
  std::size_t last = 0;
  std::size_t worst = 0;  // sample with the largest deviation
  double error = 0.0;     // there

  bool operator<(const Line& other) const {
    return error < other.error || (error == other.error && first > other.first);
  }
};

}  // namespace

std::vector<std::size_t> thinned(const std::vector<double>& time, const std::vector<std::size_t>& begins,
                                 const std::vector<ScaledSeries>& series, std::size_t maximum,
                                 double enough) {
  std::vector<std::size_t> known;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (std::all_of(series.begin(), series.end(),
                    [i](const ScaledSeries& each) { return std::isfinite((*each.values)[i]); }))
      known.push_back(i);
  }
  const auto line = [&](std::size_t first, std::size_t last) {
    Line result{first, last, first, 0.0};
    const std::size_t a = known[first];
    const std::size_t b = known[last];
    for (const ScaledSeries& each : series) {
      const std::vector<double>& values = *each.values;
      const double slope = (values[b] - values[a]) / std::max(time[b] - time[a], 1e-9);
      for (std::size_t k = first + 1; k < last; ++k) {
        const std::size_t i = known[k];
        const double error = each.scale * std::abs(values[i] - values[a] - slope * (time[i] - time[a]));
        if (error > result.error) {
          result.error = error;
          result.worst = k;
        }
      }
    }
    return result;
  };

  std::vector<std::size_t> kept;
  std::priority_queue<Line> lines;
  for (std::size_t f = 0; f < std::max<std::size_t>(begins.size(), 1); ++f) {
    const std::size_t begin = begins.empty() ? 0 : begins[f];
    const std::size_t end = f + 1 < begins.size() ? begins[f + 1] : time.size();
    const auto first = std::lower_bound(known.begin(), known.end(), begin);
    const auto last = std::lower_bound(known.begin(), known.end(), end);
    if (first == last) continue;
    const auto a = static_cast<std::size_t>(first - known.begin());
    const auto b = static_cast<std::size_t>(last - known.begin()) - 1;
    kept.push_back(known[a]);
    if (b == a) continue;
    kept.push_back(known[b]);
    lines.push(line(a, b));
  }
  for (std::size_t count = 0; count < maximum && !lines.empty(); ++count) {
    const Line worst = lines.top();
    if (worst.error <= enough || worst.error == 0.0) break;
    lines.pop();
    kept.push_back(known[worst.worst]);
    lines.push(line(worst.first, worst.worst));
    lines.push(line(worst.worst, worst.last));
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

}  // namespace pcor::internal::report
