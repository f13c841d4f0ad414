#include <pcor/numerics/line_fit.hpp>

#include <algorithm>
#include <cmath>
#include "numerics/missing.hpp"

namespace pcor {

using namespace internal;

namespace {

PairMoments moments_of(const std::vector<double>& x, const std::vector<double>& y) {
  PairMoments moments;
  for (std::size_t i = 0; i < x.size(); ++i) moments.add(x[i], y[i]);
  return moments;
}

/// The line of that slope through the means. `squares` is the sum of the squared distances.
LineFit line(const PairMoments& m, double slope, double squares, double slope_error) {
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

void PairMoments::add(double x, double y) {
  if (std::isnan(x) || std::isnan(y)) return;
  ++samples;
  const auto count = static_cast<double>(samples);
  const double dx = x - mean_x;
  const double dy = y - mean_y;
  mean_x += dx / count;
  mean_y += dy / count;
  xx += dx * (x - mean_x);
  yy += dy * (y - mean_y);
  xy += dx * (y - mean_y);
}

void PairMoments::add(const PairMoments& other) {
  if (other.samples == 0) return;
  const auto own_count = static_cast<double>(samples);
  const auto count = static_cast<double>(other.samples);
  const double dx = other.mean_x - mean_x;
  const double dy = other.mean_y - mean_y;
  const double weight = own_count * count / (own_count + count);
  xx += other.xx + weight * dx * dx;
  yy += other.yy + weight * dy * dy;
  xy += other.xy + weight * dx * dy;
  mean_x += dx * (count / (own_count + count));
  mean_y += dy * (count / (own_count + count));
  samples += other.samples;
}

double PairMoments::correlation() const { return xy / std::sqrt(xx * yy); }

LineFit ordinary_fit(const std::vector<double>& x, const std::vector<double>& y) {
  return ordinary_fit(moments_of(x, y));
}

LineFit orthogonal_fit(const std::vector<double>& x, const std::vector<double>& y) {
  return orthogonal_fit(moments_of(x, y));
}

LineFit ordinary_fit(const PairMoments& m) {
  const double slope = m.xy / m.xx;
  const double squares = m.yy - slope * m.xy;
  const double variance = std::max(squares, 0.0) / (static_cast<double>(m.samples) - 2.0);
  return line(m, slope, squares, std::sqrt(variance / m.xx));
}

LineFit orthogonal_fit(const PairMoments& m) {
  const double difference = m.yy - m.xx;
  const double root = std::hypot(difference, 2.0 * m.xy);
  // The form of the root without cancellation.
  const double slope =
      difference > 0.0 ? (difference + root) / (2.0 * m.xy) : 2.0 * m.xy / (root - difference);
  // The smaller principal moment: (xx + yy - root) / 2.
  const double squares = 2.0 * (m.xx * m.yy - m.xy * m.xy) / (m.xx + m.yy + root);
  const double unexplained = std::max(m.xx * m.yy - m.xy * m.xy, 0.0) / (m.xy * m.xy);
  const double error = std::abs(slope) * std::sqrt(unexplained / (static_cast<double>(m.samples) - 2.0));
  return line(m, slope, squares, error);
}

}  // namespace pcor
