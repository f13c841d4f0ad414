#pragma once

#include <Eigen/Dense>
#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include "diagnose/analysis.hpp"
#include "diagnose/candidates.hpp"

namespace pcor::internal {

/// Effects of flaps and gear, and effects that resemble them, on all samples. Samples with flaps extended are
/// included although fits of a model without such an effect exclude them.
struct FlapsCandidates {
  std::vector<Candidate> candidates{};
  std::vector<bool> reads_flaps{};         ///< one per candidate; the others are rivals
  std::vector<Eigen::MatrixXf> columns{};  ///< one per flight; no rows for remote flights
};

/// Without candidates if too few samples have flaps extended.
FlapsCandidates find_flaps_candidates(const CandidateSet& set, const PartitionedColumns& columns);

/// Tests them together with the model and the findings of `analysis`, and adds the result or its upper limit
/// to the diagnosis. @param groups of the columns of `flaps`
void diagnose_flaps(const Analysis& analysis, const References& references, const FlapsCandidates& flaps,
                    std::vector<ColumnGroup> groups, Diagnosis& diagnosis);

}  // namespace pcor::internal
