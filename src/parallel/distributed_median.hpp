#pragma once

#include <pcor/parallel/communicator.hpp>

#include <vector>

namespace pcor::internal {

/// Median of the absolute values of all ranks together, equal to `median` of one list: exact and independent
/// of the distribution of the values. Found bit by bit from counts, in eight exchanges of 2 kB per rank, for
/// any number of values.
/// @param values NaN values are excluded @return NaN if all ranks have no values
double median_of_absolute_values(Communicator& comm, std::vector<double> values);

}  // namespace pcor::internal
