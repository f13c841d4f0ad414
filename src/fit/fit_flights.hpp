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

/// What a stage of a fit takes from the flights.
struct FitSetup {
  Eigen::VectorXd values{};           ///< of all parameters, from which it goes on; masks are of these
  std::vector<std::size_t> wanted{};  ///< the parameters that are fitted
  /// Where there are any, only samples of these take part, and every interval has its own offset of
  /// delta-p/p.
  std::vector<Regime> regimes{};
};

/// The noise of the flights of a fit: what they share, and the levels of each.
struct FitNoise {
  double deviation = 1.0;  ///< robust, of the residuals in bins, hPa: the weight of the reference
  NoiseModel shared{};
  std::vector<std::vector<NoiseLevel>> levels{};
};

/// How many of the first parameters of a fit the residuals have as their first.
std::size_t shared_parameters(const Residuals& residuals, const FitTask& task);

/// The parameters of residuals, as a fit has them where it has them, else as their file.
Eigen::VectorXd own_parameters(const Residuals& residuals, const FitTask& task,
                               const Eigen::VectorXd& parameters);

/// The residuals of a flight, with the masks at these parameters of the fit.
Residuals residuals_at(std::shared_ptr<const FlightSamples> samples, const FitTask& task,
                       const Eigen::VectorXd& parameters);

/// The derivatives of the residual by the wanted parameters of the fit, mean over some samples.
Eigen::VectorXd mean_derivatives(const LinearRows& rows, const FitTask& task,
                                 const std::vector<std::size_t>& samples, const Eigen::VectorXd& parameters,
                                 const std::vector<std::size_t>& wanted);

/// One flight of a fit with one reference: the samples that take part, in bins of a few seconds, or as long
/// as a residual holds together, and their residuals and derivatives in units of the noise and without its
/// memory.
///
/// What the offsets of the intervals of a stage are is the flight's own business: at given parameters and a
/// loss they are those with the least loss, and derivatives are without what they take up, so that those of
/// the least loss by the parameters are exact (Golub and Pereyra 1973, SIAM Journal on Numerical Analysis 10,
/// 413).
///
/// Derivatives by the coefficients of two static systems are those at common pressures
/// (`Residuals::at_common_pressures`), and stay until the flight is prepared again: the solution is where
/// they are at right angles to the residual, which is a method of instruments, not of least squares. Those of
/// residuals that are no static pressure stay as well: they hardly change, and take long to find.
class FitFlight {
 public:
  FitFlight(std::shared_ptr<const FlightSamples> samples, const FitTask& task, const FitSetup& setup);

  const LinearRows& linear_rows() const { return rows_; }
  const Residuals& residuals() const { return rows_.residuals(); }
  const std::vector<std::size_t>& kept() const { return rows_.used(); }
  /// How many intervals have an offset of their own.
  std::size_t offsets() const { return rows_.interval_count(); }
  const Binning& bins() const { return bins_; }
  double static_pressure(std::size_t kept) const { return (*static_pressure_)[rows_.used()[kept]]; }

  /// Finds samples that depart from their neighbours at these parameters, which are left out from now on, and
  /// prepares the bins of the others. With a loss of least squares none is left out.
  void prepare(const Eigen::VectorXd& parameters);

  /// Whether other samples take part at these parameters.
  bool masks_change_at(const Eigen::VectorXd& parameters) const;

  /// Sets the noise, number `flight` of `noise`; without one all bins count alike.
  void set_noise(const FitNoise& noise, std::size_t flight);

  /// Derivatives by the wanted parameters, and the residual, hPa, by columns, one row for each bin; without
  /// offsets.
  Eigen::MatrixXd rows(const Eigen::VectorXd& parameters) const;

  /// The same in units of the noise and without its memory: the last column are the innovations, with the
  /// offsets that leave the least loss, from Huber's solution on where a loss has several.
  Eigen::MatrixXd white_rows(const Eigen::VectorXd& parameters, const ScaledLoss& loss) const;

  /// White columns without what offsets take up of them where the bins have these weights.
  Eigen::MatrixXd without_offsets(const Eigen::MatrixXd& columns, const Eigen::VectorXd& weights) const;

  /// Derivatives by any parameters, in units of the noise and without its memory.
  Eigen::MatrixXd white_columns(const Eigen::VectorXd& parameters,
                                const std::vector<std::size_t>& wanted) const;

  /// What one standard uncertainty of each doubt of the reference does to the residual, in the same units.
  Eigen::MatrixXd white_doubts(const ReferenceDoubt& doubt, const Eigen::VectorXd& parameters) const;

  /// Weighted columns of one row for each bin: by the root of the samples in a bin over the deviation of the
  /// reference, as least squares of samples weighs them. Where the reference holds many samples
  /// together (wind, heights), in units of the noise and without its memory.
  Eigen::MatrixXd white(const Eigen::MatrixXd& columns) const;

  /// Columns in units of the noise and without its memory.
  Eigen::MatrixXd without_noise(const Eigen::MatrixXd& columns) const {
    return Whitening(bins_, noise_, 0)(columns);
  }

  /// What the scores are sums with: left' diag(weight) residual = weighted' (residual in hPa).
  Eigen::MatrixXd weighted(const Eigen::MatrixXd& left, const Eigen::VectorXd& weight) const {
    return scale_.cwiseProduct(weight).asDiagonal() * left;
  }

  /// The covariance of the sums of the noise times columns that have a row for each bin.
  Eigen::MatrixXd covariance_of_sums(const Eigen::MatrixXd& columns) const;

  /// Whether `white` takes the memory of the noise out.
  bool is_whitened() const { return whitening_.has_value(); }

  /// The number of independent residuals over their variance, hPa^-2: that of the mean over the flight.
  double information() const;

  /// The factor of rows (derivatives, residual) in hPa, all samples alike.
  Eigen::MatrixXd unweighted_factor(const Eigen::VectorXd& parameters) const;

  /// Samples that were left out, or are in bins whose innovation is beyond `limit`.
  std::size_t outliers(const Eigen::VectorXd& parameters, double limit) const;

 private:
  Eigen::MatrixXd means(const Eigen::VectorXd& parameters, const std::vector<std::size_t>& wanted) const;
  void whiten_what_stays();
  Eigen::MatrixXd moved(Eigen::MatrixXd rows, const Eigen::VectorXd& parameters) const;

  const FitTask* task_;
  const FitSetup* setup_;
  std::shared_ptr<FlightSamples> moving_;  // those of `rows_`, where columns hang on coefficients
  LinearRows rows_;
  const std::vector<double>* static_pressure_;  // of the samples
  std::size_t spikes_ = 0;
  Binning bins_;
  Eigen::VectorXd prepared_parameters_;
  NoiseModel noise_;                    // of the bins
  Eigen::VectorXd scale_;               // of each bin; empty before the noise was measured
  std::optional<Whitening> whitening_;  // where the reference holds many samples together
  // Where the residual counts as linear in all that is wanted: rows at `prepared_parameters_`.
  Eigen::MatrixXd kept_rows_;
  Eigen::MatrixXd kept_white_rows_;
  Eigen::MatrixXd white_offsets_;  // derivatives by the offsets
};

/// A number that differs where some bit of the parameters does.
std::uint64_t digest_of(const Eigen::VectorXd& parameters);

/// What a pass over all flights gives.
struct Reduction {
  /// Of white rows (derivatives by wanted parameters, residual), weighted, without what offsets take up.
  Eigen::MatrixXd factor;
  /// Sums of the squares that offsets take up of the same derivatives; empty where there is no offset.
  Eigen::VectorXd absorbed;
  double cost = 0.0;  ///< half the sum of the loss over the innovations
  /// The curvature of the loss over its slope, rho' + 2 s rho'' over rho', mean over the bins: by so much the
  /// second derivative of the cost is less than that of the weighted squares.
  double curvature = 1.0;
  std::size_t bins = 0;
  bool valid = true;  ///< false where some residual is not a number at these parameters

  /// The lengths of the derivatives, with what offsets take up.
  Eigen::VectorXd lengths() const;

  template <class Archive>
  void save(Archive& archive) const {
    archive(upper_triangle(factor), absorbed, cost, curvature, bins);
  }

  template <class Archive>
  void load(Archive& archive) {
    std::vector<double> triangle;
    archive(triangle, absorbed, cost, curvature, bins);
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

  /// The same flights with each further reference.
  const std::vector<std::unique_ptr<FitFlights>>& further() const { return further_; }

  /// These and those of the further references that see some of the wanted parameters: what is fitted. What
  /// is said of flights, samples, masks and single figures is of the first reference.
  std::vector<FitFlights*> joint();

  /// True where something stays until the flights are prepared again: derivatives, or columns that hang on a
  /// coefficient.
  bool uses_fixed_jacobian() const;

  /// True where columns hang on a coefficient, and a first solution from far off is none yet.
  bool has_moving_columns() const;

  std::size_t count() const { return task_.flights.size(); }

  /// For each of the parameters whether the residual is linear in it.
  const std::vector<bool>& is_linear() const { return linear_; }
  std::size_t samples() const { return samples_; }
  /// The wanted parameters, and the offsets of all intervals.
  std::size_t unknowns() const { return setup_.wanted.size() + offsets_; }
  /// Bins of all flights at the values of the setup.
  std::size_t bins() const { return bins_; }
  const std::array<std::size_t, mask_count>& masks() const { return masks_; }

  /// What is made of every flight, in the order of flights, on every member of the team: one exchange.
  /// @param make gets the number of a flight and the flight; it is called by several threads
  /// @param parameters in which the members have to agree
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

  /// Whether in any flight other samples take part at these parameters.
  bool masks_change_at(const Eigen::VectorXd& parameters);

  Reduction reduce(const Eigen::VectorXd& parameters, const ScaledLoss& loss);

  /// The factor of rows (derivatives, residual) in hPa, all samples alike, of the first reference.
  Eigen::MatrixXd unweighted_factor(const Eigen::VectorXd& parameters);

  /// Prepares every flight at these parameters; the noise stays.
  void prepare(const Eigen::VectorXd& parameters);

  /// Prepares every flight, and finds the noise and the weight of the reference; or keeps those of
  /// `share_noise`. What flights share of the noise is found from sixteen of them at most, as far apart as
  /// they come. @param slow_parts finds slow parts, too, which residuals of many samples always have
  /// @param misfit of the law in the bins of a flight, hPa, which is no noise; may be empty
  void measure_noise(const Eigen::VectorXd& parameters, bool slow_parts,
                     const std::function<Eigen::VectorXd(const FitFlight&)>& misfit = {});

  /// Of the slow parts of the noise together, hPa; zero before it was measured.
  double drift_rms() const;

  /// The noise of other samples of the same flights.
  void share_noise(const FitFlights& others) {
    noise_ = others.noise_;
    shares_noise_ = true;
    for (std::size_t i = 0; i < further_.size(); ++i) further_[i]->share_noise(*others.further_[i]);
  }

  bool shares_noise() const { return shares_noise_; }

  /// The robust deviation of the innovations; 1 where the noise is right.
  double deviation(const Eigen::VectorXd& parameters);

 private:
  void visit(const std::function<void(std::size_t flight, FitFlight& fit)>& visit) {
    visit_those([](std::size_t) { return true; }, visit);
  }
  bool sees_parameters();
  /// Visits the flights of this member that are chosen.
  void visit_those(const std::function<bool(std::size_t flight)>& chosen,
                   const std::function<void(std::size_t flight, FitFlight& fit)>& visit);
  std::shared_ptr<const FlightSamples> samples_of(std::size_t number) const;
  std::shared_ptr<FitFlight> made(std::size_t number, std::shared_ptr<const FlightSamples> samples);

  const FitTask& task_;
  const FitSetup setup_;  // the flights in the cache point to it
  const ReferenceDoubt doubt_;
  std::vector<std::shared_ptr<FitFlight>> cache_;
  /// Memory of the set that is given back, also where the constructor throws.
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
  std::vector<std::size_t> for_noise_;  // the flights from which that is found which all share
  std::shared_ptr<const FitNoise> noise_;
  bool shares_noise_ = false;
  Eigen::VectorXd prepared_parameters_;
  std::vector<std::unique_ptr<FitFlights>> further_;
  std::vector<FitFlights*> seeing_;  // of the further ones, those that see some parameter
};

}  // namespace pcor::internal
