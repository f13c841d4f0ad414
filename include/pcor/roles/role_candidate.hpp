#pragma once

#include <string>

namespace pcor {

/// Variable that may match a role, by name, long name, unit and values.
struct RoleCandidate {
  std::string variable{};
  double score = 0.0;  ///< 0 to 1, increasing with the evidence
  std::string why{};   ///< "its name is 'static pressure', in hPa, with 560 to 960"
};

template <class Field>
void describe(const RoleCandidate& self, Field& field) {
  field("variable", self.variable, "variable that may match the role");
  field("score", self.score, "strength of the evidence, 0 to 1");
  field("why", self.why, "evidence");
}

}  // namespace pcor
