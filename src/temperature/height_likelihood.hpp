#pragma once

#include <Eigen/Dense>
#include <array>
#include <functional>
#include <vector>

#include "parallel/workers.hpp"
#include "temperature/height_record.hpp"

namespace pcor::internal {

/// The noise of heights: what the height by GPS less the integral of the hydrostatic equation does besides
/// the error of the thermometer.
///
/// The integral drifts: where isobaric surfaces are not level or not still, an error made once stays. So the
/// difference is a random walk, and the slope of the isobars, a state of its own, adds what the aircraft
/// flies along it; the GPS adds noise that remembers itself and noise that does not.
struct HeightNoise {
  double white = 0.3;          ///< of a block's mean height, m
  double wander = 0.3;         ///< of the slow part of the GPS noise, m
  double wander_time = 60.0;   ///< its memory, s
  double walk = 0.01;          ///< random walk of the integral, m/s^(1/2)
  double slope_change = 1e-7;  ///< random walk of the slope of the isobars, 1/s^(1/2)
};

/// What the fit is told of a flight and does not find.
struct HeightPrior {
  /// Usual slope of the isobars at the start, each direction; of it is in a flight what
  /// `HeightRecord::slope_left` says. 0: they are level.
  double slope = 1e-4;
  /// Standard deviation of each error before the heights are seen, the same in all flights, in the units of
  /// `HeightError`. 0: there is none, or it is not asked.
  std::array<double, height_errors> errors{};
};

/// The Gaussian likelihood of heights, reduced to what the coefficients need: up to a constant,
///
///     -2 ln L = log_determinant + squares - 2 c' right + c' information c + sum (b/size)^2
///
/// where c = (a, b): coefficients a of the temperature, of which there may be fewer, and errors b of the
/// static pressure and the humidity, which have a size beforehand. Those of size 0 are none.
struct HeightEquations {
  static constexpr Eigen::Index unknowns = calibration_terms + height_errors;
  using Matrix = Eigen::Matrix<double, unknowns, unknowns>;
  using Vector = Eigen::Matrix<double, unknowns, 1>;

  Matrix information = Matrix::Zero();
  Vector right = Vector::Zero();
  std::array<double, height_errors> sizes{};
  double squares = 0.0;
  double log_determinant = 0.0;
  std::size_t blocks = 0;

  HeightEquations& operator+=(const HeightEquations& other);

  template <class Archive>
  void serialize(Archive& archive) {
    archive(information, right, sizes, squares, log_determinant, blocks);
  }

  /// -2 ln L at the best coefficients of the first `terms` powers, the others zero.
  double deviance(Eigen::Index terms) const;
  /// The best coefficients of the first `terms` powers, and their covariance: with the other errors
  /// at their best, and not known.
  Eigen::VectorXd best(Eigen::Index terms) const;
  Eigen::MatrixXd covariance(Eigen::Index terms) const;
  /// All unknowns at their best with the first `terms` powers, the others zero, and their covariance.
  Vector best_unknowns(Eigen::Index terms) const;
  Matrix covariance_of_unknowns(Eigen::Index terms) const;
  /// ln det of the information on the first `terms` coefficients and the other errors.
  double log_information(Eigen::Index terms) const;
  /// -2 ln L at given coefficients of the first powers, the other errors at their best.
  double deviance_at(const Eigen::VectorXd& coefficients) const;
  /// What the heights alone say of all unknowns, not what is known beforehand: -2 ln L without the last sum.
  double deviance_of_heights(const Vector& all) const;
};

/// One pass of a Kalman filter over a flight: states are the drift of the integral, the slow GPS noise, the
/// two slopes of the isobars. The integral of every stretch starts at an unknown height. Coefficients and
/// other errors enter as columns that are filtered like the data, so one pass serves all values of
/// them. Time grows with the number of blocks.
HeightEquations height_equations(const HeightRecord& record, const HeightNoise& noise,
                                 const HeightPrior& prior);

/// The innovations of that filter at given coefficients, in standard deviations: white with variance 1 where
/// the noise is as described. NaN at the start of a stretch.
std::vector<double> height_innovations(const HeightRecord& record, const HeightNoise& noise,
                                       const HeightPrior& prior, const HeightEquations::Vector& unknowns);

/// The record with the unknowns taken off its heights.
HeightRecord without_unknowns(HeightRecord record, const HeightEquations::Vector& unknowns);

/// The sum over flights, which the workers share: the same to the last bit whoever they are.
HeightEquations height_equations(const std::vector<HeightRecord>& records, const HeightNoise& noise,
                                 const HeightPrior& prior, const Workers& workers);

/// What `maximise_likelihood` found.
struct MostLikely {
  HeightNoise noise;
  HeightEquations equations;
  double deviance = 0.0;  ///< -2 ln of the restricted likelihood
};

/// A coefficient that does not follow the others.
struct HeldCoefficient {
  Eigen::Index term = 0;
  double value = 0.0;
};

/// The noise that makes the heights likeliest, with the coefficients of the first `terms` powers at their
/// best, or one of them held. NLopt searches (BOBYQA) over the logarithms of the noise from `start` on.
MostLikely maximise_likelihood(const std::vector<HeightRecord>& records, Eigen::Index terms,
                               const HeightPrior& prior, const HeightNoise& start, const Workers& workers,
                               const HeldCoefficient* held = nullptr);

/// The covariance of the best coefficients of the first `terms` powers, with what is not known of the noise
/// in it: the mean of their covariance C over noises that are likely, and the variance of their best values
/// a,
///
///     C + sum_k { (C(+k) + C(-k))/2 - C + (a(+k) - a(-k)) (a(+k) - a(-k))'/4 }
///
/// where +-k are one standard deviation from the likeliest noise, along the principal axes of -2 ln L over
/// the logarithms: there it is 1 higher. Each logarithm counts as known to 1.5 beforehand, a factor of 4.5.
/// Never smaller than C; C itself where not all of it is finite. Where several hours tell the noise,
/// errors are some 5 % larger than those of C, and as near as 5 % to an integral over all likely noises.
/// After Rue, Martino & Chopin, J. R. Statist. Soc. B 71 (2009), with points on the axes alone; of the kind
/// of Kenward & Roger, Biometrics 53 (1997). Some 40 passes over the flights.
///
/// @param likely what `maximise_likelihood` found for the same flights, terms and prior, with none held
Eigen::MatrixXd covariance_over_noise(const std::vector<HeightRecord>& records, Eigen::Index terms,
                                      const HeightPrior& prior, const MostLikely& likely,
                                      const Workers& workers);

}  // namespace pcor::internal
