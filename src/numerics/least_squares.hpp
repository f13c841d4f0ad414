#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace pcor::internal {

/// A number with its standard error.
struct Estimate {
  double value = 0.0;
  double error = 0.0;
};

inline Estimate operator*(double factor, const Estimate& number) {
  return {factor * number.value, std::abs(factor) * number.error};
}

/// Least squares of a few columns, with errors that know the memory and the slow drift of the noise.
struct LeastSquares {
  std::vector<Estimate> coefficients{};  ///< one for each column; NaN where the fit is not possible
  std::vector<double> residuals{};       ///< residual of each sample; NaN if the sample was not used
  double rms = 0.0;                      ///< rms of the residuals
  std::size_t samples = 0;
};

/// Fits y = c_1 x_1 + c_2 x_2 + ... over the samples at which all have a value. The covariance of the
/// coefficients is (X'X)^-1 X'C X (X'X)^-1 with the covariance C of the noise of the residuals, including
/// autocorrelation and slow drift (`expected_noise`). If the time decreases, or increases by more than an
/// hour, a new flight begins, whose noise is independent. NaN if the columns are not independent or there are
/// fewer than three samples more than columns.
LeastSquares least_squares(const std::vector<std::vector<double>>& columns, const std::vector<double>& y,
                           const std::vector<double>& time, double step);

/// The mean of a series, with its error and its scatter (`rms`): `least_squares` with a column of ones.
LeastSquares mean_of(const std::vector<double>& values, const std::vector<double>& time, double step);

/// Mean of independent estimates, weighted by their errors. If their scatter exceeds their errors, the error
/// follows from the scatter. NaN estimates are excluded; the mean of zero estimates is NaN.
Estimate combined(const std::vector<Estimate>& estimates);

}  // namespace pcor::internal
