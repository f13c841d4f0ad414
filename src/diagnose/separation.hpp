#pragma once

#include <Eigen/Dense>
#include <functional>
#include <string>
#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include <pcor/regimes/regimes.hpp>
#include "campaign/columns.hpp"
#include "campaign/effect_search.hpp"
#include "campaign/whitened.hpp"

namespace pcor::internal {

/// A regime that some flights flew: the mean of its intervals.
struct RegimeStatistics {
  Regime regime = Regime::count;
  double duration = 0.0;          ///< s
  Eigen::MatrixXd information{};  ///< products of the whitened columns with each other
  std::string flight{};           ///< name of the flight that flew most of the regime
};

/// Local flight against one of its references.
struct FlightInBins {
  const FlightColumns& columns;
  const Binning& bins;
};

/// Repeatable regimes of all flights: all except ground, take-off and level. Bins of a
/// climb or a descent over which another regime lies, such as a turn, count for that regime alone.
///
/// @param flight gives the flight of an entry of the scores
std::vector<RegimeStatistics> regime_statistics(
    const WhitenedSystem& scores, const std::function<FlightInBins(std::size_t flight)>& flight);

/// An effect of an estimated size, and its rivals.
struct SeparationProblem {
  Eigen::MatrixXd information;        ///< base and candidates, from the existing flights
  double variance = 1.0;              ///< variance of the whitened residuals
  std::vector<Eigen::Index> columns;  ///< columns of the effect
  Eigen::VectorXd size;               ///< its coefficients
  /// Columns that may imitate the effect for each rival, including base and rival.
  std::vector<std::vector<Eigen::Index>> rests;
};

/// Regime to repeat, and the number of repeats.
struct Plan {
  const RegimeStatistics* regime = nullptr;
  int repeats = 0;
  double power = 0.0;  ///< probability that it separates the effect from all rivals with 95 % confidence
  double gain = 0.0;   ///< increase of D (see `best_plan`) per second of flight

  double duration() const { return repeats * regime->duration; }  ///< s
};

/// Regime to fly again: the largest gain per second among those that separate the effect with a probability
/// of 95 %; otherwise the largest probability. Empty if no regime halves the probability that the effect is
/// not separated.
///
/// A rival is separated if chi2 rises by more than 9 when it replaces the effect. The difference is normal
/// with mean D and variance 4 D, where D is the part of the effect that the rival cannot imitate. Repeated
/// intervals are assumed to equal the mean interval of their regime.
Plan best_plan(const std::vector<RegimeStatistics>& regimes, const SeparationProblem& rivalry);

/// Regime, flight time and probability of separating the effect from its rivals; general advice for a plan
/// without a regime. @param id of the effect, as in a finding
Advice advice_of(const Plan& plan, const std::string& id, const ModelEffect& effect,
                 const std::vector<std::string>& rivals);

/// General advice on separating a catalogue effect from similar ones, independent of the flights.
std::string general_advice(const std::string& id, const ModelEffect& effect);

}  // namespace pcor::internal
