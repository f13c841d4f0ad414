#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <optional>
#include <vector>

#include <pcor/residuals/residuals.hpp>
#include "numerics/binning.hpp"

namespace pcor::internal {

/// Points at which derivatives are evaluated.
enum class Inputs {
  none,        ///< not evaluated: residuals only
  recorded,    ///< recorded samples, or common pressures of two systems, for a fit
  noise_free,  ///< predicted pressures and laser, for a diagnosis
};

/// Options of the rows of a flight.
struct RowsSetup {
  Inputs inputs = Inputs::none;
  /// Free parameters, if residuals are computed as in a fit of these parameters.
  std::vector<std::size_t> free{};
  double first_part = 1.0;        ///< only the first part of the samples is used, 0 to 1
  std::vector<Regime> regimes{};  ///< if not empty, only samples of these regimes are used
};

/// True if derivatives of the residuals of a reference are constant in a fit: derivatives of two systems at
/// common pressures, or of references other than static pressure, which hardly change and are expensive.
bool keeps_derivatives(const Reference& reference);

/// Means of a series of a flight, NaN if not used, over a few seconds, or over the window of a residual.
/// @param window `Reference::window`
Binning bins_of(const FlightSamples& samples, double window, const std::vector<double>& series);

/// Flight, model, and reference: residuals of samples, and derivatives with respect to parameters, which form
/// a linear model of the residuals.
///
/// Fits, diagnoses, what-ifs and trials of models take their residuals and derivatives from this class, which
/// alone defines the residual and the evaluation point of its derivatives.
class LinearRows {
 public:
  /// @param residuals of the model and the reference; the constructor computes their masks or uses given ones
  LinearRows(Residuals residuals, const ModelDefinition& model, const Reference& reference,
             const RowsSetup& setup);

  const Residuals& residuals() const { return residuals_; }
  const FlightSamples& samples() const { return residuals_.samples(); }
  /// Samples at which derivatives are evaluated.
  const FlightSamples& inputs() const { return (derived_ ? *derived_ : residuals_).samples(); }

  /// Mask of each sample. If derivatives are noise-free and a residual depends on its neighbours, all of
  /// these must be usable.
  const std::vector<Mask>& mask() const { return mask_; }
  /// Samples of the first part, and of the requested regimes.
  const std::vector<std::size_t>& used() const { return used_; }
  /// Samples after the first part that are otherwise usable.
  const std::vector<std::size_t>& held_out() const { return held_out_; }
  /// Interval number, in a requested regime, of each sample, defined for all used samples; empty without
  /// regimes.
  const std::vector<std::size_t>& intervals() const { return intervals_; }
  /// Number of these intervals with used samples.
  std::size_t interval_count() const { return interval_count_; }

  /// Whether the residual counts as linear in the free parameters: derivatives evaluated once apply to all
  /// their values.
  bool is_linear() const { return linear_; }

  /// Derivatives at some samples with respect to some parameters, a column each, hPa per unit, followed by
  /// the residual, hPa. @param as_recorded derivatives at the recorded samples in all cases
  Eigen::MatrixXd evaluate(const std::vector<std::size_t>& samples, const double* parameters,
                           const std::vector<std::size_t>& requested, bool as_recorded = false) const;

  /// Bins of a series with values at the used samples, NaN elsewhere.
  Binning bins(const std::vector<double>& series) const { return bins_of(samples(), window_, series); }

  /// Bin means of columns that have a row for each used sample.
  Eigen::MatrixXd bin_means(const Binning& bins, const Eigen::MatrixXd& rows) const;

 private:
  void choose_inputs(const ModelDefinition& model, const Reference& reference, Inputs inputs);
  void keep_regimes(const std::vector<Regime>& regimes);

  Residuals residuals_;
  std::optional<Residuals> derived_;  // set if derivatives are evaluated away from the recorded samples
  double window_;
  bool linear_;
  bool at_sensor_;
  std::vector<Mask> mask_;
  std::vector<std::size_t> used_;
  std::vector<std::size_t> held_out_;
  std::vector<std::size_t> intervals_;
  std::size_t interval_count_ = 0;
};

}  // namespace pcor::internal
