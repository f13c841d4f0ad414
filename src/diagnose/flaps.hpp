#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include "diagnose/analysis.hpp"
#include "diagnose/candidates.hpp"

namespace pcor::internal {

/// The effects of flaps and gear, and those that look like them, on all samples: those with flaps out too,
/// which are in no fit of a model without such an effect.
struct FlapsCandidates {
  std::vector<Candidate> candidates{};
  std::vector<bool> reads_flaps{};         ///< of each; the others are there as rivals
  std::vector<Eigen::MatrixXf> columns{};  ///< of each flight; of those of others, without a record

  bool empty() const { return candidates.empty(); }
};

/// Nothing where too few samples have their flaps out.
FlapsCandidates find_flaps_candidates(const CandidateSet& set, const TeamColumns& columns);

/// Tests them beside the model and what `analysis` found, and adds what is found, or its upper limit, to the
/// diagnosis. @param groups of the columns of `flaps`
void diagnose_flaps(const Analysis& analysis, const FlapsCandidates& flaps, std::vector<ColumnGroup> groups,
                    std::uint64_t seed, Diagnosis& diagnosis);

}  // namespace pcor::internal
