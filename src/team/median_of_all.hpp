#pragma once

#include <pcor/team/team.hpp>

#include <vector>

namespace pcor::internal {

/// The median of the absolute values that all members of a team have together, as `median` finds it of one
/// list: exact, so it does not depend on who has which. Found bit by bit from counts, in eight exchanges of
/// 2 kB a member, however many values there are.
/// @param values NaN are left out @return NaN where no member has a value
double median_of_absolute_values(Team& team, std::vector<double> values);

}  // namespace pcor::internal
