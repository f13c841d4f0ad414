#pragma once

#include <string>

namespace pcor::internal {

/// The first word of a text that is a registration of civil aircraft: "N677F", "G-LUXE", "D-ADLR". Empty
/// without a registration.
std::string registration_in(const std::string& text);

}  // namespace pcor::internal
