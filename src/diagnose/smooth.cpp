#include "diagnose/smooth.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <set>

namespace pcor::internal {
namespace {

constexpr std::size_t degree = 2;
constexpr std::size_t harmonics = 2;

/// The quadratic B-spline whose knots are 0, 1, 2 and 3 (de Boor 1978, A practical guide to splines).
double spline_at(double x) {
  if (x <= 0.0 || x >= 3.0) return 0.0;
  if (x < 1.0) return 0.5 * x * x;
  if (x < 2.0) return 0.75 - (x - 1.5) * (x - 1.5);
  return 0.5 * (3.0 - x) * (3.0 - x);
}

}  // namespace

VariableValues::VariableValues(const FlightPartition& partition,
                               const std::function<std::vector<double>(std::size_t)>& values_of) {
  for (const std::vector<double>& of_flight : partition.all_gather_flights<std::vector<double>>(values_of)) {
    std::copy_if(of_flight.begin(), of_flight.end(), std::back_inserter(values),
                 [](double value) { return std::isfinite(value); });
    missing += of_flight.size();
  }
  missing -= values.size();
  if (values.empty()) return;
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  minimum = *least;
  maximum = *greatest;
  const auto count = static_cast<double>(values.size());
  mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  deviation = std::sqrt(squares / count);
}

std::vector<double> VariableValues::distinct(std::size_t max_count) const {
  std::set<double> found;
  for (std::size_t i = 0; i < values.size() && found.size() <= max_count; ++i) found.insert(values[i]);
  return {found.begin(), found.end()};
}

std::vector<double> VariableValues::quantiles(std::size_t number) const {
  std::vector<double> rest = values;
  std::vector<double> found;
  auto begin = rest.begin();
  for (std::size_t k = 0; k < number; ++k) {
    const double part = static_cast<double>(k) / static_cast<double>(number - 1);
    const auto place =
        rest.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
    std::nth_element(begin, place, rest.end());
    found.push_back(*place);
    begin = place;
  }
  return found;
}

bool Smooth::standardize(const VariableValues& values) {
  if (values.values.size() < 3) return false;
  centre_ = values.mean;
  deviation_ = values.deviation;
  // Variation in the last digits only is ignored.
  return deviation_ > 1e-9 * std::max(std::abs(values.minimum), std::abs(values.maximum));
}

Smooth Smooth::with_knots_at_values(const VariableValues& values, std::size_t columns) {
  Smooth smooth;
  if (!smooth.standardize(values)) return smooth;
  if (columns < degree) {
    smooth.columns_ = 1;
    return smooth;
  }
  const std::vector<double> distinct = values.distinct(columns);
  if (distinct.size() <= columns) {
    // A single value needs no column because the constant is excluded; the straight line replaces another
    // column.
    smooth.levels_.assign(distinct.begin() + 1, distinct.end() - 1);
    smooth.columns_ = 1 + smooth.levels_.size();
    return smooth;
  }
  // Quadratic splines without the constant and the straight line have one span per column.
  const std::size_t spans = columns - degree + 1;
  for (const double knot : values.quantiles(spans + 1)) {
    if (smooth.knots_.empty() || knot > smooth.knots_.back()) smooth.knots_.push_back(knot);
  }
  smooth.columns_ = smooth.knots_.size();  // a line, a square, and one bent function for each inner knot
  return smooth;
}

Smooth Smooth::with_even_knots(const VariableValues& values, std::size_t columns) {
  Smooth smooth;
  if (columns < degree || !smooth.standardize(values)) return smooth;
  smooth.columns_ = columns;
  // First and last spline are omitted: the straight line replaces one, and the sum of all would be a
  // constant.
  smooth.distance_ = (values.maximum - values.minimum) / static_cast<double>(columns - 1);
  smooth.first_ = values.minimum;
  return smooth;
}

Smooth Smooth::periodic(const VariableValues& values, double turn) {
  Smooth smooth;
  if (!smooth.standardize(values)) return smooth;
  smooth.turn_ = turn;
  smooth.columns_ = 2 * harmonics;
  return smooth;
}

void Smooth::evaluate(double value, double* out) const {
  if (columns_ == 0) return;
  if (!has_line()) {
    const double angle = 2.0 * std::acos(-1.0) * value / turn_;
    for (std::size_t k = 0; k < harmonics; ++k) {
      out[2 * k] = std::cos(static_cast<double>(k + 1) * angle);
      out[2 * k + 1] = std::sin(static_cast<double>(k + 1) * angle);
    }
    return;
  }
  out[0] = (value - centre_) / deviation_;
  if (distance_ > 0.0) {
    const double position = (value - first_) / distance_;
    for (std::size_t k = 1; k < columns_; ++k) out[k] = spline_at(position + 2.0 - static_cast<double>(k));
    return;
  }
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
