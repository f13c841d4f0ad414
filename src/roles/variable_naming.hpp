#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/physics/recovery_factor.hpp>

namespace pcor::internal {

/// Static pressure of the avionics in NCAR files: corrected by its manufacturer, filtered and delayed.
inline constexpr std::string_view avionics_static_pressure = "PS_A";

/// The variables of a pair of pressures, hPa.
struct PressurePair {
  std::string static_pressure;
  std::string dynamic_pressure;

  /// "PSFD/QCF".
  std::string name() const { return static_pressure + "/" + dynamic_pressure; }
};

inline bool operator==(const PressurePair& a, const PressurePair& b) {
  return a.static_pressure == b.static_pressure && a.dynamic_pressure == b.dynamic_pressure;
}

/// A recovery temperature, and the law of its thermometer.
struct Thermometer {
  std::string variable;
  std::string_view recovery;  ///< one of `published_recovery_factors`
};

/// Names of variables in the files of some aircraft: data/aircraft/*.toml, embedded in the library.
struct VariableNaming {
  std::string name;   ///< "faam-core"
  std::string title;  ///< "FAAM BAe-146, core data"
  std::string source;
  std::vector<std::string> unverified{};  ///< names without a public document

  /// A global attribute of a file and a word in it, without regard to case.
  std::vector<std::pair<std::string, std::string>> attributes{};
  std::vector<std::string> variables{};  ///< variables that all files of the convention have

  std::vector<PressurePair> measured{};   ///< pairs as measured, sorted by decreasing likelihood
  std::vector<PressurePair> processed{};  ///< pairs that the flight's own processing chose or corrected
  std::map<std::string, std::vector<std::string>, std::less<>>
      series{};                             ///< names, sorted by decreasing likelihood
  std::vector<Thermometer> thermometers{};  ///< sorted by decreasing likelihood
  std::map<std::string, std::string>
      units{};  ///< units of variables whose files state no unit, or whose sign is reversed
  std::map<std::string, std::string> caveats{};  ///< one-sentence caution about a variable

  /// The variables that may hold a series, sorted by decreasing likelihood; empty for an unknown series.
  /// @param of name of a role, or of a series that no model reads (`series_named`)
  std::vector<std::string> names_of(std::string_view of) const;

  /// The unit of a variable whose files state no unit; empty otherwise.
  std::string unit_of(const std::string& variable) const;
};

/// All naming conventions. The one of NCAR is first; its names are also used for a file of an unknown
/// convention.
const std::vector<VariableNaming>& known_namings();

/// The conventions that match a flight best, by a word in an attribute and by the variables. Several
/// conventions if they match equally well; empty without a match.
std::vector<const VariableNaming*> matching_namings(const Flight& flight);

/// The convention whose names apply to a flight: the first that matches, otherwise NCAR.
const VariableNaming& naming_of(const Flight& flight);

/// The named convention, or the convention in a file if the name ends in ".toml". @throws Error with similar
/// names if the convention does not exist.
const VariableNaming& naming_by_name(const std::string& name);

/// Reads the text of a convention. @throws Error "name:line:column: what is wrong; what to do"
VariableNaming parse_naming(std::string_view text, std::string_view name);

}  // namespace pcor::internal
