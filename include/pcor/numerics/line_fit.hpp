#pragma once

#include <cstddef>
#include <vector>

namespace pcor {

/// A straight line y = offset + slope x through samples. NaN where there are fewer than three, or x is
/// constant.
struct LineFit {
  double slope = 0.0;
  double offset = 0.0;        ///< in the unit of y
  double rms = 0.0;           ///< of the distances from the line that the fit makes small, in the unit of y
  double slope_error = 0.0;   ///< standard error, for independent samples
  double offset_error = 0.0;  ///< standard error of the offset, in the unit of y
  double mean_difference = 0.0;  ///< of y - x
  std::size_t samples = 0;
};

/// The line with the least squares of the distances in y: all noise is in y. Pairs with a NaN are left out.
LineFit ordinary_fit(const std::vector<double>& x, const std::vector<double>& y);

/// The line with the least squares of the distances perpendicular to it: x and y have equal noise (Deming's
/// fit with a ratio of one, with which the memo draws its figure 2). The error of the slope is that of
/// Deming's estimator for normal noise, slope sqrt((1 - r^2)/(n - 2))/r with the correlation r.
LineFit orthogonal_fit(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace pcor
