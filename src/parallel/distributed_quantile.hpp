#pragma once

#include <pcor/parallel/communicator.hpp>

#include <cstdint>
#include <functional>
#include <vector>

namespace pcor::internal {

/// The places in the order of so many values, the least at 0, that are wanted; in their order.
using WantedPlaces = std::function<std::vector<std::uint64_t>(std::uint64_t count)>;

/// The values at some places of the order of all values that the members of a team have together: exact, so
/// they do not depend on who has which. Found bit by bit from counts, in eight exchanges of 2 kB for each
/// place, however many values there are.
/// @param values none of them NaN
std::vector<double> values_at(Communicator& comm, std::vector<double> values, const WantedPlaces& wanted);

}  // namespace pcor::internal
