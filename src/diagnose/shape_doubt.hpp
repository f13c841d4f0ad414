#pragma once

#include <cstddef>
#include <vector>

#include "diagnose/analysis.hpp"

namespace pcor::internal {

/// Part of an effect's chi2 in references where a rival differs from it: the effect's contribution against
/// each reference before absorption by the base, weighted by the share of the difference of the two fits. At
/// most the effect's chi2.
///
/// The catalogue describes the shape of an effect only to about 10 %. The shape error can favour a rival only
/// against a reference in which the two differ; equal contributions favour neither.
///
/// @param others remaining effects in both fits
double chi2_where_they_differ(const Analysis& analysis, const std::vector<std::size_t>& others,
                              std::size_t effect, std::size_t rival);

}  // namespace pcor::internal
