#pragma once

#include <pcor/units/units.hpp>

#include "flight/flight_file.hpp"

namespace pcor::internal {

/// Conversion of the stored numbers of a variable to values in its unit, from its attributes scale_factor and
/// add_offset: 1 and 0 if they are absent. @throws Error if one of them is not a valid number.
UnitConversion unpacking_of(const FlightFile& file, int variable);

}  // namespace pcor::internal
