#pragma once

#include <cstring>
#include <string>

namespace pcor::internal {

/// Whether a long name calls its variable corrected, as "Corrected Static Pressure" does; "uncorrected" and
/// "not corrected" do not.
inline bool is_called_corrected(const std::string& long_name) {
  return strcasestr((" " + long_name).c_str(), " corrected") != nullptr &&
         strcasestr(long_name.c_str(), "not corrected") == nullptr;
}

}  // namespace pcor::internal
