#include "diagnose/manoeuvres/statistics.hpp"
#include "numerics/missing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <utility>

#include <pcor/physics/standard_atmosphere.hpp>

namespace pcor::internal::manoeuvres {
namespace {

struct Point {
  double x;
  double y;
};

std::vector<Point> finite_points(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::isfinite(x[i]) && std::isfinite(y[i])) points.push_back({x[i], y[i]});
  }
  return points;
}

/// At most `most` of the points, evenly spaced.
std::vector<Point> thinned(const std::vector<Point>& points, std::size_t most) {
  if (points.size() <= most) return points;
  std::vector<Point> some(most);
  for (std::size_t i = 0; i < most; ++i) some[i] = points[i * points.size() / most];
  return some;
}

}  // namespace

double quantile(std::vector<double> values, double share) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double x) { return !std::isfinite(x); }),
               values.end());
  if (values.empty()) return nan;
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

std::optional<Line> line_of_slope(double slope, const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> rest;
  for (const Point& point : finite_points(x, y)) rest.push_back(point.y - slope * point.x);
  if (rest.empty()) return std::nullopt;
  return Line{median(std::move(rest)), slope};
}

std::optional<Line> robust_line(const std::vector<double>& x, const std::vector<double>& y) {
  constexpr std::size_t least = 10;
  constexpr std::size_t most = 400;  // 80 000 pairs
  const std::vector<Point> points = thinned(finite_points(x, y), most);
  if (points.size() < least) return std::nullopt;
  struct Slope {
    double value;
    double weight;
  };
  std::vector<Slope> slopes;
  double all = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const double across = points[i].x - points[k].x;
      if (across == 0.0) continue;
      slopes.push_back({(points[i].y - points[k].y) / across, std::abs(across)});
      all += std::abs(across);
    }
  }
  if (slopes.empty()) return std::nullopt;
  std::sort(slopes.begin(), slopes.end(), [](const Slope& a, const Slope& b) { return a.value < b.value; });
  double below = 0.0;
  const auto middle = std::find_if(slopes.begin(), slopes.end(), [&](const Slope& slope) {
    below += slope.weight;
    return below >= 0.5 * all;
  });
  return line_of_slope(middle == slopes.end() ? slopes.back().value : middle->value, x, y);
}

Profile::Profile(const std::vector<double>& pressure, const std::vector<double>& values, double otherwise) {
  constexpr double width = 25.0;      // hPa
  constexpr std::size_t enough = 10;  // values for a median
  struct Bin {
    std::vector<double> pressure;
    std::vector<double> values;
  };
  std::map<int, Bin, std::greater<>> bins;
  for (std::size_t i = 0; i < pressure.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    Bin& bin = bins[static_cast<int>(pressure[i] / width)];
    bin.pressure.push_back(pressure[i]);
    bin.values.push_back(values[i]);
  }
  const bool all_small = std::all_of(bins.begin(), bins.end(),
                                     [](const auto& entry) { return entry.second.values.size() < enough; });
  for (auto& [place, bin] : bins) {
    if (bin.values.size() < enough && !all_small) continue;
    pressures_.push_back(median(std::move(bin.pressure)));
    values_.push_back(median(std::move(bin.values)));
  }
  if (pressures_.empty()) {
    pressures_.push_back(pressure.empty() ? standard_layers.front().pressure : median(pressure));
    values_.push_back(otherwise);
  }
}

double Profile::at(double pressure) const {
  const auto above = std::lower_bound(pressures_.begin(), pressures_.end(), pressure, std::greater<>());
  if (above == pressures_.begin()) return values_.front();
  if (above == pressures_.end()) return values_.back();
  const auto i = static_cast<std::size_t>(above - pressures_.begin());
  const double part = std::log(pressure / pressures_[i - 1]) / std::log(pressures_[i] / pressures_[i - 1]);
  return values_[i - 1] + part * (values_[i] - values_[i - 1]);
}

}  // namespace pcor::internal::manoeuvres
