#pragma once

#include <vector>

#include "flight/flight_file.hpp"

namespace pcor::internal {

/// Samples of a variable that the file marks as unusable in a variable of status flags (CF conventions, 3.5).
/// The flag variable is named in `ancillary_variables`, or has the name of the variable with "_FLAG". It
/// holds integers over the same dimensions, or one for each record, with `flag_meanings` and `flag_values`,
/// `flag_masks` or both.
///
/// A sample is unusable if a meaning contains one of these words: bad, missing, invalid, major (as in
/// "possible_major_issues"), or out_of_range, unless it also contains "not". Other flags, such as
/// "aircraft_on_ground", and missing flags do not change a sample.
class StatusFlags {
 public:
  /// All status flags of a variable. The quality bits of this library are not status flags: they also refer
  /// to inputs, and a missing result is already marked as missing.
  static std::vector<StatusFlags> of(const FlightFile& file, int variable);

  int variable() const { return variable_; }

  /// One flag for each record, of a variable with several samples in it.
  bool is_of_record() const { return is_of_record_; }

  /// Whether a stored number of the flags' variable calls the sample unusable.
  bool unusable(double flag) const;

 private:
  struct Condition {
    unsigned long mask;   ///< mask of the relevant bits
    unsigned long value;  ///< what they are then
  };

  StatusFlags(const FlightFile& file, int variable, bool is_of_record);

  int variable_ = 0;
  bool is_of_record_ = false;
  double span_ = 0.0;  ///< number of values of the type of the flags
  std::vector<double> missing_;
  std::vector<Condition> conditions_;
};

}  // namespace pcor::internal
