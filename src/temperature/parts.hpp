#pragma once

#include <vector>

#include <pcor/temperature/temperature.hpp>
#include "temperature/height_likelihood.hpp"

namespace pcor::internal {

/// What every flight says by itself, in their order: the common correction with a constant of its own, the
/// errors of the pressure as in all flights. They are common, so they do not tell flights apart.
std::vector<PartCorrection> corrections_of_flights(const std::vector<HeightRecord>& records,
                                                   const HeightNoise& noise, const HeightPrior& prior,
                                                   const HeightEquations::Vector& unknowns);

/// What the climbs say by themselves and what the descents: two constants, with errors of the pressure in
/// proportion to the dynamic pressure and the angle of attack free, since these change between the two. Empty
/// where the flights only climb, or only descend.
std::vector<PartCorrection> corrections_of_climbs_and_descents(const std::vector<HeightRecord>& records,
                                                               const HeightNoise& noise,
                                                               const HeightPrior& prior,
                                                               const HeightEquations::Vector& unknowns,
                                                               const Workers& workers);

/// Whether parts differ by more than their errors explain, and by how much.
struct Disagreement {
  double chi_squared = 0.0;  ///< of the parts about their mean
  double chance = 1.0;       ///< the probability of as much or more by the noise alone
  double spread = 0.0;  ///< standard deviation of the parts beyond their errors, K; 0 where it may be chance
};

/// After DerSimonian & Laird, Controlled Clinical Trials 7 (1986): the variance between parts that makes
/// chi-squared what is expected of it.
Disagreement disagreement_of(const std::vector<PartCorrection>& parts);

/// True where a part is closer to no correction than to the common one, by more than its noise explains.
bool is_made_worse(const PartCorrection& part);

}  // namespace pcor::internal
