#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/physics/recovery_factor.hpp>

namespace pcor::internal {

/// The variables of a pair of pressures, hPa.
struct PressurePair {
  std::string static_pressure;
  std::string dynamic_pressure;

  /// "PSFD/QCF".
  std::string name() const { return static_pressure + "/" + dynamic_pressure; }
};

/// A recovery temperature, and the law of its thermometer.
struct Thermometer {
  std::string variable;
  std::string_view recovery;  ///< one of `published_recovery_factors`
};

/// What files of some aircraft call things: data/aircraft/*.toml, which the library holds.
struct VariableNaming {
  std::string name;   ///< "faam-core"
  std::string title;  ///< "FAAM BAe-146, core data"
  std::string source;
  std::vector<std::string> unverified{};  ///< names that no public document was found of

  /// A global attribute of a file and a word in it, without regard to case.
  std::vector<std::pair<std::string, std::string>> attributes{};
  std::vector<std::string> variables{};  ///< that its files have, all of them

  std::vector<PressurePair> measured{};   ///< pairs as measured, the likeliest first
  std::vector<PressurePair> processed{};  ///< pairs that the flight's own processing chose or corrected
  std::map<std::string, std::vector<std::string>, std::less<>> series{};  ///< names, the likeliest first
  std::vector<Thermometer> thermometers{};                                ///< the likeliest first
  std::map<std::string, std::string>
      units{};  ///< of variables whose files do not say it, or whose sign turns
  std::map<std::string, std::string> traps{};  ///< what a user of a variable should know, a sentence

  /// The variables that hold a series, the likeliest first; empty where there is none. @param of the name of
  /// a role, or of a series that no model reads (`series_named`)
  std::vector<std::string> names_of(std::string_view of) const;

  /// The unit of a variable where its files do not say it; empty where they do.
  std::string unit_of(const std::string& variable) const;
};

/// All families, that of NCAR first, whose names also stand for a file that none knows.
const std::vector<VariableNaming>& aircraft_families();

/// The families whose files are like this one: those of which it has a word in an attribute, and the
/// variables, rather than those of which it has less. More than one where it is like several; none where it
/// is like none.
std::vector<const VariableNaming*> families_like(const Flight& flight);

/// The family whose names hold for a flight: the first that it is like, else NCAR's.
const VariableNaming& family_of(const Flight& flight);

/// The family of that name, or in the file whose name ends in ".toml". @throws Error with what may have been
/// meant if there is none.
const VariableNaming& family_named(const std::string& name);

/// Reads the text of a family. @throws Error "name:line:column: what is wrong; what to do"
VariableNaming parse_family(std::string_view text, std::string_view name);

}  // namespace pcor::internal
