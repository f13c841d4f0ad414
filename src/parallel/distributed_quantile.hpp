#pragma once

#include <pcor/parallel/communicator.hpp>

#include <cstdint>
#include <functional>
#include <vector>

namespace pcor::internal {

/// Requested ranks in the sorted order of `count` values, 0 for the smallest; increasing.
using WantedPlaces = std::function<std::vector<std::uint64_t>(std::uint64_t count)>;

/// Values at given positions of the sorted values of all ranks together: exact and independent of the
/// distribution of the values. Found bit by bit from counts, in eight exchanges of 2 kB for each position,
/// for any number of values.
/// @param values without NaN
std::vector<double> values_at(Communicator& comm, std::vector<double> values, const WantedPlaces& requested);

/// Median of the absolute values of all ranks together, equal to `median` of one list.
/// @param values NaN values are excluded @return NaN if all ranks have no values
double median_of_absolute_values(Communicator& comm, std::vector<double> values);

}  // namespace pcor::internal
