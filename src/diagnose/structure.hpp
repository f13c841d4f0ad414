#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include "diagnose/smooth.hpp"
#include "diagnose/tested_variables.hpp"
#include "numerics/binning.hpp"
#include "numerics/noise_model.hpp"
#include "numerics/whitening.hpp"
#include "parallel/flight_partition.hpp"

namespace pcor::internal {

/// Part of a model's residuals explained by functions of a variable, of which it has name, unit and
/// description.
struct Structure : EmpiricalPredictor {
  const TestedVariable* variable = nullptr;
  double gain = 0.0;  ///< twice the gain in log-likelihood over drift alone, with the most likely drift
  double degrees_of_freedom = 0.0;  ///< number of functions
  double chi2_one_dof = 0.0;        ///< gain as chi2 of one degree of freedom, in units of the gain by chance
  double line_gain = 0.0;           ///< `gain` of the straight line alone
};

/// Residuals of a flight without dependence on any variable: first shifted in time, then with random signs
/// for each minute.
struct DrawnResiduals {
  Eigen::MatrixXd shifted{};           ///< one column per draw
  Eigen::VectorXd residual{};          ///< whitened residual of each bin
  std::vector<Eigen::Index> minute{};  ///< number of the minute of each bin
  Eigen::MatrixXd signs{};             ///< one row per minute, one column per draw

  /// Products of columns with all drawn residuals.
  Eigen::MatrixXd products_with(const Eigen::MatrixXd& columns) const;
};

/// Tests whether residuals hold structure that a model does not explain: functions of variables, one variable
/// at a time. The flights are those against one reference.
///
/// Slow variation with a variable is mistaken for drift if drift is fitted first. A variable therefore
/// competes with drift on equal terms: the likelihood of its functions plus the then most likely drift is
/// compared with that of drift alone. The chance level comes from the flights: residuals shifted in time
/// against the variables keep all properties of the noise (bursts, correlation, drift) but lose the
/// dependence on a variable; residuals with random signs for each minute keep the noise at large values of a
/// variable, as in turbulence. Significant structure must exceed both. Strong structure remains in shifted or
/// sign-changed residuals, so it may be removed before the chance level is estimated.
class StructureTest {
 public:
  /// @param partition of the flights: a rank has the bins and all other data of its local flights
  /// @param binned columns of the model, base and chosen effects, and residuals
  /// @param noise with all drift remaining after the model; @param seed of shifts and signs
  /// @param aside columns to subtract from the residuals that give the chance level; may be empty
  StructureTest(const FlightPartition& partition, const BinnedFlights& binned, const NoiseModel& noise,
                std::uint64_t seed, const std::vector<Eigen::MatrixXd>& aside = {});

  /// Tries functions of a variable; if it is `fine`, also functions that bend many times over its range.
  /// Returns false and skips a variable that is constant or has no value in more than a tenth of the used
  /// records. @param variable kept by address in the structures
  bool add(const TestedVariable& variable);
  bool add(TestedVariable&& variable) = delete;

  const std::vector<Structure>& structures() const { return structures_; }

  /// `p_value_of` the largest chi2 of one degree of freedom; 1 without a structure.
  double p_value() const;

  /// Probability that the best of all variables does as well on residuals that are shifted in time or have
  /// random signs, the larger of the two: extreme-value law (Gumbel 1958, Statistics of extremes) fitted to
  /// the draws.
  double p_value_of(double chi2_one_dof) const;

  /// Columns of each flight, in bins, of the variable with the largest gain beyond its number of functions,
  /// for removal; empty if noise of the noise model would reach this gain with a probability above 1e-4.
  std::vector<Eigen::MatrixXd> strong_structure() const;

 private:
  /// Flights whitened with part of the drift; detailed data of local flights only.
  struct Whitened {
    std::vector<Whitening> whitening{};
    std::vector<Eigen::MatrixXd> model{};      // columns of each flight
    std::vector<Eigen::VectorXd> residuals{};  // after the model
    std::vector<DrawnResiduals> drawn{};       // shifted in time or with random signs
    Eigen::MatrixXd model_with_drawn{};
    Eigen::MatrixXd inverse{};  // inverse of the information of the model
    double squares = 0.0;       // sum of the remaining squares
    double determinant = 0.0;   // log determinant of the covariance of the noise
  };
  /// Decrease of the squares by a variable: residuals, and drawn residuals.
  struct ExplainedSquares {
    double line = 0.0;
    double line_information = 0.0;
    double line_score = 0.0;
    double all = 0.0;
    Eigen::VectorXd drawn{};
    Eigen::Index degrees_of_freedom = 0;
  };

  void add(const TestedVariable& variable, const Smooth& smooth);
  std::vector<Eigen::MatrixXd> columns_of(const Smooth& smooth, const TestedVariable& variable) const;
  /// Products of the whitened functions of a flight with themselves, the model, the remaining residuals and
  /// the draws, in adjacent columns for each part of the drift.
  Eigen::MatrixXd products(std::size_t flight, const Eigen::MatrixXd& columns) const;
  /// @param products summed over all flights for one part of the drift
  static ExplainedSquares explained_by(const Eigen::MatrixXd& products, const Whitened& flights);
  double minus_likelihood(const Whitened& flights, double explained) const;

  FlightPartition partition_;
  std::vector<Binning> bins_;
  std::size_t rows_ = 0;              // all flights
  std::vector<Whitened> whitened_{};  // one per remaining part of the drift, full drift first
  double alone_ = 0.0;                // minus twice the log-likelihood of drift alone
  std::vector<Structure> structures_{};
  std::vector<Eigen::MatrixXd> strong_{};  // columns of the variable with the largest gain
  double strong_gain_ = 0.0;
  Eigen::VectorXd largest_{};  // maximum of each draw over all variables
};

/// Slope of the residual in a variable, from the changes between records.
///
/// If the changes are correlated everywhere, in and out of manoeuvres, the variable either was computed from
/// the same noisy measurement, and structure that varies with it is not evidence, or it causes fast changes
/// of the residual. A cause has the same slope in slow changes. For common noise the slope of slow changes is
/// smaller, because slow changes of the variable are not noise.
struct ChangeSlope {
  double correlation = 0.0;  ///< correlation of the changes, median over parts of 300 records; 0 if unknown
  double slope = 0.0;        ///< hPa per unit of the variable, median over the parts
  double error = 0.0;        ///< standard error of `slope`

  /// Whether the changes are correlated more than by chance.
  bool is_correlated() const;

  /// Whether the straight line of a structure has this slope, within the errors and a fifth.
  bool agrees_with(const Structure& structure) const;
};

/// @param residuals of local flights; missing values are ignored
ChangeSlope slope_of_changes(const FlightPartition& partition,
                             const std::vector<std::vector<double>>& residuals,
                             const TestedVariable& variable);

}  // namespace pcor::internal
