#pragma once

#include <cmath>
#include <cstddef>

#include "fit/fit_flights.hpp"

namespace pcor::internal {

/// The sums behind rms and R^2 of the samples of a fit.
struct FitSums {
  double squares = 0.0;           ///< residuals, hPa^2
  double bulk_squares = 0.0;      ///< robust deviation, hPa^2
  double relative_squares = 0.0;  ///< residual over static pressure
  double wanted = 0.0;            ///< delta-p implied by the reference, hPa
  double wanted_squares = 0.0;
  std::size_t samples = 0;
  std::size_t outliers = 0;

  void add(const FitSums& other);

  template <class Archive>
  void serialize(Archive& archive) {
    archive(squares, bulk_squares, relative_squares, wanted, wanted_squares, samples, outliers);
  }

  double rms_of(double sum) const { return std::sqrt(sum / static_cast<double>(samples)); }
  /// R^2 of a model with that sum of squared residuals.
  double r_squared(double of_squares) const {
    return 1.0 - of_squares / (wanted_squares - wanted * wanted / static_cast<double>(samples));
  }
};

/// @param values of all parameters @param deviation scale of the residuals over their noise; a sample
/// beyond 4.685 times this is an outlier
FitSums sums_at(FitFlights& flights, const Eigen::VectorXd& values, double deviation);

}  // namespace pcor::internal
