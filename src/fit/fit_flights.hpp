#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include <pcor/residuals/residuals.hpp>
#include "campaign/linear_rows.hpp"
#include "campaign/reference_uncertainty.hpp"
#include "campaign/whitened.hpp"
#include "fit/fit_task.hpp"
#include "fit/loss_function.hpp"
#include "numerics/triangular_factor.hpp"
#include "parallel/serialization.hpp"

namespace pcor::internal {

/// Input of a fit from the flights, or of a stage of it.
struct FitSetup {
  Eigen::VectorXd values{};                     ///< start of all parameters; masks use these values
  std::vector<std::size_t> requested{};         ///< the fitted parameters
  std::vector<std::size_t> fixed_with_error{};  ///< fixed parameters with an error stated in the files
  /// If not empty, only samples in these intervals are used, and every interval has a separate offset of
  /// delta-p/p.
  std::vector<Regime> regimes{};

  /// The requested parameters, followed by the held ones.
  std::vector<std::size_t> parameters() const;
};

/// Residual parameters: from the fit where included, otherwise from their file.
Eigen::VectorXd flight_parameters(const Residuals& residuals, const FitTask& task,
                                  const Eigen::VectorXd& parameters);

/// The residuals of a flight, with this mask; if it is empty, it becomes that at these parameters of the fit.
Residuals residuals_at(std::shared_ptr<const FlightSamples> samples, const FitTask& task,
                       const Eigen::VectorXd& parameters, std::vector<Mask>& mask);

/// Derivatives of the residual by the requested parameters of the fit, zero for those that it does not have,
/// and the residual, hPa, at some samples. @param as_recorded see `LinearRows::evaluate`
Eigen::MatrixXd sample_rows(const LinearRows& rows, const FitTask& task,
                            const std::vector<std::size_t>& samples, const Eigen::VectorXd& parameters,
                            const std::vector<std::size_t>& requested, bool as_recorded);

/// The samples of one flight of a fit with one reference.
///
/// Derivatives by the coefficients of two static systems are taken at common pressures
/// (`Residuals::at_common_pressures`): at the solution they are orthogonal to the residual, a method of
/// instrumental variables and not of least squares.
class FitFlight {
 public:
  /// @param parameters those at which columns that depend on a coefficient are taken
  /// @param mask mask of every sample at the values of the setup; found if it is empty
  FitFlight(std::shared_ptr<const FlightSamples> samples, const FitTask& task, const FitSetup& setup,
            const Eigen::VectorXd& parameters, std::vector<Mask>& mask);

  const LinearRows& linear_rows() const { return rows_; }
  const Residuals& residuals() const { return rows_.residuals(); }
  const std::vector<std::size_t>& kept() const { return rows_.used(); }

  /// Whether other samples are used at these parameters.
  bool masks_change_at(const Eigen::VectorXd& parameters) const;

  /// Bins of the samples that do not depart from their neighbours at these parameters. A least-squares loss
  /// excludes no sample. @param spikes receives the number of excluded samples
  Binning bins(const Eigen::VectorXd& parameters, std::size_t& spikes) const;

  /// Derivatives by the offsets of the intervals, hPa, in bins.
  Eigen::MatrixXd by_offsets(const Binning& bins) const;

 private:
  const FitTask* task_;
  // Samples of `rows_`, if columns depend on coefficients.
  std::shared_ptr<FlightSamples> recomputed_samples_;
  LinearRows rows_;
};

/// Weighted rows of a flight at given parameters and loss.
///
/// The offsets of the intervals of a stage are internal to the flight: they minimise the loss, and the part
/// of the derivatives that they absorb is removed, so that derivatives of the minimum loss are exact (Golub
/// and Pereyra 1973, SIAM Journal on Numerical Analysis 10, 413).
struct FitRows {
  Eigen::MatrixXd columns{};      ///< derivatives by requested and held parameters
  Eigen::VectorXd innovations{};  ///< residuals with the offsets of minimum loss
  Eigen::MatrixXd offsets{};      ///< derivatives by the offsets

  /// Columns minus the part absorbed by offsets when the bins have these weights.
  Eigen::MatrixXd without_offsets(const Eigen::MatrixXd& columns, const Eigen::VectorXd& weights) const;
};

/// Result of a pass over all flights.
struct Reduction {
  /// Factor of weighted rows (derivatives by requested parameters, residual), minus the part absorbed by
  /// offsets.
  Eigen::MatrixXd factor;
  /// Sums of the squares of the same derivatives absorbed by offsets.
  Eigen::VectorXd absorbed;
  double cost = 0.0;  ///< half the sum of the loss over the innovations
  bool valid = true;  ///< false if some residual is not a number at these parameters

  /// Lengths of the derivatives, including the part absorbed by offsets.
  Eigen::VectorXd lengths() const;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(factor, absorbed, cost);
  }
};

/// The flights of a fit. Passes over them run several flights at a time, and each rank passes
/// over its own; results are added in the order of the flights, so they do not depend on the number of
/// threads or ranks. Residuals and derivatives of the local flights in bins stay in memory; the set keeps
/// the samples within its memory.
///
/// Derivatives of residuals other than static pressure, which hardly change and are slow to compute, and
/// those at common pressures stay fixed until the flights are prepared again.
class FitFlights {
 public:
  FitFlights(const FitTask& task, FitSetup setup);
  FitFlights(const FitFlights&) = delete;
  FitFlights& operator=(const FitFlights&) = delete;

  const FitTask& task() const { return task_; }
  const FitSetup& setup() const { return setup_; }
  const ReferenceUncertainty& uncertainty() const { return uncertainty_; }

  /// Flights with each further reference.
  const std::vector<std::unique_ptr<FitFlights>>& further() const { return further_; }

  /// Fitted entries: these and the further references that depend on some of the requested parameters.
  /// Numbers of flights and samples, masks and single figures refer to the first reference.
  const std::vector<FitFlights*>& joint() const { return joint_; }

  /// True if the residuals against all fitted references are linear in the free parameters.
  bool rows_are_linear() const;

  /// True if derivatives, or columns that depend on a coefficient, stay fixed until the flights are prepared
  /// again.
  bool uses_fixed_jacobian() const;

  /// True if columns depend on a coefficient, so that a first solution from a distant start is not final.
  bool has_parameter_dependent_columns() const;

  std::size_t count() const { return task_.flights.size(); }

  /// Whether the residual is linear in each of the parameters.
  const std::vector<bool>& is_linear() const { return linear_; }
  std::size_t samples() const { return samples_; }
  /// Number of intervals with a separate offset.
  std::size_t offsets() const { return offsets_; }
  /// Bins of all flights at the values of the setup.
  std::size_t bins() const { return bins_; }
  const std::array<std::size_t, mask_count>& masks() const { return masks_; }

  /// Results for every flight from its samples, in the order of flights, on every rank: one
  /// exchange.
  /// @param make gets the number of a flight and the flight; it is called by several threads
  /// @param parameters must agree between the ranks
  template <class Make>
  auto of_each(const Make& make, const Eigen::VectorXd& parameters = {}) {
    using Part = std::decay_t<decltype(make(std::size_t{}, std::declval<const FitFlight&>()))>;
    static_assert(!std::is_same_v<Part, bool>, "elements of std::vector<bool> share words between threads");
    return partition().all_gather_parts<Part>(
        [&](std::vector<Part>& parts) {
          visit([&](std::size_t number, const FitFlight& fit) { parts[number] = make(number, fit); });
        },
        digest_of(serialized(parameters)));
  }

  /// Matrices of the local flights from their samples; empty for the others.
  std::vector<Eigen::MatrixXd> of_local(
      const std::function<Eigen::MatrixXd(std::size_t flight, const FitFlight& fit)>& make);

  const FlightPartition& partition() const { return task_.flights.partition(); }

  /// Whether other samples of any flight are used at these parameters.
  bool masks_change_at(const Eigen::VectorXd& parameters);

  /// Sums of all references. @param free those of the requested parameters whose columns are requested
  Reduction reduce(const Eigen::VectorXd& parameters, const ScaledLoss& loss,
                   const std::vector<std::size_t>& free);
  Reduction reduce(const Eigen::VectorXd& parameters, const ScaledLoss& loss) {
    return reduce(parameters, loss, setup_.requested);
  }

  /// Triangular factor of rows (derivatives, residual) in hPa for the first reference, with equal weight for
  /// all samples.
  Eigen::MatrixXd unweighted_factor(const Eigen::VectorXd& parameters);

  /// Prepares bins, residuals and derivatives of every flight at these parameters; the noise stays, with a
  /// level for each of the new bins.
  void prepare(const Eigen::VectorXd& parameters);

  /// Prepares every flight, and renews the weight of each reference.
  void weigh(const Eigen::VectorXd& parameters);

  /// Whether the misfit of the law enters the residual against a fitted reference: against the first one,
  /// with which it is estimated, and against each that is a static pressure.
  bool sees_law(const FitFlights& reference) const {
    return &reference == this || reference.task().reference.is_static_pressure();
  }

  /// Misfit of the law in the bins of a local flight with one reference that sees it, hPa.
  using MisfitInBins = std::function<Eigen::VectorXd(const FitFlights& reference, std::size_t flight)>;

  /// Also estimates the noise of each reference.
  /// @param misfit excluded from the noise; may be empty
  void measure_noise(const Eigen::VectorXd& parameters, const MisfitInBins& misfit = {});

  /// Combined slow parts of the noise, hPa, after it was measured.
  double drift_rms() const;

  /// Weighs like the same reference in other samples of the same flights.
  void share_weight(const FitFlights& others) { deviation_ = others.deviation_; }

  /// Robust deviation of the innovations.
  double deviation(const Eigen::VectorXd& parameters);

  /// Number of excluded samples, and of samples in bins with an innovation beyond `limit`.
  std::size_t outliers(const Eigen::VectorXd& parameters, double limit);

  // Functions of a local flight.
  const Binning& bins(std::size_t flight) const { return binned_.bins[flight]; }
  /// Noise in these bins, after it was measured.
  const NoiseModel& noise(std::size_t flight) const { return noise_[flight]; }
  /// Derivatives by the requested and the held parameters, hPa per unit, in bins.
  const Eigen::MatrixXd& columns(std::size_t flight) const { return binned_.columns[flight]; }
  /// Residual in bins, hPa, without offsets.
  Eigen::VectorXd residual(std::size_t flight, const Eigen::VectorXd& parameters) const;
  /// Columns that have a row for each bin, with the weights of least squares.
  Eigen::MatrixXd weighted(std::size_t flight, const Eigen::MatrixXd& columns) const;
  FitRows rows(std::size_t flight, const Eigen::VectorXd& parameters, const ScaledLoss& loss) const;

 private:
  void visit(const std::function<void(std::size_t flight, const FitFlight& fit)>& work);
  /// Vectors of the local flights from their bins.
  std::vector<Eigen::VectorXd> of_bins(const std::function<Eigen::VectorXd(std::size_t flight)>& make) const;
  void prepare(std::size_t flight, const FitFlight& fit);
  void evaluate(std::size_t flight, const FitFlight& fit);
  void evaluate_at(const Eigen::VectorXd& parameters);
  bool sees_parameters();
  Eigen::Index requested() const { return as_index(setup_.requested.size()); }

  const FitTask& task_;
  const FitSetup setup_;
  const std::vector<std::size_t> columns_;  // parameters with a column
  const ReferenceUncertainty uncertainty_;
  std::vector<bool> linear_;
  bool rows_are_linear_ = true;
  std::size_t samples_ = 0;
  std::size_t offsets_ = 0;
  std::size_t bins_ = 0;
  std::array<std::size_t, mask_count> masks_{};
  Eigen::VectorXd prepared_;   // parameters of the bins, and of columns that depend on coefficients
  Eigen::VectorXd evaluated_;  // parameters of residuals and derivatives
  BinnedFlights binned_;
  std::vector<Eigen::MatrixXd> by_offsets_;  // derivatives by the offsets, hPa
  std::vector<std::size_t> spikes_;
  std::vector<std::vector<Mask>> masks_of_flights_;
  double deviation_ = 1.0;         // robust, residuals in bins, hPa: the weight of the reference
  std::vector<NoiseModel> noise_;  // empty before it was measured
  std::vector<std::unique_ptr<FitFlights>> further_;
  std::vector<FitFlights*> joint_{this};
};

}  // namespace pcor::internal
