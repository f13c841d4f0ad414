#pragma once

#include <cstddef>
#include <string>

namespace pcor {

/// Standard error of delta-p, hPa, below which flights determine it. A correction removes errors of 1 to 6
/// hPa.
inline constexpr double max_defect_error = 1.0;

/// Statistics of residuals, hPa. NaN if there are too few samples.
struct Statistics {
  std::size_t samples = 0;
  double mean = 0.0;  ///< mean residual, hPa
  /// Mean residual (reference minus model), hPa: positive if delta-p is too small. Against wind or height its
  /// estimate without variations of the atmosphere, if they were separated.
  double bias = 0.0;
  /// Standard error of the bias, hPa, includes autocorrelation and drift of the noise.
  double bias_error = 0.0;
  double rms = 0.0;        ///< about zero, hPa
  double noise_rms = 0.0;  ///< noise floor over the same samples, hPa: the lowest of all models

  /// Standard deviation about the mean, hPa.
  double scatter() const;
  /// Ratio of the rms to that of the noise; NaN if the noise is unknown.
  double rms_over_noise() const;
};

template <class Field>
void describe(const Statistics& self, Field& field) {
  field("samples", self.samples, "number of samples");
  field(
      "bias_hpa", self.bias,
      "mean residual, reference minus model, without variations of the atmosphere where they were separated");
  field("mean_hpa", self.mean, "mean residual as measured");
  field("bias_stderr_hpa", self.bias_error, "standard error of the bias, with the correlation of the noise");
  field("rms_hpa", self.rms, "rms residual");
  field("scatter_hpa", self.scatter(), "standard deviation of the residual");
  field("noise_rms_hpa", self.noise_rms, "rms noise of the residual; by wind and height an upper limit");
}

/// True if the excess of the mean square over the noise is larger in `a` than in `b`. False if the noise is
/// unknown.
bool fails_more(const Statistics& a, const Statistics& b);

/// Text "excluded from the fit: 712 samples with flaps extended, residual +2.30 +- 0.40 hPa (standard error),
/// scatter 1.10 hPa"; empty without samples.
/// @param of_what for example "the fit"
std::string flaps_out_text(const Statistics& flaps_out, const std::string& of_what);

/// Residuals of a part of a flight that was excluded from a fit.
struct HeldOutPart {
  std::string flight;
  Statistics statistics;
  /// Expected standard deviation of the bias, hPa, for a model with the same accuracy as in the fit: from the
  /// scatter of means over five minutes, and over flights, in the fit; after a fit also from the errors of
  /// its coefficients and from the misfit of the model, and at least the standard error of the bias itself.
  double expected = 0.0;

  std::size_t parts = 1;  ///< number of parts that are tested together

  /// True if the bias is significant (p < 1/80 over all parts, Sidak).
  bool is_off() const;
  /// Clause on the bias and its significance, without full stop.
  std::string text() const;
};

}  // namespace pcor
