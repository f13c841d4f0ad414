#include <udunits2.h>
#include <pcor/base/error.hpp>
#include <pcor/units/units.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <memory>
#include <mutex>
#include <new>
#include <string_view>
#include <utility>

#include "base/quoting.hpp"

namespace pcor {
namespace {

struct Alias {
  std::string_view seen;      // spelling in flight files
  std::string_view standard;  // spelling of UDUNITS
};

// Units in flight files that UDUNITS does not know or misinterprets: "C" would be coulomb, "mb" millibarn,
// "cnt" centinit, "N/cm3" newton per cubic centimetre. Ordered by `seen`.
constexpr std::array aliases{
    Alias{"#", "1"},
    Alias{"#/L", "L-1"},
    Alias{"#/cc", "cm-3"},
    Alias{"#/cm3", "cm-3"},
    Alias{"#/l", "L-1"},
    Alias{"#/liter", "L-1"},
    Alias{"#/m3", "m-3"},
    Alias{"C", "degC"},
    Alias{"DEG", "degree"},
    Alias{"Deg", "degree"},
    Alias{"Deg C", "degC"},
    Alias{"Deg_C", "degC"},
    Alias{"Degrees C", "degC"},
    Alias{"Degs", "degree"},
    Alias{"FT", "ft"},
    Alias{"HPA", "hPa"},
    Alias{"HPa", "hPa"},
    Alias{"KPa", "kPa"},
    Alias{"KTS", "knot"},
    Alias{"Lpm", "L/min"},
    Alias{"M", "m"},
    Alias{"M-1", "m-1"},
    Alias{"M/S", "m/s"},
    Alias{"M/s", "m/s"},
    Alias{"M/s2", "m/s2"},
    Alias{"M/sec", "m/s"},
    Alias{"MB", "mbar"},
    Alias{"MBAR", "mbar"},
    Alias{"Mb", "mbar"},
    Alias{"Mbar", "mbar"},
    Alias{"N/A", "1"},
    Alias{"N/L", "L-1"},
    Alias{"N/cM3", "cm-3"},
    Alias{"N/cm3", "cm-3"},
    Alias{"NA", "1"},
    Alias{"PSI", "psi"},
    Alias{"RPM", "rpm"},
    Alias{"VDC", "V"},
    Alias{"Vdc", "V"},
    Alias{"W/M2", "W/m2"},
    Alias{"cnt", "1"},
    Alias{"cnts", "1"},
    Alias{"decimal degrees", "degree"},
    Alias{"deg", "degree"},
    Alias{"deg C", "degC"},
    Alias{"deg E", "degree"},
    Alias{"deg K", "K"},
    Alias{"deg N", "degree"},
    Alias{"deg true", "degree"},
    Alias{"deg. C", "degC"},
    Alias{"deg/S", "degree/s"},
    Alias{"deg/s", "degree/s"},
    Alias{"degE", "degree"},
    Alias{"degN", "degree"},
    Alias{"deg_T", "degree"},
    Alias{"deg_true", "degree"},
    Alias{"degree C", "degC"},
    Alias{"degree_T", "degree"},
    Alias{"degrees C", "degC"},
    Alias{"degrees east", "degree"},
    Alias{"degrees north", "degree"},
    Alias{"degrees true", "degree"},
    Alias{"degrees_T", "degree"},
    Alias{"degs", "degree"},
    Alias{"degs C", "degC"},
    Alias{"dimensionless", "1"},
    Alias{"fpm", "ft/min"},
    Alias{"fraction", "1"},
    Alias{"g/M3", "g/m3"},
    Alias{"gm/kg", "g/kg"},
    Alias{"gm/m3", "g/m3"},
    Alias{"hpa", "hPa"},
    Alias{"kn", "knot"},
    Alias{"lpm", "L/min"},
    Alias{"m MSL", "m"},
    Alias{"mb", "mbar"},
    Alias{"mb/s", "mbar/s"},
    Alias{"mps", "m/s"},
    Alias{"nondimensional", "1"},
    Alias{"none", "1"},
    Alias{"pct", "percent"},
    Alias{"psia", "psi"},
    Alias{"slpm", "L/min"},
    Alias{"splm", "L/min"},
    Alias{"std cm3/s", "cm3/s"},
    Alias{"uM", "um"},
    Alias{"unitless", "1"},
    Alias{"vdc", "V"},
    Alias{"vlpm", "L/min"},
    Alias{"vol cm3/s", "cm3/s"},
};

constexpr bool aliases_are_ordered() {
  for (std::size_t i = 1; i < aliases.size(); ++i)
    if (!(aliases[i - 1].seen < aliases[i].seen)) return false;
  return true;
}
static_assert(aliases_are_ordered());

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
  const auto alias =
      std::lower_bound(aliases.begin(), aliases.end(), std::string_view(unit),
                       [](const Alias& each, std::string_view requested) { return each.seen < requested; });
  return alias != aliases.end() && alias->seen == unit ? std::string(alias->standard) : unit;
}

bool is_known_unit(const std::string& unit) {
  const std::lock_guard guard(udunits_lock());
  return parse(unit) != nullptr;
}

UnitConversion UnitConversion::between(const std::string& from, const std::string& to,
                                       const UnitOwner& owner) {
  const std::lock_guard guard(udunits_lock());
  const std::string whose = (owner.file.empty() ? "" : owner.file + ": ") + owner.variable;
  const std::string shown = internal::shortened(from);
  if (from.empty()) throw Error(Error::Code::unit, whose + " has no unit; " + how_to_state(owner, to));
  const Unit target = parse(to);
  if (!target)
    throw Error(Error::Code::unit, whose + ": the requested unit \"" + to + "\" is not known to UDUNITS");
  const Unit source = parse(from);
  if (!source)
    throw Error(Error::Code::unit,
                whose + " has the unit \"" + shown + "\", which is not known; " + how_to_state(owner, to));
  if (!answer_to([&] { return ut_are_convertible(source.get(), target.get()); }))
    throw Error(Error::Code::unit, whose + " has the unit \"" + shown + "\", which cannot be converted to " +
                                       to + "; choose another variable, or " + how_to_state(owner, to));

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
  if (!is_line)
    throw Error(Error::Code::unit, whose + " has the unit \"" + shown + "\", which is not proportional to " +
                                       to + "; " + how_to_state(owner, to));
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
