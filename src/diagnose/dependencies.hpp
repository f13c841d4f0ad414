#pragma once

#include <set>
#include <string>

#include <pcor/flight/flight.hpp>

namespace pcor::internal {

/// The variables of a flight that are computed from any of `sensors`, or from what these are computed from
/// themselves, in however many steps: as the attributes `Dependencies` of NCAR's files say ("3 PSXC QCXC
/// ATX": how many, and which). The sensors and what they are computed from are not among them. Nothing where
/// the file does not say.
std::set<std::string> computed_from(const Flight& flight, const std::set<std::string>& sensors);

}  // namespace pcor::internal
