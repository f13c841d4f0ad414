#pragma once

#include <string>

namespace pcor::internal {

/// Id "reference:NAME" of an effect or coefficient of a system that the model is compared with.
/// @param system needed if there are several systems: "reference:PSFRD+QCFR:NAME"; otherwise empty
inline std::string id_on_other_system(const std::string& system, const std::string& name) {
  return "reference:" + (system.empty() ? "" : system + ":") + name;
}

/// Whether an id belongs to such a system.
inline bool is_on_other_system(const std::string& id) { return id.rfind(id_on_other_system("", ""), 0) == 0; }

}  // namespace pcor::internal
