#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <vector>

#include "numerics/binning.hpp"

namespace pcor::internal {

/// Time constants of the drift components, s: a factor of four apart, so that their sum approximates a drift
/// of any such time constant, a random walk, or 1/f noise within a tenth of its power.
inline constexpr std::array<double, 5> drift_time_constants{50.0, 200.0, 800.0, 3200.0, 12800.0};

/// Noise of a series of binned residuals: an autoregression whose level changes every five minutes, plus
/// drift components, which are first-order processes with given time constants.
struct NoiseModel {
  std::vector<double> coefficients{};    ///< coefficients of the autoregression, from bin to bin, 12 at
                                         ///< most
  std::vector<Eigen::VectorXd> level{};  ///< rms of the innovations in each bin of each flight, hPa
  std::array<double, drift_time_constants.size()> drift_component_rms{};  ///< rms of each component, hPa
  double common_level = 0.0;     ///< level to which the level of each five minutes is shrunk,
                                 ///< hPa
  std::optional<double> mean{};  ///< mean of the residuals, if there are several flights, hPa
  double scale = 1.0;            ///< factor on the levels, beyond their estimate from the
                                 ///< residuals

  /// Whether any part of it is slow.
  bool has_drift() const;
};

/// A noise model, and how well it describes the residuals that it was found from.
struct FoundNoise {
  NoiseModel model{};
  double drift_gain = 0.0;  ///< twice the gain in restricted log-likelihood by the slow parts; may be
                            ///< slightly negative for more than 6,000 bins
  double likelihood = 0.0;  ///< twice the log-likelihood, with the columns at their best, without constants
};

/// A flight, as it may be chosen for the noise that all share.
struct NoiseFlight {
  double begin = 0.0;    ///< time of its first bin, s since 1970 UTC
  std::size_t bins = 0;  ///< number of bins with a value of its residual

  template <class Archive>
  void serialize(Archive& archive) {
    archive(begin, bins);
  }
};

/// Numbers, in increasing order, of the flights that determine the common part of the noise: all flights with
/// bins, if they are at most `maximum` flights with 50,000 bins (55 hours). Otherwise as many flights as
/// these limits allow, but at least four, spread over the time in which they were flown, among the flights
/// with at least a quarter of the mean number of bins, which have three quarters of all bins. The choice does
/// not depend on the order of the flights. If no flight has a bin, the first flight.
std::vector<std::size_t> flights_for_noise(const std::vector<NoiseFlight>& flights, std::size_t maximum = 16);

/// Estimates autoregression and level from residuals from which all effects are removed. Slow drift and, if
/// there are several flights, the differences between their means are subtracted first, so that they do not
/// appear as autocorrelation of the noise.
///
/// @param residuals of each flight, in bins, hPa
NoiseModel estimate_noise(const std::vector<Binning>& bins, const std::vector<Eigen::VectorXd>& residuals);

/// Level of each bin of a flight, for each five minutes, with the common part of the noise of the flights
/// that determined the noise. Such a flight has its levels in the noise model. If there were several, the
/// residual is moved to their mean.
///
/// @param residual in bins, hPa
Eigen::VectorXd noise_levels(const Binning& bins, const Eigen::VectorXd& residual, const NoiseModel& noise);

/// Complete noise of residuals to which columns are fitted: autoregression and levels by `estimate_noise`,
/// then the drift components and a common scale of all parts by maximum likelihood for the residuals of the
/// fit: restricted likelihood, which allows for the drift that the columns absorb (Patterson and Thompson
/// 1971, Biometrika 58, 545). Innovations beyond three standard deviations are limited to three. The drift of
/// more than 6,000 bins is found from means of three bins by the same likelihood at a given scale of the
/// faster noise, which the bins themselves determine, in turn.
///
/// @param columns of each flight, in bins: all fitted columns
/// @param residuals of each flight, in bins, after the fit, hPa
/// @param threads flights that are filtered at a time; 0: number of processors
FoundNoise find_noise(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                      const std::vector<Eigen::VectorXd>& residuals, std::size_t threads = 0);

/// Noise for the errors of means: the noise by `find_noise`; if it drifts, or if there are several flights,
/// the variances of its slowest components, from 800 s on, are expected values, averaged over sizes with
/// their restricted likelihood. A few flights determine these components poorly, and the most likely sizes
/// are too small on average.
NoiseModel expected_noise(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                          const std::vector<Eigen::VectorXd>& residuals, std::size_t threads = 0);

/// Noise extrapolated as 1/f noise beyond the length of the flights: each drift component is at least as
/// large as the mean of the two before it. One or two flights that do not show the slowest components do not
/// exclude them.
NoiseModel extrapolate_drift(NoiseModel noise);

/// The columns in units of the noise and without its memory: `Whitening` of one flight.
Eigen::MatrixXd whitened(const Eigen::Ref<const Eigen::MatrixXd>& columns, const Binning& bins,
                         const NoiseModel& noise, std::size_t flight);

}  // namespace pcor::internal
