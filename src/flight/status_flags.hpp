#pragma once

#include <string>
#include <vector>

#include "flight/flight_file.hpp"

namespace pcor::internal {

/// Which samples of a variable its file calls unusable, by a variable of status flags beside it (CF
/// conventions, 3.5): one that the variable names in `ancillary_variables`, or that has its name with
/// "_FLAG". It holds integers over the same dimensions, or one for each record, with `flag_meanings` and
/// `flag_values`, `flag_masks` or both.
///
/// Unusable is what a meaning says in one of these words: bad, missing, invalid, major (as in
/// "possible_major_issues"), or out_of_range, unless it says "not". Other flags, as "aircraft_on_ground", and
/// flags that are missing, leave a sample as it is.
class StatusFlags {
 public:
  /// All that call samples of a variable unusable. The quality bits of results of this library are none: they
  /// speak of inputs too, and where there is no result it is missing already.
  static std::vector<StatusFlags> of(const FlightFile& file, int variable);

  int variable() const { return variable_; }

  /// One flag for each record, of a variable with several samples in it.
  bool is_of_record() const { return is_of_record_; }

  /// Whether a stored number of the flags' variable calls the sample unusable.
  bool unusable(double flag) const;

 private:
  struct Condition {
    unsigned long mask;   ///< which bits count
    unsigned long value;  ///< what they are then
  };

  StatusFlags(const FlightFile& file, int variable, bool is_of_record);

  int variable_ = 0;
  bool is_of_record_ = false;
  double span_ = 0.0;  ///< how many numbers the type of the flags has
  std::vector<double> missing_;
  std::vector<Condition> conditions_;
};

}  // namespace pcor::internal
