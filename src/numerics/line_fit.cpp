#include <pcor/numerics/line_fit.hpp>

#include <algorithm>
#include <cmath>
#include "numerics/missing.hpp"

namespace pcor {

using namespace internal;

namespace {

/// Means and central sums of the pairs that are complete.
struct Moments {
  std::size_t samples = 0;
  double mean_x = 0.0;
  double mean_y = 0.0;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
};

Moments moments_of(const std::vector<double>& x, const std::vector<double>& y) {
  Moments m;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::isnan(x[i]) || std::isnan(y[i])) continue;
    ++m.samples;
    const auto count = static_cast<double>(m.samples);
    const double dx = x[i] - m.mean_x;
    const double dy = y[i] - m.mean_y;
    m.mean_x += dx / count;
    m.mean_y += dy / count;
    m.xx += dx * (x[i] - m.mean_x);
    m.yy += dy * (y[i] - m.mean_y);
    m.xy += dx * (y[i] - m.mean_y);
  }
  return m;
}

/// The line of that slope through the means. `squares` is the sum of the squared distances.
LineFit line(const Moments& m, double slope, double squares, double slope_error) {
  LineFit fit;
  fit.samples = m.samples;
  fit.mean_difference = m.samples > 0 ? m.mean_y - m.mean_x : nan;
  if (m.samples < 3 || !(m.xx > 0.0)) {
    fit.slope = fit.offset = fit.rms = fit.slope_error = fit.offset_error = nan;
    return fit;
  }
  const auto count = static_cast<double>(m.samples);
  fit.slope = slope;
  fit.offset = m.mean_y - slope * m.mean_x;
  fit.rms = std::sqrt(std::max(squares, 0.0) / count);
  fit.slope_error = slope_error;
  fit.offset_error = std::hypot(fit.rms / std::sqrt(count), slope_error * m.mean_x);
  return fit;
}

}  // namespace

LineFit ordinary_fit(const std::vector<double>& x, const std::vector<double>& y) {
  const Moments m = moments_of(x, y);
  const double slope = m.xy / m.xx;
  const double squares = m.yy - slope * m.xy;
  const double variance = std::max(squares, 0.0) / (static_cast<double>(m.samples) - 2.0);
  return line(m, slope, squares, std::sqrt(variance / m.xx));
}

LineFit orthogonal_fit(const std::vector<double>& x, const std::vector<double>& y) {
  const Moments m = moments_of(x, y);
  const double difference = m.yy - m.xx;
  const double root = std::hypot(difference, 2.0 * m.xy);
  // Of the two forms of the root the one that does not cancel.
  const double slope =
      difference > 0.0 ? (difference + root) / (2.0 * m.xy) : 2.0 * m.xy / (root - difference);
  // The smaller principal moment: (xx + yy - root) / 2.
  const double squares = 2.0 * (m.xx * m.yy - m.xy * m.xy) / (m.xx + m.yy + root);
  const double unexplained = std::max(m.xx * m.yy - m.xy * m.xy, 0.0) / (m.xy * m.xy);
  const double error = std::abs(slope) * std::sqrt(unexplained / (static_cast<double>(m.samples) - 2.0));
  return line(m, slope, squares, error);
}

}  // namespace pcor
