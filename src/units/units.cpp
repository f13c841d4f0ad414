#include <udunits2.h>
#include <pcor/base/error.hpp>
#include <pcor/units/units.hpp>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <memory>
#include <mutex>
#include <new>
#include <string_view>
#include <vector>

#include "base/quoting.hpp"

namespace pcor {
namespace {

// Spellings of units in flight files that UDUNITS does not know or misinterprets: "C" would be coulomb, "mb"
// millibarn, "cnt" centinit, "N/cm3" newton per cubic centimetre.
struct Spellings {
  std::string_view standard;  // spelling of UDUNITS
  std::vector<std::string_view> seen;
};
const std::vector<Spellings>& spellings() {
  static const std::vector<Spellings> all{
      {"1",
       {"#", "N/A", "NA", "cnt", "cnts", "dimensionless", "fraction", "nondimensional", "none", "unitless"}},
      {"K", {"deg K"}},
      {"L-1", {"#/L", "#/l", "#/liter", "N/L"}},
      {"L/min", {"Lpm", "lpm", "slpm", "splm", "vlpm"}},
      {"V", {"VDC", "Vdc", "vdc"}},
      {"W/m2", {"W/M2"}},
      {"cm-3", {"#/cc", "#/cm3", "N/cM3", "N/cm3"}},
      {"cm3/s", {"std cm3/s", "vol cm3/s"}},
      {"degC", {"C", "Deg C", "Deg_C", "Degrees C", "deg C", "deg. C", "degree C", "degrees C", "degs C"}},
      {"degree",
       {"DEG", "Deg", "Degs", "decimal degrees", "deg", "deg E", "deg N", "deg true", "degE", "degN", "deg_T",
        "deg_true", "degree_T", "degrees east", "degrees north", "degrees true", "degrees_T", "degs"}},
      {"degree/s", {"deg/S", "deg/s"}},
      {"ft", {"FT"}},
      {"ft/min", {"fpm"}},
      {"g/kg", {"gm/kg"}},
      {"g/m3", {"g/M3", "gm/m3"}},
      {"hPa", {"HPA", "HPa", "hpa"}},
      {"kPa", {"KPa"}},
      {"knot", {"KTS", "kn"}},
      {"m", {"M", "m MSL"}},
      {"m-1", {"M-1"}},
      {"m-3", {"#/m3"}},
      {"m/s", {"M/S", "M/s", "M/sec", "mps"}},
      {"m/s2", {"M/s2"}},
      {"mbar", {"MB", "MBAR", "Mb", "Mbar", "mb"}},
      {"mbar/s", {"mb/s"}},
      {"percent", {"pct"}},
      {"psi", {"PSI", "psia"}},
      {"rpm", {"RPM"}},
      {"um", {"uM"}},
  };
  return all;
}

struct Deleter {
  void operator()(ut_system* system) const { ut_free_system(system); }
  void operator()(ut_unit* unit) const { ut_free(unit); }
  void operator()(cv_converter* converter) const { cv_free(converter); }
};
using Unit = std::unique_ptr<ut_unit, Deleter>;
using Converter = std::unique_ptr<cv_converter, Deleter>;

// UDUNITS parses with global state, so every use holds this lock.
std::mutex& udunits_lock() {
  static std::mutex lock;
  return lock;
}

/// Calls UDUNITS. @throws std::bad_alloc if out of memory, which UDUNITS may report as an invalid unit
template <class Question>
auto answer_to(const Question& question) {
  errno = 0;
  auto answer = question();
  if (!answer && errno == ENOMEM) throw std::bad_alloc();
  return answer;
}

ut_system* udunits() {
  static const std::unique_ptr<ut_system, Deleter> system = [] {
    ut_set_error_message_handler(ut_ignore);
    return answer_to([] { return std::unique_ptr<ut_system, Deleter>(ut_read_xml(nullptr)); });
  }();
  if (!system)
    throw Error(
        Error::Code::system,
        "the unit database of UDUNITS cannot be read; install udunits2-data or set UDUNITS2_XML_PATH");
  return system.get();
}

Unit parse(const std::string& unit) {
  if (unit.empty()) return nullptr;
  ut_system* const system = udunits();
  const std::string standard = standard_unit(unit);
  return answer_to([&] { return Unit(ut_parse(system, standard.c_str(), UT_UTF8)); });
}

std::string how_to_state(const UnitOwner& owner, const std::string& to) {
  if (owner.role.empty()) return "state its unit, e.g. \"" + to + "\"";
  return "add unit." + owner.role + " = \"" + to +
         "\", or its actual unit, to the [units] table of the model file";
}

}  // namespace

std::string standard_unit(const std::string& unit) {
  for (const auto& [standard, seen] : spellings()) {
    if (std::find(seen.begin(), seen.end(), unit) != seen.end()) return std::string(standard);
  }
  return unit;
}

bool is_known_unit(const std::string& unit) {
  const std::lock_guard guard(udunits_lock());
  return parse(unit) != nullptr;
}

UnitConversion UnitConversion::between(const std::string& from, const std::string& to,
                                       const UnitOwner& owner) {
  const std::lock_guard guard(udunits_lock());
  const std::string whose = (owner.file.empty() ? "" : owner.file + ": ") + owner.variable;
  const auto refuse = [&](const std::string& why) {
    throw Error(Error::Code::unit, whose + " has the unit \"" + internal::shortened(from) + "\", which " +
                                       why + how_to_state(owner, to));
  };
  if (from.empty()) throw Error(Error::Code::unit, whose + " has no unit; " + how_to_state(owner, to));
  const Unit target = parse(to);
  if (!target)
    throw Error(Error::Code::unit, whose + ": the requested unit \"" + to + "\" is not known to UDUNITS");
  const Unit source = parse(from);
  if (!source) refuse("is not known; ");
  if (!answer_to([&] { return ut_are_convertible(source.get(), target.get()); }))
    refuse("cannot be converted to " + to + "; choose another variable, or ");

  const Converter converter =
      answer_to([&] { return Converter(ut_get_converter(source.get(), target.get())); });
  const auto convert = [&](double value) { return cv_convert_double(converter.get(), value); };
  // A wide span keeps the rounding of an offset (273.15) out of the scale.
  constexpr double span = 1 << 20;
  const double offset = convert(0);
  double scale = (convert(span) - convert(-span)) / (2 * span);
  if (std::abs(scale - 1) < 1e-12) scale = 1;
  const double middle = convert(span / 4);
  const bool is_line =
      std::isnormal(scale) && std::isfinite(offset) &&
      std::abs(middle - (scale * span / 4 + offset)) <= 1e-9 * (std::abs(middle) + std::abs(offset));
  if (!is_line) refuse("is not proportional to " + to + "; ");
  return {scale, offset};
}

bool is_convertible(const std::string& from, const std::string& to) {
  try {
    UnitConversion::between(from, to, {});
    return true;
  } catch (const Error& error) {
    if (error.code() != Error::Code::unit) throw;
    return false;
  }
}

}  // namespace pcor
