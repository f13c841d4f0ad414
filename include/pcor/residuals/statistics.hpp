#pragma once

#include <cstddef>
#include <string>

namespace pcor {

/// What residuals, hPa, amount to over some samples. NaN where there are too few samples.
struct Statistics {
  std::size_t samples = 0;
  double bias = 0.0;        ///< mean residual, hPa
  double bias_error = 0.0;  ///< its standard error, hPa, with memory and drift of the noise
  double rms = 0.0;         ///< about zero, hPa
  double noise_rms = 0.0;   ///< of the noise floor over the same samples, hPa: the lowest of all models

  /// The scatter about the bias, hPa.
  double scatter() const;
  /// By how much the rms is larger than the noise alone would make it; NaN where the noise is not known.
  double rms_over_noise() const;
};

/// Whether a model fails more in `a` than in `b`: by how much the mean square is above that of the noise.
/// Where the noise is not known nothing is said to fail.
bool fails_more(const Statistics& a, const Statistics& b);

/// "not in the fit: 712 samples with flaps out, residual +2.30 +- 0.40 hPa"; empty where there are none.
/// @param of_what for example "the fit"
std::string flaps_out_text(const Statistics& flaps_out, const std::string& of_what);

/// Residuals of a part of a flight that took no part in a fit.
struct HeldOutPart {
  std::string flight;
  Statistics statistics;
  /// The standard deviation of the bias, hPa, if the model were as right there as where it was fitted: from
  /// how the means over five minutes, and over flights, wander in the fit; after a fit also from the errors
  /// of its coefficients and from what the law lacks.
  double expected = 0.0;

  std::size_t parts = 1;  ///< of which this one was chosen, being furthest off

  /// Whether the bias is more than chance makes it, once in eighty times in all parts together (Sidak).
  bool is_off() const;
  /// What that says, a sentence without its full stop.
  std::string text() const;
};

}  // namespace pcor
