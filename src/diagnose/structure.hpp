#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "diagnose/smooth.hpp"
#include "numerics/binning.hpp"
#include "numerics/noise_model.hpp"

namespace pcor::internal {

/// What a smooth function of a variable explains of residuals that a model leaves.
struct Structure {
  std::string name;
  double chi2 = 0.0;
  double freedom = 0.0;
  double equivalent = 0.0;  ///< chi2 as if of one degree
  double share = 0.0;       ///< of the residual's squares that the noise does not account for, 0 to 1
  double line_chi2 = 0.0;   ///< of the straight line alone
  double slope = 0.0;       ///< of the straight line, hPa per unit of the variable
  double slope_error = 0.0;
  double centre = 0.0;  ///< mean of the variable
};

/// Tests whether residuals hold structure that a model does not explain: smooth functions of variables, one
/// variable at a time.
class StructureTest {
 public:
  /// @param columns of the model, base and chosen effects, in bins; @param residuals likewise
  StructureTest(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                const std::vector<Eigen::VectorXd>& residuals, const NoiseModel& noise);

  /// Tries a variable: its values of each flight, one for each record. Returns false, and leaves it out,
  /// where it does not vary or has no value in more than a tenth of the records used.
  bool add(const std::string& name, const std::vector<const double*>& values);

  const std::vector<Structure>& structures() const { return structures_; }

  /// The score that chance exceeds somewhere among all variables with that probability.
  double threshold(double probability) const;

  /// The number of the strongest of all by its equivalent; nothing where nothing was added.
  std::optional<std::size_t> strongest() const;

  /// On how many minutes of equal weight structure number `number` rests.
  double effective_blocks(std::size_t number) const;

  /// The columns that describe a variable, in bins, of each flight: to put them into a model.
  std::vector<Eigen::MatrixXd> columns_of(const std::vector<const double*>& values) const;

  /// How often signs of minutes, drawn at random, make any variable score as well as `score`: the tails of
  /// noise that is not normal.
  double chance_of(double score, std::size_t flips, std::uint64_t seed) const;

 private:
  Smooth smooth_of(const std::vector<const double*>& values) const;
  std::vector<Eigen::MatrixXd> columns_of(const Smooth& smooth,
                                          const std::vector<const double*>& values) const;

  const std::vector<Binning>* bins_;
  const NoiseModel* noise_;
  std::vector<Eigen::MatrixXd> model_{};  // whitened columns of each flight
  std::vector<Eigen::VectorXd> left_{};   // of the whitened residuals, by the model
  std::vector<std::vector<Eigen::Index>> block_{};
  Eigen::Index blocks_ = 0;
  Eigen::VectorXd scale_{};
  Eigen::MatrixXd inverse_{};  // of the scaled information of the model
  double squares_ = 0.0;
  double variance_ = 1.0;
  std::vector<Structure> structures_{};
  std::vector<Eigen::MatrixXd> block_scores_{};  // of each variable, blocks by its directions
};

/// Whether the noise of a variable is the noise of the residual: their changes from one record to the next go
/// together everywhere, in and out of manoeuvres. Such a variable was computed from what was measured with
/// that noise; that structure goes with it says nothing.
bool shares_noise(const std::vector<std::vector<double>>& residuals,
                  const std::vector<const double*>& values);

}  // namespace pcor::internal
