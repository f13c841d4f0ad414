#pragma once

#include <limits>
#include <string>

namespace pcor {

/// Whose unit is being read, for the messages. `file` and `role` may be empty.
struct UnitOwner {
  std::string variable;  ///< the name in the file, e.g. "PSFD"
  std::string file;      ///< where it is
  std::string role;      ///< what the model file calls it, e.g. "static_pressure"
};

/// A linear conversion between two units: `value * scale + offset`, of what is possible in the second one.
class UnitConversion {
 public:
  /// The conversion that changes nothing.
  UnitConversion() = default;

  UnitConversion(double scale, double offset) : scale_(scale), offset_(offset) {}

  /// From the unit `from`, as a file spells it, to the unit `to`, e.g. ("mbar", "hPa"). NaN stays NaN.
  ///
  /// @throws Error if `from` is empty or not known, if it measures something else than `to`, or if the two
  /// are not related by a straight line (dBZ). The message says how to state the unit in the model file.
  static UnitConversion between(const std::string& from, const std::string& to, const UnitOwner& owner);

  /// The same of which nothing less than `least` or more than `greatest` comes out, but NaN.
  UnitConversion within(double least, double greatest) const {
    UnitConversion limited = *this;
    limited.least_ = least;
    limited.greatest_ = greatest;
    return limited;
  }

  double scale() const { return scale_; }
  double offset() const { return offset_; }
  double least() const { return least_; }
  double greatest() const { return greatest_; }

  double operator()(double value) const {
    const double converted = value * scale_ + offset_;
    return converted >= least_ && converted <= greatest_ ? converted
                                                         : std::numeric_limits<double>::quiet_NaN();
  }

 private:
  double scale_ = 1;
  double offset_ = 0;
  double least_ = std::numeric_limits<double>::lowest();
  double greatest_ = std::numeric_limits<double>::max();
};

/// A unit as real flight files spell it in the spelling of UDUNITS and CF: "C" is "degC", "M/s" is "m/s",
/// "none" is "1". The spelling is looked up exactly, case and all; one that needs no change is returned as it
/// is.
std::string standard_unit(const std::string& unit);

/// Whether the unit is known, after `standard_unit`. An empty unit is not.
bool is_known_unit(const std::string& unit);

/// Whether `UnitConversion::between` has a conversion from the one unit to the other.
bool is_convertible(const std::string& from, const std::string& to);

}  // namespace pcor
