#pragma once

#include <cstddef>
#include <string>

#include <pcor/model/model.hpp>

namespace pcor::internal {

/// Unit of a parameter of an effect; "1" for a surface. For a formula it is the unit of the value, if the
/// formula is a sum of this coefficient times pure numbers and of a part without it; divided by the unit of a
/// quantity, if this coefficient is also multiplied by it; otherwise empty, because units of formulas are not
/// computed.
std::string parameter_unit(const ModelEffect& effect, std::size_t number);

}  // namespace pcor::internal
