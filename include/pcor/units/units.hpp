#pragma once

#include <limits>
#include <string>

namespace pcor {

/// Origin of a unit, for messages. `file` and `role` may be empty.
struct UnitOwner {
  std::string variable;  ///< the name in the file, e.g. "PSFD"
  std::string file;      ///< file with the variable
  std::string role;      ///< role in the model file, e.g. "static_pressure"
};

/// Linear conversion between two units: `value * scale + offset`, with limits in the second unit.
class UnitConversion {
 public:
  /// Identity.
  UnitConversion() = default;

  UnitConversion(double scale, double offset) : scale_(scale), offset_(offset) {}

  /// Conversion from the unit `from`, as spelled in a file, to the unit `to`, e.g. ("mbar", "hPa"). NaN stays
  /// NaN.
  ///
  /// @throws Error if `from` is empty or unknown, if it measures a different quantity than `to`, or if the
  /// relation is not linear (dBZ). The message explains how to state the unit in the model file.
  static UnitConversion between(const std::string& from, const std::string& to, const UnitOwner& owner);

  /// Copy limited to [least, greatest]; results outside become NaN.
  UnitConversion within(double minimum, double maximum) const {
    UnitConversion limited = *this;
    limited.minimum_ = minimum;
    limited.maximum_ = maximum;
    return limited;
  }

  double scale() const { return scale_; }
  double offset() const { return offset_; }
  double minimum() const { return minimum_; }
  double maximum() const { return maximum_; }

  double operator()(double value) const {
    const double converted = value * scale_ + offset_;
    return converted >= minimum_ && converted <= maximum_ ? converted
                                                          : std::numeric_limits<double>::quiet_NaN();
  }

 private:
  double scale_ = 1;
  double offset_ = 0;
  double minimum_ = std::numeric_limits<double>::lowest();
  double maximum_ = std::numeric_limits<double>::max();
};

/// UDUNITS and CF spelling of a unit in flight files: "C" is "degC", "M/s" is "m/s", "none" is "1". The
/// lookup is exact and case-sensitive; other spellings are returned unchanged.
std::string standard_unit(const std::string& unit);

/// True if the unit is known, after `standard_unit`. An empty unit is unknown.
bool is_known_unit(const std::string& unit);

/// True if `UnitConversion::between` has a conversion between the units.
bool is_convertible(const std::string& from, const std::string& to);

}  // namespace pcor
