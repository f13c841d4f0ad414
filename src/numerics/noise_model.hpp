#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "numerics/binning.hpp"

namespace pcor::internal {

/// For how long each slow part of the noise remembers itself, s: a factor of four apart, so that their sum
/// follows a drift of any such time, a random walk, or 1/f noise, within a tenth of its power.
inline constexpr std::array<double, 5> slow_times{50.0, 200.0, 800.0, 3200.0, 12800.0};

/// The noise of a series of binned residuals: an autoregression whose level changes every five minutes, and
/// beside it slow parts, first-order processes of fixed times.
struct NoiseModel {
  std::vector<double> coefficients{};            ///< of the autoregression, from bin to bin
  std::vector<Eigen::VectorXd> level{};          ///< of each flight's bins: rms of the innovations, hPa
  std::array<double, slow_times.size()> slow{};  ///< rms of each slow part, hPa
  double common_level = 0.0;                     ///< to which that of each five minutes is drawn, hPa
  double scale = 1.0;                            ///< of the levels, beside what residuals tell of them

  /// Whether any part of it is slow.
  bool drifts() const;
};

/// The level of the noise of a flight from a time on, until that of the next.
struct NoiseLevel {
  double begin = 0.0;  ///< s
  double rms = 0.0;    ///< of the innovations, hPa
};

/// A noise model, and how well it describes the residuals that it was found from.
struct FoundNoise {
  NoiseModel model{};
  double drift_gain = 0.0;  ///< twice the gain in restricted log-likelihood by the slow parts
  double likelihood = 0.0;  ///< twice the log-likelihood, with the columns at their best, without constants
};

/// Estimates autoregression and level from residuals that hold no effect any more. Slow drift is taken off
/// before, so that it does not pass for memory of the noise.
///
/// @param residuals of each flight, in bins, hPa
NoiseModel estimate_noise(const std::vector<Binning>& bins, const std::vector<Eigen::VectorXd>& residuals);

/// The levels of a flight, every five minutes, with what it shares with the flights from which the noise was
/// found. One of those has the levels that it has in the noise model.
///
/// @param residual in bins, hPa
std::vector<NoiseLevel> noise_levels(const Binning& bins, const Eigen::VectorXd& residual,
                                     const NoiseModel& noise);

/// The same levels bin by bin, of the bins of any part of the flight. @param levels one at least
Eigen::VectorXd level_of_bins(const std::vector<NoiseLevel>& levels, const Binning& bins);

/// The whole of the noise of residuals that columns are fitted to: autoregression and levels by
/// `estimate_noise`, then the slow parts, and the scale of all parts, that are most likely for what the
/// columns leave: by restricted likelihood, which knows that columns take up some of a drift (Patterson and
/// Thompson 1971, Biometrika 58, 545). Innovations beyond three deviations count as if they were at that
/// limit.
///
/// @param columns of each flight, in bins: of all that is fitted
/// @param residuals of each flight, in bins, after the fit, hPa
/// @param threads flights that are filtered at a time; 0: as many as processors
FoundNoise find_noise(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                      const std::vector<Eigen::VectorXd>& residuals, std::size_t threads = 0);

/// The noise for the errors of means: that of `find_noise`, where it drifts with the variances of its slowest
/// parts, from 800 s on, as they are expected, averaged over sizes with their restricted likelihood. A few
/// flights tell these parts badly, and the most likely sizes are too small in the mean.
NoiseModel expected_noise(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                          const std::vector<Eigen::VectorXd>& residuals, std::size_t threads = 0);

/// The noise as if it went on beyond what the flights tell: each part as large, at least, as the two before
/// it are in the mean, as it is of 1/f noise. That the slowest parts are not seen in a flight or two does not
/// say that they are not there.
NoiseModel with_slower_noise(NoiseModel noise);

/// The columns in units of the noise and without its memory: `Whitening` of one flight.
Eigen::MatrixXd whitened(const Eigen::Ref<const Eigen::MatrixXd>& columns, const Binning& bins,
                         const NoiseModel& noise, std::size_t flight);

}  // namespace pcor::internal
