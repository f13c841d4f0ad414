#pragma once

#include <string_view>

#include <pcor/units/units.hpp>

namespace pcor::internal {

/// The conversion of a series to its unit, without values that it cannot have.
/// @param series the name of a role or of another series (`series_named`); of others everything is possible
UnitConversion possible_values(const UnitConversion& conversion, std::string_view series);

}  // namespace pcor::internal
