#pragma once

#include <Eigen/Dense>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <pcor/residuals/residuals.hpp>
#include "campaign/linear_rows.hpp"
#include "campaign/reference_doubt.hpp"
#include "fit/fit_task.hpp"
#include "fit/loss_function.hpp"
#include "numerics/noise_model.hpp"
#include "numerics/triangular_factor.hpp"
#include "numerics/whitening.hpp"

namespace pcor::internal {

/// Input of a stage of a fit from the flights.
struct FitSetup {
  Eigen::VectorXd values{};           ///< start of all parameters; masks use these values
  std::vector<std::size_t> wanted{};  ///< the parameters that are fitted
  /// If not empty, only samples in these intervals are used, and every interval has a separate offset of
  /// delta-p/p.
  std::vector<Regime> regimes{};
};

/// Noise of the flights of a fit: the shared part, and the levels of each flight.
struct FitNoise {
  double deviation = 1.0;  ///< robust, residuals in bins, hPa: the weight of the reference
  NoiseModel shared{};
  std::vector<std::vector<NoiseLevel>> levels{};
};

/// Number of first fit parameters that are also the first parameters of the residuals.
std::size_t shared_parameters(const Residuals& residuals, const FitTask& task);

/// Residual parameters: from the fit where included, otherwise from their file.
Eigen::VectorXd own_parameters(const Residuals& residuals, const FitTask& task,
                               const Eigen::VectorXd& parameters);

/// The residuals of a flight, with the masks at these parameters of the fit.
Residuals residuals_at(std::shared_ptr<const FlightSamples> samples, const FitTask& task,
                       const Eigen::VectorXd& parameters);

/// The derivatives of the residual by the wanted parameters of the fit, mean over some samples.
Eigen::VectorXd mean_derivatives(const LinearRows& rows, const FitTask& task,
                                 const std::vector<std::size_t>& samples, const Eigen::VectorXd& parameters,
                                 const std::vector<std::size_t>& wanted);

/// One flight of a fit with one reference: its samples in bins of a few seconds, or as long as the residual's
/// window, and their residuals and derivatives, whitened in units of the noise.
///
/// The offsets of the intervals of a stage are internal to the flight: at given parameters and loss they
/// minimise the loss, and the part of the derivatives that they absorb is removed, so that derivatives of the
/// minimum loss are exact (Golub and Pereyra 1973, SIAM Journal on Numerical Analysis 10, 413).
///
/// Derivatives by the coefficients of two static systems are taken at common pressures
/// (`Residuals::at_common_pressures`) and stay fixed until the flight is prepared again: at the solution they
/// are orthogonal to the residual, a method of instrumental variables and not of least squares. Derivatives
/// of residuals other than static pressure stay fixed as well: they hardly change and are slow to compute.
class FitFlight {
 public:
  FitFlight(std::shared_ptr<const FlightSamples> samples, const FitTask& task, const FitSetup& setup);

  const LinearRows& linear_rows() const { return rows_; }
  const Residuals& residuals() const { return rows_.residuals(); }
  const std::vector<std::size_t>& kept() const { return rows_.used(); }
  /// Number of intervals with a separate offset.
  std::size_t offsets() const { return rows_.interval_count(); }
  const Binning& bins() const { return bins_; }
  double static_pressure(std::size_t kept) const { return (*static_pressure_)[rows_.used()[kept]]; }

  /// Finds samples that depart from their neighbours at these parameters, excludes them permanently, and
  /// prepares the bins of the others. A least-squares loss excludes no sample.
  void prepare(const Eigen::VectorXd& parameters);

  /// Whether other samples are used at these parameters.
  bool masks_change_at(const Eigen::VectorXd& parameters) const;

  /// Sets the noise to entry `flight` of `noise`; without noise all bins have equal weight.
  void set_noise(const FitNoise& noise, std::size_t flight);

  /// Derivatives by the wanted parameters, and the residual, hPa, by columns, one row for each bin; without
  /// offsets.
  Eigen::MatrixXd rows(const Eigen::VectorXd& parameters) const;

  /// Whitened rows in units of the noise: the last column contains the innovations with the offsets of
  /// minimum loss, from Huber's solution if a loss has several minima.
  Eigen::MatrixXd white_rows(const Eigen::VectorXd& parameters, const ScaledLoss& loss) const;

  /// Whitened columns minus the part absorbed by offsets when the bins have these weights.
  Eigen::MatrixXd without_offsets(const Eigen::MatrixXd& columns, const Eigen::VectorXd& weights) const;

  /// Whitened derivatives by any parameters, in units of the noise.
  Eigen::MatrixXd white_columns(const Eigen::VectorXd& parameters,
                                const std::vector<std::size_t>& wanted) const;

  /// Effect of one standard uncertainty of each reference error on the residual, in the same units.
  Eigen::MatrixXd white_doubts(const ReferenceDoubt& doubt, const Eigen::VectorXd& parameters) const;

  /// Weighted columns with one row per bin; the weight is the square root of the samples in a bin over the
  /// deviation of the reference, as in least squares of samples. If the reference combines many samples
  /// (wind, heights), the columns are whitened in units of the noise.
  Eigen::MatrixXd white(const Eigen::MatrixXd& columns) const;

  /// Whitened columns in units of the noise.
  Eigen::MatrixXd without_noise(const Eigen::MatrixXd& columns) const {
    return Whitening(bins_, noise_, 0)(columns);
  }

  /// Weights of the scores: left' diag(weight) residual = weighted' (residual in hPa).
  Eigen::MatrixXd weighted(const Eigen::MatrixXd& left, const Eigen::VectorXd& weight) const {
    return scale_.cwiseProduct(weight).asDiagonal() * left;
  }

  /// The covariance of the sums of the noise times columns that have a row for each bin.
  Eigen::MatrixXd covariance_of_sums(const Eigen::MatrixXd& columns) const;

  /// Whether `white` removes the correlation of the noise.
  bool is_whitened() const { return whitening_.has_value(); }

  /// Number of independent residuals over their variance, hPa^-2: the information about the mean over the
  /// flight.
  double information() const;

  /// Triangular factor of rows (derivatives, residual) in hPa, with equal weight for all samples.
  Eigen::MatrixXd unweighted_factor(const Eigen::VectorXd& parameters) const;

  /// Excluded samples, and samples in bins with an innovation beyond `limit`.
  std::size_t outliers(const Eigen::VectorXd& parameters, double limit) const;

 private:
  Eigen::MatrixXd means(const Eigen::VectorXd& parameters, const std::vector<std::size_t>& wanted) const;
  void whiten_what_stays();
  Eigen::MatrixXd moved(Eigen::MatrixXd rows, const Eigen::VectorXd& parameters) const;

  const FitTask* task_;
  const FitSetup* setup_;
  std::shared_ptr<FlightSamples> moving_;  // samples of `rows_`, if columns depend on coefficients
  LinearRows rows_;
  const std::vector<double>* static_pressure_;  // one per sample
  std::size_t spikes_ = 0;
  Binning bins_;
  Eigen::VectorXd prepared_parameters_;
  NoiseModel noise_;                    // noise in bins
  Eigen::VectorXd scale_;               // one per bin; empty before the noise was measured
  std::optional<Whitening> whitening_;  // if the reference combines many samples
  // Rows at `prepared_parameters_`, if the residual is treated as linear in all wanted parameters.
  Eigen::MatrixXd kept_rows_;
  Eigen::MatrixXd kept_white_rows_;
  Eigen::MatrixXd white_offsets_;  // derivatives by the offsets
};

/// Hash that differs if some bit of the parameters differs.
std::uint64_t digest_of(const Eigen::VectorXd& parameters);

/// Result of a pass over all flights.
struct Reduction {
  /// Factor of weighted whitened rows (derivatives by wanted parameters, residual), minus the part absorbed
  /// by offsets.
  Eigen::MatrixXd factor;
  /// Sums of the squares of the same derivatives absorbed by offsets; empty if there is no offset.
  Eigen::VectorXd absorbed;
  double cost = 0.0;  ///< half the sum of the loss over the innovations
  bool valid = true;  ///< false where some residual is not a number at these parameters

  /// Lengths of the derivatives, including the part absorbed by offsets.
  Eigen::VectorXd lengths() const;

  template <class Archive>
  void save(Archive& archive) const {
    archive(upper_triangle(factor), absorbed, cost);
  }

  template <class Archive>
  void load(Archive& archive) {
    std::vector<double> triangle;
    archive(triangle, absorbed, cost);
    factor = from_upper_triangle(triangle);
  }
};

/// The flights of a fit. Passes over them run several flights at a time, and each member of a team passes
/// over its own; results are added in the order of the flights, so they do not depend on the number of
/// threads or members.
class FitFlights {
 public:
  FitFlights(const FitTask& task, FitSetup setup);
  FitFlights(const FitFlights&) = delete;
  FitFlights& operator=(const FitFlights&) = delete;

  const FitTask& task() const { return task_; }
  const FitSetup& setup() const { return setup_; }
  const ReferenceDoubt& doubt() const { return doubt_; }

  /// Flights with each further reference.
  const std::vector<std::unique_ptr<FitFlights>>& further() const { return further_; }

  /// Fitted entries: these and the further references that depend on some of the wanted parameters. Numbers
  /// of flights and samples, masks and single figures refer to the first reference.
  std::vector<FitFlights*> joint();

  /// True if derivatives, or columns that depend on a coefficient, stay fixed until the flights are prepared
  /// again.
  bool uses_fixed_jacobian() const;

  /// True if columns depend on a coefficient, so that a first solution from a distant start is not final.
  bool has_moving_columns() const;

  std::size_t count() const { return task_.flights.size(); }

  /// Whether the residual is linear in each of the parameters.
  const std::vector<bool>& is_linear() const { return linear_; }
  std::size_t samples() const { return samples_; }
  /// The wanted parameters, and the offsets of all intervals.
  std::size_t unknowns() const { return setup_.wanted.size() + offsets_; }
  /// Bins of all flights at the values of the setup.
  std::size_t bins() const { return bins_; }
  const std::array<std::size_t, mask_count>& masks() const { return masks_; }

  /// Results for every flight, in the order of flights, on every member of the team: one exchange.
  /// @param make gets the number of a flight and the flight; it is called by several threads
  /// @param parameters must agree between the members
  template <class Make>
  auto of_each(const Make& make, const Eigen::VectorXd& parameters = {}) {
    using Part = std::decay_t<decltype(make(std::size_t{}, std::declval<FitFlight&>()))>;
    static_assert(!std::is_same_v<Part, bool>, "elements of std::vector<bool> share words between threads");
    return task_.flights.share().gather_flights<Part>(
        [&](std::vector<Part>& parts) {
          visit([&](std::size_t number, FitFlight& fit) { parts[number] = make(number, fit); });
        },
        digest_of(parameters));
  }

  /// Whether other samples of any flight are used at these parameters.
  bool masks_change_at(const Eigen::VectorXd& parameters);

  Reduction reduce(const Eigen::VectorXd& parameters, const ScaledLoss& loss);

  /// Triangular factor of rows (derivatives, residual) in hPa for the first reference, with equal weight for
  /// all samples.
  Eigen::MatrixXd unweighted_factor(const Eigen::VectorXd& parameters);

  /// Prepares every flight at these parameters; the noise stays.
  void prepare(const Eigen::VectorXd& parameters);

  /// Prepares every flight, and estimates the noise and the weight of the reference, or keeps those of
  /// `share_noise`. The shared part of the noise is estimated from up to sixteen flights at equal distances.
  /// @param slow_parts includes slow parts, which residuals of many samples always have
  /// @param misfit misfit of the law in the bins of a flight, hPa, excluded from the noise; may be empty
  void measure_noise(const Eigen::VectorXd& parameters, bool slow_parts,
                     const std::function<Eigen::VectorXd(const FitFlight&)>& misfit = {});

  /// Combined slow parts of the noise, hPa; zero before the noise was measured.
  double drift_rms() const;

  /// Copies the noise of other samples of the same flights.
  void share_noise(const FitFlights& others) {
    noise_ = others.noise_;
    shares_noise_ = true;
    for (std::size_t i = 0; i < further_.size(); ++i) further_[i]->share_noise(*others.further_[i]);
  }

  bool shares_noise() const { return shares_noise_; }

  /// Robust deviation of the innovations; 1 if the noise model is right.
  double deviation(const Eigen::VectorXd& parameters);

 private:
  void visit(const std::function<void(std::size_t flight, FitFlight& fit)>& visit) {
    visit_those([](std::size_t) { return true; }, visit);
  }
  bool sees_parameters();
  /// Visits the chosen flights of this member.
  void visit_those(const std::function<bool(std::size_t flight)>& chosen,
                   const std::function<void(std::size_t flight, FitFlight& fit)>& visit);
  std::shared_ptr<const FlightSamples> samples_of(std::size_t number) const;
  std::shared_ptr<FitFlight> made(std::size_t number, std::shared_ptr<const FlightSamples> samples);

  const FitTask& task_;
  const FitSetup setup_;  // the flights in the cache point to it
  const ReferenceDoubt doubt_;
  std::vector<std::shared_ptr<FitFlight>> cache_;
  /// Memory of the set, returned even if the constructor throws.
  struct Reservation {
    const FlightSet& flights;
    std::atomic<std::size_t> bytes{0};
    ~Reservation() { flights.release(bytes); }
  } reserved_;
  std::vector<bool> linear_;
  std::size_t samples_ = 0;
  std::size_t offsets_ = 0;
  std::size_t bins_ = 0;
  std::array<std::size_t, mask_count> masks_{};
  std::vector<std::size_t> for_noise_;  // flights used to estimate the shared noise
  std::shared_ptr<const FitNoise> noise_;
  bool shares_noise_ = false;
  Eigen::VectorXd prepared_parameters_;
  std::vector<std::unique_ptr<FitFlights>> further_;
  std::vector<FitFlights*> seeing_;  // further references that depend on some parameter
};

}  // namespace pcor::internal
