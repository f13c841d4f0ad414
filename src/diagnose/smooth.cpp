#include "diagnose/smooth.hpp"

#include <algorithm>
#include <cmath>

namespace pcor::internal {
namespace {

constexpr std::size_t degree = 2;

}  // namespace

Smooth::Smooth(std::vector<double> values, std::size_t columns) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double x) { return !std::isfinite(x); }),
               values.end());
  if (values.size() < 3) return;
  std::sort(values.begin(), values.end());
  for (const double value : values) centre_ += value;
  centre_ /= static_cast<double>(values.size());
  for (const double value : values) deviation_ += (value - centre_) * (value - centre_);
  deviation_ = std::sqrt(deviation_ / static_cast<double>(values.size()));
  // What varies in the last digits only does not vary.
  if (!(deviation_ > 1e-9 * std::max(std::abs(values.front()), std::abs(values.back())))) return;

  if (columns < degree) {
    columns_ = 1;
    return;
  }
  std::vector<double> distinct;
  std::unique_copy(values.begin(), values.end(), std::back_inserter(distinct));
  if (distinct.size() <= columns) {
    // One value has no column, as the constant is not theirs; another is told by the straight line.
    levels_.assign(distinct.begin() + 1, distinct.end() - 1);
    columns_ = 1 + levels_.size();
    return;
  }
  // Quadratic splines with so many columns, without the constant and the straight line, have that many spans.
  const std::size_t spans = columns > degree ? columns - degree + 1 : 1;
  std::vector<double> inner;
  for (std::size_t k = 0; k <= spans; ++k) {
    const double place = static_cast<double>(k) / static_cast<double>(spans);
    const double knot = values[static_cast<std::size_t>(place * static_cast<double>(values.size() - 1))];
    if (inner.empty() || knot > inner.back()) inner.push_back(knot);
  }
  columns_ = inner.size();  // a line, a square, and one bent function for each inner knot
  knots_ = inner;
}

void Smooth::evaluate(double value, double* out) const {
  if (columns_ == 0) return;
  const double x = (value - centre_) / deviation_;
  out[0] = x;
  if (knots_.empty()) {
    for (std::size_t k = 0; k < levels_.size(); ++k) out[k + 1] = value == levels_[k] ? 1.0 : 0.0;
    return;
  }
  const double within = std::clamp(value, knots_.front(), knots_.back());
  const double y = (within - centre_) / deviation_;
  out[1] = y * y;
  for (std::size_t k = 1; k + 1 < knots_.size(); ++k) {
    const double above = std::max(0.0, within - knots_[k]) / deviation_;
    out[k + 1] = above * above;
  }
}

}  // namespace pcor::internal
