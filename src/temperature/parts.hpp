#pragma once

#include <vector>

#include <pcor/temperature/temperature.hpp>
#include "temperature/height_likelihood.hpp"

namespace pcor::internal {

/// Correction estimated from each flight separately, in their order: the common correction plus a constant,
/// with the common errors of the pressure, which do not differ between flights.
std::vector<PartCorrection> corrections_of_flights(const std::vector<HeightRecord>& records,
                                                   const HeightNoise& noise, const HeightPrior& prior,
                                                   const HeightUnknowns& unknowns);

/// Corrections estimated from climbs and from descents: two constants, with free errors of the pressure
/// proportional to the dynamic pressure and the angle of attack, because these change between the two. Empty
/// if the flights only climb, or only descend.
std::vector<PartCorrection> corrections_of_climbs_and_descents(const std::vector<HeightRecord>& records,
                                                               const HeightNoise& noise,
                                                               const HeightPrior& prior,
                                                               const HeightUnknowns& unknowns,
                                                               const Workers& workers);

/// Corrections estimated from the first and the second half of each flight, like those of climbs and of
/// descents. A difference shows a drift of the thermometer, of the atmosphere or of the heights.
std::vector<PartCorrection> corrections_of_halves(const std::vector<HeightRecord>& records,
                                                  const HeightNoise& noise, const HeightPrior& prior,
                                                  const HeightUnknowns& unknowns, const Workers& workers);

/// Test of heterogeneity between parts, and its size.
struct Disagreement {
  double chi_squared = 0.0;  ///< chi-squared of the parts about their mean
  double p_value = 1.0;      ///< the probability of as much or more by the noise alone
  double spread = 0.0;  ///< standard deviation of the parts beyond their errors, K; 0 if it may be chance
};

/// After DerSimonian & Laird, Controlled Clinical Trials 7 (1986): the variance between parts that makes
/// chi-squared what is expected of it.
Disagreement disagreement_of(const std::vector<PartCorrection>& parts);

/// True if a part is closer to no correction than to the common one, by more than its noise explains.
bool is_made_worse(const PartCorrection& part);

}  // namespace pcor::internal
