#pragma once

#include <set>
#include <string>

#include <pcor/flight/flight.hpp>

namespace pcor::internal {

/// Variables of a flight that are computed, directly or indirectly, from any of `sensors` or from the inputs
/// of these, according to the attribute `Dependencies` of NCAR files ("3 PSXC QCXC ATX": number and names).
/// The sensors and their inputs are excluded. Empty if the file has no such attribute.
std::set<std::string> computed_from(const Flight& flight, const std::set<std::string>& sensors);

}  // namespace pcor::internal
