#include "regimes/series.hpp"

#include <cmath>

namespace pcor::internal {
namespace {

struct Sum {
  double value = 0.0;
  double known = 0.0;

  void add(double x) {
    if (std::isnan(x)) return;
    value += x;
    known += 1.0;
  }
  double mean() const { return known > 0.0 ? value / known : nan; }
  double squared_over_count() const { return value * value / known; }
};

}  // namespace

std::vector<double> running_mean(const std::vector<double>& values, std::size_t window) {
  const std::size_t half = window / 2;
  std::vector<Sum> up_to{{}};
  up_to.reserve(values.size() + 1);
  for (const double x : values) {
    up_to.push_back(up_to.back());
    up_to.back().add(x);
  }
  std::vector<double> means(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Sum& before = up_to[i - std::min(i, half)];
    const Sum& all = up_to[std::min(i + half + 1, values.size())];
    means[i] = Sum{all.value - before.value, all.known - before.known}.mean();
  }
  return means;
}

std::vector<double> smoothed_twice(const std::vector<double>& values, std::size_t window) {
  return running_mean(running_mean(values, window), window);
}

std::vector<double> unwrapped(std::vector<double> angles) {
  double last = nan;
  for (double& angle : angles) {
    if (!std::isfinite(angle)) continue;
    if (!std::isnan(last)) angle = last + std::remainder(angle - last, 360.0);
    last = angle;
  }
  return angles;
}

double mean(const std::vector<double>& values, IndexRange run) {
  Sum sum;
  for (std::size_t i = run.first; i < run.end; ++i) sum.add(values[i]);
  return sum.mean();
}

Extent extent(const std::vector<double>& values, IndexRange run) {
  Extent extent{nan, nan};
  for (std::size_t i = run.first; i < run.end; ++i) {
    extent.minimum = std::fmin(extent.minimum, values[i]);
    extent.maximum = std::fmax(extent.maximum, values[i]);
  }
  return extent;
}

std::size_t best_step(const std::vector<double>& values, IndexRange run, std::size_t shortest,
                      std::size_t otherwise) {
  const auto minimum = static_cast<double>(shortest);
  Sum all, left;
  for (std::size_t i = run.first; i < run.end; ++i) all.add(values[i]);
  std::size_t best = otherwise;
  double best_fit = -1.0;
  for (std::size_t i = run.first; i < run.end; ++i) {
    const Sum right{all.value - left.value, all.known - left.known};
    if (left.known >= minimum && right.known >= minimum) {
      const double fit = left.squared_over_count() + right.squared_over_count();
      if (fit > best_fit) {
        best_fit = fit;
        best = i;
      }
    }
    left.add(values[i]);
  }
  return best;
}

std::vector<IndexRange> merge_gaps(const std::vector<IndexRange>& runs, std::size_t gap,
                                   const std::function<bool(IndexRange)>& may_join) {
  std::vector<IndexRange> longer;
  for (const IndexRange& run : runs) {
    const bool near = !longer.empty() && run.first <= longer.back().end + gap;
    if (near && may_join({longer.back().first, run.end}))
      longer.back().end = run.end;
    else
      longer.push_back(run);
  }
  return longer;
}

std::vector<IndexRange> drop_short(std::vector<IndexRange> runs, std::size_t length) {
  runs.erase(
      std::remove_if(runs.begin(), runs.end(), [&](const IndexRange& run) { return run.length() < length; }),
      runs.end());
  return runs;
}

}  // namespace pcor::internal
