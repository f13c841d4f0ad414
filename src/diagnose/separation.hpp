#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include <pcor/model_io/model_definition.hpp>
#include "diagnose/flown_regimes.hpp"
#include "diagnose/search.hpp"

namespace pcor::internal {

/// An effect of an estimated size, and its rivals.
struct SeparationProblem {
  Eigen::MatrixXd information;    ///< of base and candidates, as the flights are
  double variance = 1.0;          ///< of the whitened residuals
  std::vector<Eigen::Index> own;  ///< the columns of the effect
  Eigen::VectorXd size;           ///< its coefficients
  /// For each rival the columns that may imitate the effect, those of base and rival among them.
  std::vector<std::vector<Eigen::Index>> rests;
};

/// A regime that was flown, to be flown again so many times.
struct Plan {
  const FlownRegime* regime = nullptr;
  int repeats = 0;
  double power = 0.0;  ///< probability that it separates the effect from all rivals with 95 % confidence
  double gain = 0.0;   ///< in D (see `best_plan`) per second of flight

  double duration() const { return repeats * regime->duration; }  ///< s
};

/// Which regime to fly again: of those that separate the effect with a probability of 95 % the one with the
/// largest gain per second; if there is none, the one with the largest probability; none where the
/// probability that the effect is not separated does not become half of what it is.
///
/// A rival is separated where chi2 rises by more than 9 with it in the place of the effect. The difference is
/// normal with mean D and variance 4 D, where D is what of the effect the rival cannot imitate. Repeated
/// intervals are taken to be like the mean interval of their regime.
Plan best_plan(const std::vector<FlownRegime>& regimes, const SeparationProblem& rivalry);

/// What to fly, how long, and how surely it separates the effect from its rivals; of a plan without a regime
/// what separates the effect in general. @param id of the effect, as that of a finding
std::string text_of(const Plan& plan, const std::string& id, const ModelEffect& effect,
                    const std::vector<std::string>& rivals);

/// What separates an effect of the catalogue from those that look like it, whatever was flown.
std::string general_advice(const std::string& id, const ModelEffect& effect);

/// Whether the flights separate the effect from its rivals as they are, with a probability of 95 %.
bool is_separated(const SeparationProblem& rivalry);

/// The columns of a group among those of base and candidates.
std::vector<Eigen::Index> places_of(const ColumnGroup& group, Eigen::Index base);

}  // namespace pcor::internal
