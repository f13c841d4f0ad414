#pragma once

#include <Eigen/Dense>
#include <memory>
#include <string>
#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include "diagnose/candidates.hpp"
#include "diagnose/manoeuvres.hpp"
#include "diagnose/search.hpp"
#include "numerics/noise_model.hpp"

namespace pcor::internal {

/// A manoeuvre, and what it would add to the sums over base and candidates.
struct Prospect {
  Manoeuvre manoeuvre;
  Eigen::MatrixXd information;
};

/// What the aircraft of some flights could fly, with the usual level of their noise, hPa.
std::vector<Prospect> prospects_of(const std::vector<std::shared_ptr<const FlightSamples>>& flights,
                                   NoiseModel noise, double usual_level, const CandidateSet& set,
                                   const ModelFile& model, const MaskOptions& mask);

/// An effect of an estimated size, and what it is to be told from.
struct Rivalry {
  Eigen::MatrixXd information;    ///< of base and candidates, as the flights are
  double variance = 1.0;          ///< of the whitened residuals
  std::vector<Eigen::Index> own;  ///< the columns of the effect
  Eigen::VectorXd size;           ///< its coefficients
  /// For each rival the columns that may imitate the effect, those of base and rival among them.
  std::vector<std::vector<Eigen::Index>> rests;
};

/// The best of the manoeuvres, flown so many times.
struct Plan {
  const Manoeuvre* manoeuvre = nullptr;
  int repeats = 1;
  double power = 0.0;  ///< probability that it tells the effect from all rivals with 95 % confidence

  /// Whether it is worth flying.
  bool helps() const;
  double duration() const;  ///< s
};

Plan best_plan(const std::vector<Prospect>& prospects, const Rivalry& rivalry);

/// What to fly, how long, and what it would tell; or that nothing would.
/// @param id of the effect, as that of a finding
std::string text_of(const Plan& plan, const std::string& id, const ModelEffect& effect,
                    const std::vector<std::string>& rivals);

/// The levels of the noise of all flights' bins, hPa.
std::vector<double> levels_of(const NoiseModel& noise);

/// The columns of a group among those of base and candidates.
std::vector<Eigen::Index> places_of(const ColumnGroup& group, Eigen::Index base);

}  // namespace pcor::internal
