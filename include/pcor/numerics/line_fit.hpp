#pragma once

#include <cstddef>
#include <vector>

namespace pcor {

/// Straight line y = offset + slope x through samples. NaN for fewer than three samples, or constant x.
struct LineFit {
  double slope = 0.0;
  double offset = 0.0;           ///< offset, in the unit of y
  double rms = 0.0;              ///< rms of the minimised distances from the line, in the unit of y
  double slope_error = 0.0;      ///< standard error, for independent samples
  double offset_error = 0.0;     ///< standard error of the offset, in the unit of y
  double mean_difference = 0.0;  ///< mean of y - x
  std::size_t samples = 0;
};

/// Number, means and central sums of pairs: sufficient statistics of a line fit.
struct PairMoments {
  std::size_t samples = 0;
  double mean_x = 0.0;
  double mean_y = 0.0;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;

  /// Adds a pair; one with a NaN is left out.
  void add(double x, double y);
  /// Adds the pairs of another part (Chan, Golub and LeVeque 1983, The American Statistician 37, 242).
  void add(const PairMoments& other);
  /// Correlation, -1 to 1; NaN if one of the two is constant.
  double correlation() const;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(samples, mean_x, mean_y, xx, xy, yy);
  }
};

/// Least-squares line with respect to distances in y: all noise is in y. Pairs with a NaN are ignored.
LineFit ordinary_fit(const PairMoments& pairs);
LineFit ordinary_fit(const std::vector<double>& x, const std::vector<double>& y);

/// Least-squares line with respect to perpendicular distances: x and y have equal noise (Deming regression
/// with a variance ratio of 1, as in figure 2 of the memo). The error of the slope is that of Deming's
/// estimator for normal noise, slope sqrt((1 - r^2)/(n - 2))/r with the correlation r.
LineFit orthogonal_fit(const PairMoments& pairs);
LineFit orthogonal_fit(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace pcor
