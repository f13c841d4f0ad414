#pragma once

#include <Eigen/Dense>
#include <vector>

#include "parallel/workers.hpp"
#include "temperature/height_record.hpp"

namespace pcor::internal {

/// Noise model of heights: GPS height minus integral of the hydrostatic equation, except for the thermometer
/// error.
///
/// The integral drifts: if isobaric surfaces are not level or not stationary, errors accumulate. The
/// difference is therefore a random walk, plus the slope of the isobars, a separate state, times the distance
/// flown; the GPS adds correlated and white noise.
struct HeightNoise {
  double white = 0.3;          ///< white noise of a block's mean height, m
  double wander = 0.3;         ///< correlated part of the GPS noise, m
  double wander_time = 60.0;   ///< its memory, s
  double walk = 0.01;          ///< random walk of the integral, m/s^(1/2)
  double slope_change = 1e-7;  ///< random walk of the slope of the isobars, 1/s^(1/2)
};

/// Fixed prior information of the fit on a flight.
struct HeightPrior {
  /// Prior standard deviation of the slope of the isobars, each direction; scaled in a flight by
  /// `HeightRecord::slope_fraction`. 0: level.
  double slope = 1e-4;
  /// Prior standard deviation of each error, the same in all flights, in the units of `HeightError`; 0
  /// excludes the error. The coefficients of the calibration have no prior: their entries are 0.
  HeightUnknowns sizes = HeightUnknowns::Zero();
};

/// Gaussian likelihood of heights, reduced to the normal equations of the coefficients: up to a constant,
///
///     -2 ln L = log_determinant + squares - 2 c' right + c' information c + sum (b/size)^2
///
/// where c = (a, b): coefficients a of the temperature, of which there may be fewer, and errors b of the
/// static pressure and the humidity, which have a prior. Errors with a prior of size 0 are excluded.
struct HeightEquations {
  using Matrix = Eigen::Matrix<double, height_unknowns, height_unknowns>;

  Matrix information = Matrix::Zero();
  HeightUnknowns right = HeightUnknowns::Zero();
  HeightUnknowns sizes = HeightUnknowns::Zero();  ///< standard deviations of the prior
  double squares = 0.0;
  double log_determinant = 0.0;

  HeightEquations& operator+=(const HeightEquations& other);

  template <class Archive>
  void serialize(Archive& archive) {
    archive(information, right, sizes, squares, log_determinant);
  }

  /// -2 ln L at the best coefficients of the first `terms` powers, the others zero.
  double deviance(Eigen::Index terms) const;
  /// The best coefficients of the first `terms` powers, and their covariance: with the other errors
  /// at their best, and not known.
  Eigen::VectorXd best(Eigen::Index terms) const;
  Eigen::MatrixXd covariance(Eigen::Index terms) const;
  /// All unknowns at their best with the first `terms` powers, the others zero, and their covariance.
  HeightUnknowns best_unknowns(Eigen::Index terms) const;
  Matrix covariance_of_unknowns(Eigen::Index terms) const;
  /// ln det of the information on the first `terms` coefficients and the other errors.
  double log_information(Eigen::Index terms) const;
  /// -2 ln L at given coefficients of the first powers, the other errors at their best.
  double deviance_at(const Eigen::VectorXd& coefficients) const;
  /// Deviance of the heights without the prior: -2 ln L without the last sum.
  double deviance_of_heights(const HeightUnknowns& all) const;
};

/// One pass of a Kalman filter over a flight: states are the drift of the integral, the slow GPS noise, the
/// two slopes of the isobars. The integral of every stretch starts at an unknown height. Coefficients and
/// other errors enter as columns that are filtered like the data, so one pass serves all values of
/// them. Time grows with the number of blocks.
HeightEquations height_equations(const HeightRecord& record, const HeightNoise& noise,
                                 const HeightPrior& prior);

/// Innovations of that filter at given coefficients, in standard deviations: white with variance 1 for a
/// correct noise model. NaN at the start of a segment.
std::vector<double> height_innovations(const HeightRecord& record, const HeightNoise& noise,
                                       const HeightPrior& prior, const HeightUnknowns& unknowns);

/// Record with the fitted unknowns subtracted from its heights.
HeightRecord without_unknowns(HeightRecord record, const HeightUnknowns& unknowns);

/// Sum over flights, computed in parallel: identical to the last bit for any assignment of workers.
HeightEquations height_equations(const std::vector<HeightRecord>& records, const HeightNoise& noise,
                                 const HeightPrior& prior, const Workers& workers);

/// Result of `maximise_likelihood`.
struct MostLikely {
  HeightNoise noise;
  HeightEquations equations;
  double deviance = 0.0;  ///< -2 ln of the restricted likelihood
};

/// Maximum-likelihood noise, with the coefficients of the first `terms` powers optimised. NLopt (BOBYQA)
/// searches over the logarithms of the noise, from `start`.
MostLikely maximise_likelihood(const std::vector<HeightRecord>& records, Eigen::Index terms,
                               const HeightPrior& prior, const HeightNoise& start, const Workers& workers);

/// Covariance of the best coefficients of the first `terms` powers, including the uncertainty of the noise:
/// the mean of their covariance C over likely noises, and the variance of their best values a,
///
///     C + sum_k { (C(+k) + C(-k))/2 - C + (a(+k) - a(-k)) (a(+k) - a(-k))'/4 }
///
/// where +-k are one standard deviation from the most likely noise, along the principal axes of -2 ln L over
/// the logarithms: there it is 1 higher. The prior of each logarithm is 1.5, a factor of 4.5. Never smaller
/// than C; C itself if not all of it is finite. For several hours of data, errors are about 5 % larger than
/// those of C, and within 5 % of an integral over all likely noises. After Rue, Martino & Chopin, J. R.
/// Statist. Soc. B 71 (2009), with points only on the axes; similar to Kenward & Roger, Biometrics 53 (1997).
/// About 40 passes over the flights.
///
/// @param likely what `maximise_likelihood` found for the same flights, terms and prior
Eigen::MatrixXd covariance_over_noise(const std::vector<HeightRecord>& records, Eigen::Index terms,
                                      const HeightPrior& prior, const MostLikely& likely,
                                      const Workers& workers);

}  // namespace pcor::internal
