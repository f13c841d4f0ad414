#pragma once

#include <optional>
#include <vector>

namespace pcor::internal::manoeuvres {

/// The value below which the part `share` of the finite values lies; NaN where there is none.
double quantile(std::vector<double> values, double share);

inline double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

struct Line {
  double offset = 0.0;
  double slope = 0.0;

  double at(double x) const { return offset + slope * x; }
};

/// The line of that slope which half of the finite points lie above; none where there are no such points.
std::optional<Line> line_of_slope(double slope, const std::vector<double>& x, const std::vector<double>& y);

/// A line through points of which up to a quarter may be anywhere: its slope is the median of those between
/// all pairs of points, weighted by their distance in x (Theil 1950, Sen 1968). None where fewer than ten
/// points are finite or x does not vary.
std::optional<Line> robust_line(const std::vector<double>& x, const std::vector<double>& y);

/// What was usual at each pressure: medians over 25 hPa, between them linear in the logarithm of the
/// pressure, beyond them constant.
class Profile {
 public:
  /// @param pressure hPa @param values one for each pressure; NaN where there is none
  /// @param otherwise the value everywhere if none is finite
  Profile(const std::vector<double>& pressure, const std::vector<double>& values, double otherwise);

  double at(double pressure) const;

  /// The pressures between which the profile is linear, hPa, decreasing; at least one.
  const std::vector<double>& pressures() const { return pressures_; }

 private:
  std::vector<double> pressures_;
  std::vector<double> values_;
};

}  // namespace pcor::internal::manoeuvres
