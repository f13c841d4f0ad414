#pragma once

#include <optional>
#include <string>
#include <vector>

#include "flight/flight_file.hpp"

namespace pcor::internal {

/// Which samples of a variable its file calls unusable, by a variable of status flags beside it (CF
/// conventions, 3.5): one that the variable names in `ancillary_variables`, or that has its name with
/// "_FLAG", over the same dimensions, with `flag_meanings` and `flag_values`, `flag_masks` or both.
///
/// Unusable is what a meaning says in one of these words: bad, missing, invalid, major (as in
/// "possible_major_issues"), or out_of_range. Other flags, as "aircraft_on_ground", leave a sample as it is.
class StatusFlags {
 public:
  /// Of a variable; nothing where the file has no such flags, or none of them says that a sample is unusable.
  static std::optional<StatusFlags> of(const FlightFile& file, int variable);

  int variable() const { return variable_; }

  /// Whether a stored number of the flags' variable calls the sample unusable.
  bool unusable(double flag) const;

 private:
  struct Condition {
    unsigned long mask;   ///< which bits count
    unsigned long value;  ///< what they are then
  };

  int variable_ = 0;
  std::vector<Condition> conditions_;
};

}  // namespace pcor::internal
