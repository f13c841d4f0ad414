#pragma once

#include <cmath>
#include <cstddef>
#include <string>

#include <pcor/base/note.hpp>
#include <pcor/regimes/regimes.hpp>
#include "fit/fit_flights.hpp"
#include "residuals/flight_statistics.hpp"

namespace pcor::internal {

/// Sums over the fitted samples of the first reference.
struct FitSums {
  ResidualSums before{};  ///< residuals with the input models
  ResidualSums after{};
  double bulk_squares_before = 0.0;  ///< robust deviation with the input models, hPa^2
  double bulk_squares = 0.0;
  double relative_squares = 0.0;  ///< residual over static pressure
  double reference_defect = 0.0;  ///< delta-p implied by the reference, hPa
  double reference_defect_squares = 0.0;

  void add(const FitSums& other);

  template <class Archive>
  void serialize(Archive& archive) {
    archive(before, after, bulk_squares_before, bulk_squares, relative_squares, reference_defect,
            reference_defect_squares);
  }

  double rms_of(double sum) const { return std::sqrt(sum / static_cast<double>(after.samples)); }
  /// R^2 of a model with that sum of squared residuals.
  double r_squared(double of_squares) const {
    return 1.0 - of_squares / (reference_defect_squares -
                               reference_defect * reference_defect / static_cast<double>(after.samples));
  }
};

/// Consecutive samples on one side of the noise.
struct OutlierRun {
  std::string flight{};
  std::size_t samples = 0;
  double begin = 0.0;  ///< s since 1970 UTC
  double end = 0.0;
  double mean = 0.0;  ///< hPa

  double duration() const { return end - begin; }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(flight, samples, begin, end, mean);
  }
};

/// The flights with the input models and with the fit.
struct BeforeAndAfter {
  FitSums sums{};
  OutlierRun longest_run{};  ///< fitted samples, first reference
  Notes notes{};             ///< about fitted flights
  RegimeSet flown{};         ///< regimes in the fitted flights
};

/// @param covariance of the fitted parameters, without the uncertainty of the reference, which is common to
/// the held-out samples
/// @param misfit_rms misfit of the law, hPa
/// @param result receives the statistics of the flights with each reference, and of samples with flaps
/// extended
BeforeAndAfter before_and_after(FitFlights& flights, const Eigen::VectorXd& values,
                                const Eigen::MatrixXd& covariance, double misfit_rms, RefitResult& result);

}  // namespace pcor::internal
