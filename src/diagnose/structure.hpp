#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "diagnose/smooth.hpp"
#include "numerics/binning.hpp"
#include "numerics/noise_model.hpp"
#include "numerics/whitening.hpp"
#include "parallel/flight_partition.hpp"

namespace pcor::internal {

/// What functions of a variable explain of residuals that a model leaves.
struct Structure {
  std::string name;
  double gain = 0.0;        ///< twice the gain in log-likelihood over drift alone, drift as likely as can be
  double freedom = 0.0;     ///< number of functions
  double equivalent = 0.0;  ///< the gain as a chi-squared of one degree, in units of what chance gains
  double share = 0.0;       ///< of the residual's squares that the noise does not account for, 0 to 1
  double line_gain = 0.0;   ///< as `gain`, of the straight line alone
  double line_share = 0.0;  ///< as `share`, of the straight line alone
  double slope = 0.0;       ///< of the straight line, hPa per unit of the variable
  double slope_error = 0.0;
  double centre = 0.0;  ///< mean of the variable
};

/// Tests whether residuals hold structure that a model does not explain: functions of variables, one variable
/// at a time. The flights are those against one reference.
///
/// What goes slowly with a variable passes for drift where drift is looked for first. So a variable competes
/// with drift on equal terms: the likelihood of its functions beside as much of the drift as is likeliest
/// then, against that of drift alone. Whether it gains more than chance is told by the flights themselves:
/// their residuals, shifted in time against the variables, keep all that noise has (bursts, memory, drift),
/// and lose what goes with a variable; with the signs of their minutes drawn at random they keep what noise
/// has where a variable is large, as in turbulence. Structure has to be beyond both. Strong structure,
/// shifted or with other signs, is no noise, so it may be set aside before chance is told by what is left.
class StructureTest {
 public:
  /// @param share of the flights: a member of a team has the bins, and whatever else is said of each flight,
  /// of its own
  /// @param columns of the model, base and chosen effects, in bins; @param residuals likewise
  /// @param noise with all the drift that there is beside the model; @param seed of shifts and signs
  /// @param aside columns of what is taken off the residuals that tell chance; empty for nothing
  StructureTest(const FlightPartition& share, const std::vector<Binning>& bins,
                const std::vector<Eigen::MatrixXd>& columns, const std::vector<Eigen::VectorXd>& residuals,
                const NoiseModel& noise, std::uint64_t seed, const std::vector<Eigen::MatrixXd>& aside = {});

  /// Tries functions of a variable: its values of each flight, one for each record. Returns false, and leaves
  /// it out, where it does not vary or has no value in more than a tenth of the records used.
  /// @param turn of an angle, in its unit; 0 for what is none
  bool add(const std::string& name, const std::vector<const double*>& values, double turn = 0.0);

  /// The same with functions that bend many times over the range of the variable.
  bool add_fine(const std::string& name, const std::vector<const double*>& values);

  const std::vector<Structure>& structures() const { return structures_; }

  /// The number of the strongest of all by its equivalent; nothing where nothing was added.
  std::optional<std::size_t> strongest() const;

  /// How often the best of all variables does as well on residuals that are shifted in time, or have signs at
  /// random, whichever is more: by the law of the largest of many (Gumbel 1958, Statistics of extremes),
  /// fitted to them.
  double chance_of(double equivalent) const;

  /// The columns of each flight, in bins, of what gains most beyond its number of functions, to be set aside;
  /// nothing where noise as the model of the noise has it would gain as much somewhere once in 10,000 times.
  std::vector<Eigen::MatrixXd> strong_structure() const;

 private:
  /// The flights whitened with some of the drift; of the own flights whatever is told of each.
  struct Whitened {
    std::vector<Whitening> whitening{};
    std::vector<Eigen::MatrixXd> model{};  // columns of each flight
    std::vector<Eigen::VectorXd> left{};   // of the residuals, by the model
    std::vector<Eigen::MatrixXd> drawn{};  // the same by columns, each shifted or with signs at random
    Eigen::MatrixXd model_with_drawn{};
    Eigen::VectorXd scale{};
    Eigen::MatrixXd inverse{};  // of the scaled information of the model
    double squares = 0.0;       // of what is left
    double determinant = 0.0;   // logarithm of that of the covariance of the noise
  };
  /// What a variable takes off the squares: of the residuals, and of those that are drawn.
  struct Taken {
    double line = 0.0;
    double line_information = 0.0;
    double line_score = 0.0;
    double all = 0.0;
    Eigen::VectorXd drawn{};
    Eigen::Index freedom = 0;
  };

  /// Of all records used.
  VariableValues values_of(const std::vector<const double*>& values) const;
  bool add(const std::string& name, const std::vector<const double*>& values, const Smooth& smooth);
  std::vector<Eigen::MatrixXd> columns_of(const Smooth& smooth,
                                          const std::vector<const double*>& values) const;
  /// The products of the whitened functions of a flight with themselves, the model, what is left of the
  /// residuals and what is drawn, side by side for each part of the drift.
  Eigen::MatrixXd products(std::size_t flight, const Eigen::MatrixXd& columns) const;
  /// @param products of all flights, of one part of the drift
  static Taken taken_by(const Eigen::MatrixXd& products, const Whitened& flights);
  /// What is left of the residuals when `aside` is taken off, of each flight.
  std::vector<Eigen::VectorXd> left_by(const std::vector<Eigen::MatrixXd>& aside,
                                       const Whitened& flights) const;
  double minus_likelihood(const Whitened& flights, double taken) const;

  FlightPartition share_;
  const std::vector<Binning>* bins_;
  std::size_t rows_ = 0;              // of all flights
  std::vector<Whitened> whitened_{};  // by how much of the drift is left, all of it first
  double alone_ = 0.0;                // minus twice the log-likelihood of drift alone
  std::vector<Structure> structures_{};
  std::vector<Eigen::MatrixXd> strong_{};  // columns of what gains most
  double strong_gain_ = 0.0;
  Eigen::VectorXd largest_{};  // of each draw, over all variables
};

/// Whether the noise of a variable is the noise of the residual: their changes from one record to the next go
/// together everywhere, in and out of manoeuvres. Such a variable was computed from what was measured with
/// that noise; that structure goes with it says nothing.
/// @param residuals and @param values of the own flights
bool shares_noise(const FlightPartition& share, const std::vector<std::vector<double>>& residuals,
                  const std::vector<const double*>& values);

}  // namespace pcor::internal
