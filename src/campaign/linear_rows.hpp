#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <pcor/residuals/residuals.hpp>
#include "numerics/binning.hpp"

namespace pcor::internal {

/// Where derivatives are taken.
enum class Inputs {
  none,        ///< nowhere: residuals alone are wanted
  recorded,    ///< as a fit does it: at the recorded samples
  noise_free,  ///< as a diagnosis does it: where the sensor of the reference shows what the model says
};

/// What is wanted of the rows of a flight.
struct RowsSetup {
  Inputs inputs = Inputs::none;
  /// The parameters that are free, where residuals are to be measured as a fit of these measures them.
  std::vector<std::size_t> free{};
  double first_part = 1.0;        ///< only the first part of the samples is used, 0 to 1
  std::vector<Regime> regimes{};  ///< where there are any, only samples of these are used
};

/// True where derivatives of the residuals of a reference stay the same in a fit: they are those of two
/// systems at common pressures, or those of no static pressure, which hardly change and take long to find.
bool keeps_derivatives(const Reference& reference);

/// The means of a series of a flight, NaN where not used, over a few seconds, or over as long as a residual
/// holds together. @param window `Reference::window`
Binning bins_of(const FlightSamples& samples, double window, const std::vector<double>& series);

/// One flight, a model, and one reference: residuals of samples, and derivatives by parameters, which a
/// linear model of the residuals is made of.
///
/// Fits, diagnoses, what-ifs and trials of models take their residuals and derivatives from here. How a
/// residual is measured, and at which values its derivatives are taken, is decided here alone.
class LinearRows {
 public:
  /// @param residuals of the model and the reference; as they are built, their masks are found or known
  LinearRows(Residuals residuals, const ModelDefinition& model, const Reference& reference,
             const RowsSetup& setup);

  const Residuals& residuals() const { return residuals_; }
  const FlightSamples& samples() const { return residuals_.samples(); }
  /// The samples at which derivatives are taken.
  const FlightSamples& inputs() const { return derived().samples(); }

  /// Why each sample takes part, or does not. Where derivatives are noise-free and a residual is
  /// made of its neighbours, all of these have to take part.
  const std::vector<Mask>& mask() const { return mask_; }
  /// The samples of the first part, and of the wanted regimes.
  const std::vector<std::size_t>& used() const { return used_; }
  /// The samples that would be used were they not behind the first part.
  const std::vector<std::size_t>& held_out() const { return held_out_; }
  /// Of each sample the number of its interval of a wanted regime, which all used ones have; empty without
  /// regimes.
  const std::vector<std::size_t>& intervals() const { return intervals_; }
  /// How many such intervals have used samples.
  std::size_t interval_count() const { return interval_count_; }

  /// Whether the residual counts as linear in the parameters that are free: derivatives that were taken once
  /// serve for all values of them.
  bool is_linear() const { return linear_; }

  /// Derivatives at some samples by some parameters, a column each, hPa per unit, and behind them the
  /// residual, hPa. @param as_recorded with the derivatives at the recorded samples, wherever others are
  /// taken
  Eigen::MatrixXd evaluate(const std::vector<std::size_t>& samples, const double* parameters,
                           const std::vector<std::size_t>& wanted, bool as_recorded = false) const;

  /// The bins of a series that has a value where a sample counts, NaN elsewhere.
  Binning bins(const std::vector<double>& series) const { return bins_of(samples(), window_, series); }

  /// The means over the bins of columns that have a row for each used sample.
  Eigen::MatrixXd bin_means(const Binning& bins, const Eigen::MatrixXd& rows) const;

  /// The means over the bins of derivatives by some parameters, and behind them of the residual.
  Eigen::MatrixXd means(const Binning& bins, const double* parameters,
                        const std::vector<std::size_t>& wanted) const;

 private:
  void choose_inputs(const ModelDefinition& model, const Reference& reference, Inputs inputs);
  void keep_regimes(const std::vector<Regime>& regimes);
  const Residuals& derived() const { return derived_ ? *derived_ : residuals_; }

  Residuals residuals_;
  std::optional<Residuals> derived_;  // where derivatives are taken elsewhere than at the recorded samples
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
