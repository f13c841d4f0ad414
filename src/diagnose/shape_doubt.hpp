#pragma once

#include <cstddef>
#include <vector>

#include "diagnose/analysis.hpp"

namespace pcor::internal {

/// How much chi2 of an effect lies where a rival differs from it: what the effect adds against each
/// reference, before the base takes up any of it, weighted by how much of the difference of the two fits lies
/// there. At most the chi2 by the effect.
///
/// The shape of an effect in nature is that of the catalogue to a tenth or so. What it lacks can favour a
/// rival only against a reference in which the two differ: where both add the same, it speaks for neither.
///
/// @param others the effects that stay beside either
double chi2_where_they_differ(const Analysis& analysis, const std::vector<std::size_t>& others,
                              std::size_t effect, std::size_t rival);

}  // namespace pcor::internal
