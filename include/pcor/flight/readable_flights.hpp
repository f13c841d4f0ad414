#pragma once

#include <pcor/parallel/communicator.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace pcor {

/// The reason why each flight cannot be opened, one sentence; empty if it can be opened. Opens and closes
/// each flight; the flights are shared between the ranks.
std::vector<std::string> reasons_unreadable(const std::vector<std::filesystem::path>& flights,
                                            Communicator& comm = serial_communicator());

}  // namespace pcor
