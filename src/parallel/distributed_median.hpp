#pragma once

#include <pcor/parallel/communicator.hpp>

#include <vector>

namespace pcor::internal {

/// The median of the absolute values that all members of a team have together, as `median` finds it of one
/// list: exact, so it does not depend on who has which. Found bit by bit from counts, in eight exchanges of
/// 2 kB a member, however many values there are.
/// @param values NaN are left out @return NaN where no member has a value
double median_of_absolute_values(Communicator& comm, std::vector<double> values);

}  // namespace pcor::internal
