#include "flight/time_source.hpp"

#include <strings.h>
#include <pcor/base/error.hpp>
#include <pcor/base/shell_quote.hpp>
#include <pcor/base/utc.hpp>
#include <pcor/units/units.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <optional>
#include <string_view>
#include <vector>

#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

constexpr double day = 86400;

// Research flights in netCDF files are later than 1971, so seconds since midnight are not mistaken for times
// in 1970.
bool is_plausible(double time) { return time >= 31536000. && time < 4102444800.; }

// A date as the midnight it begins with, if there is such a date.
std::optional<double> midnight_of(int year, int month, int day_of_month) {
  std::tm fields{};
  fields.tm_year = year - 1900;
  fields.tm_mon = month - 1;
  fields.tm_mday = day_of_month;
  const auto midnight = static_cast<double>(timegm(&fields));
  const bool same =
      fields.tm_year == year - 1900 && fields.tm_mon == month - 1 && fields.tm_mday == day_of_month;
  return same && year > 0 ? std::optional(midnight) : std::nullopt;
}

std::optional<double> first_value(const FlightFile& file, std::optional<int> variable) {
  if (!variable || !file.is_numeric(*variable)) return std::nullopt;
  const std::vector<int> dimensions = file.dimensions_of(*variable);
  if (dimensions.size() > 1 || (!dimensions.empty() && file.dimension_length(dimensions[0]) == 0))
    return std::nullopt;
  double value = 0;
  file.read(*variable, {0, 1}, &value);
  value = file.unpacking_of(*variable)(value);
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

// FlightDate as the midnight it begins with.
std::optional<double> flight_date(const FlightFile& file) {
  const std::string text = file.text_attribute(FlightFile::whole_file, "FlightDate");
  int year = 0, month = 0, day_of_month = 0;
  if (std::sscanf(text.c_str(), "%5d/%5d/%5d", &month, &day_of_month, &year) != 3 &&
      std::sscanf(text.c_str(), "%4d-%2d-%2d", &year, &month, &day_of_month) != 3)
    return std::nullopt;
  const auto midnight = midnight_of(year, month, day_of_month);
  return midnight && is_plausible(*midnight) ? midnight : std::nullopt;
}

bool begins_with_digit(std::string_view text) {
  return !text.empty() && std::isdigit(static_cast<unsigned char>(text.front())) != 0;
}

// "Seconds since 1970-01-01, 00:00:00,5 UTC" as UDUNITS spells it: lower case before the date, a point in
// place of a comma of a fraction of seconds, and no other comma.
std::string usual_spelling(std::string units) {
  const std::size_t digit = std::min(units.find_first_of("0123456789"), units.size());
  std::transform(units.begin(), units.begin() + static_cast<std::ptrdiff_t>(digit), units.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  for (std::size_t i = 0; i < units.size(); ++i) {
    if (units[i] != ',') continue;
    const bool is_fraction = begins_with_digit(std::string_view(units).substr(i + 1)) && units.find(':') < i;
    units[i] = is_fraction ? '.' : ' ';
  }
  return units;
}

// Parsed units of a time.
struct Counting {
  const FlightFile& file;
  std::string variable;
  std::string how_to_state;
  std::string units;
  std::string calendar;
};

std::string how_to_state(const FlightFile& file, const std::string& variable, const std::string& units) {
  return "state its unit with ncatted -a " + shell_quote("units," + ncatted_name(variable) + ",o,c,") +
         shell_quote(units) + " " + shell_path(file.path().string());
}

Counting counting_of(const FlightFile& file, int variable) {
  const std::string name = file.variable_name(variable);
  const std::optional<double> date = flight_date(file);
  const std::string day_of_flight = date ? utc_text(*date, "%Y-%m-%d") : "DAY";
  return {file, name,
          how_to_state(file, name, "seconds since " + day_of_flight + " 00:00:00 +0000") +
              (date ? "" : ", where DAY is its reference date as year-month-day"),
          usual_spelling(file.text_attribute(variable, "units")), file.text_attribute(variable, "calendar")};
}

std::string unit_before(const std::string& units, std::size_t since) {
  const std::size_t last = units.find_last_not_of(' ', since == 0 ? 0 : since - 1);
  return units.substr(0, last == std::string::npos ? 0 : last + 1);
}

// Removes a number of at most two digits, less than `limit`, from the front of the text. Empty without such a
// number.
bool take_number(std::string_view& text, int limit) {
  int digits = 0, number = 0;
  for (; digits < 2 && begins_with_digit(text); ++digits) {
    number = 10 * number + (text.front() - '0');
    text.remove_prefix(1);
  }
  return digits > 0 && number < limit;
}

bool take(std::string_view& text, char letter) {
  if (text.empty() || text.front() != letter) return false;
  text.remove_prefix(1);
  return true;
}

// Whether what follows a date is a time of day and an offset that are possible: UDUNITS takes minutes of 60,
// an offset of 25 hours, and what follows without a blank, without a word. UDUNITS checks
// the rest of the notation, except an offset without a time of day, which it reads as the time of day.
bool is_time_of_day(std::string_view text) {
  constexpr int day_hours = 25;  // 24:00:00
  constexpr int max_offset = 15;
  if (!text.empty() && text.front() != ' ' && text.front() != 'T') return false;
  while (take(text, ' ') || take(text, 'T')) continue;
  const bool has_time = begins_with_digit(text);
  if (has_time) {
    if (!take_number(text, day_hours)) return false;
    for (int part = 0; part < 2; ++part) {
      const bool follows = take(text, ':') || begins_with_digit(text);
      if (follows && !take_number(text, part == 0 ? 60 : 61)) return false;
    }
    if (take(text, '.')) text.remove_prefix(std::min(text.find_first_not_of("0123456789"), text.size()));
  }
  while (take(text, ' ')) continue;
  if (!take(text, '+') && !take(text, '-') && !begins_with_digit(text)) return true;
  if (!take_number(text, has_time ? max_offset : 1)) return false;
  take(text, ':');
  return !begins_with_digit(text) || take_number(text, has_time ? 60 : 1);
}

// "seconds since 2004-02-18 00:00:00 +0000" as a conversion to seconds since 1970; nothing if there is no
// such date. @throws Error if the date is not followed by a time of day in a known zone, or if the calendar
// has other years.
std::optional<UnitConversion> epoch_conversion(const Counting& time) {
  const std::size_t since = time.units.find("since ");
  int year = 0, month = 0, day_of_month = 0, letters = 0;
  if (since == std::string::npos || std::sscanf(time.units.c_str() + since + 6, "%5d-%3d-%3d%n", &year,
                                                &month, &day_of_month, &letters) != 3)
    return std::nullopt;
  if (!midnight_of(year, month, day_of_month)) return std::nullopt;
  constexpr int first_gregorian_year = 1583;
  const auto is = [&time](const char* calendar) { return strcasecmp(time.calendar.c_str(), calendar) == 0; };
  const bool is_gregorian = is("") || is("standard") || is("gregorian") ||
                            (is("proleptic_gregorian") && year >= first_gregorian_year);
  if (!is_gregorian)
    time.file.refuse(Error::Code::time,
                     ": {} counts from the year {} in the calendar \"{}\", which differs from the standard "
                     "calendar; write the time in the standard calendar",
                     time.variable, year, time.calendar);
  const std::size_t behind_date = since + 6 + static_cast<std::size_t>(letters);
  const auto refuse_time_of_day = [&time, behind_date]() {
    // The advice keeps the date and the time of day if only the zone is unknown.
    std::size_t zone = time.units.find_first_not_of("0123456789:. ", behind_date + 1);
    zone = time.units.find_last_not_of(' ', std::min(zone, time.units.size()) - 1) + 1;
    const std::string of_day = time.units.substr(behind_date, zone - behind_date);
    const bool is_known = zone < time.units.size() && is_time_of_day(of_day);
    time.file.refuse(
        Error::Code::time,
        ": {} counts in \"{}\", where what follows the date is not a time of day in UTC or with an "
        "offset in hours; {}",
        time.variable, time.units,
        is_known ? how_to_state(time.file, time.variable,
                                time.units.substr(0, zone) + (of_day.empty() ? " 00:00:00" : "") + " +HHMM") +
                       ", where +HHMM is the offset of its zone from UTC in hours and minutes"
                 : time.how_to_state);
  };
  if (!is_time_of_day(time.units.c_str() + behind_date)) refuse_time_of_day();
  try {
    const UnitConversion epoch =
        UnitConversion::between(time.units, "seconds since 1970-01-01 00:00:00 UTC", {});
    // Duration of the unit over one step, since a difference over 41 years would lose precision.
    const double scale = UnitConversion::between(unit_before(time.units, since), "s", {}).scale();
    return UnitConversion(scale, epoch.offset());
  } catch (const Error& error) {
    if (error.code() != Error::Code::unit) throw;
    refuse_time_of_day();
  }
  return std::nullopt;
}

// Whether the units state no time but midnight in UTC, apart from a date: FlightDate can replace the date,
// and neither a time of day nor an offset.
bool counts_from_midnight(const std::string& units) {
  constexpr const char* digits = "0123456789";
  constexpr std::size_t max_letters = 10;  // 2004-02-18
  const std::size_t date = units.find_first_of(digits);
  if (date == std::string::npos) return true;
  std::size_t end = std::min(units.find_first_not_of(digits, date), units.size());
  for (int part = 0; part < 2 && end < units.size() && std::strchr("-/.", units[end]) != nullptr; ++part)
    end = std::min(units.find_first_not_of(digits, end + 1), units.size());
  const bool has_date = end == units.size() || units[end] != ':';  // "seconds since 00:00:00"
  const std::string of_day = has_date ? units.substr(end) : " " + units.substr(date);
  if (end - date > max_letters || !is_time_of_day(of_day)) return false;
  try {
    const std::string known = "2000-01-01";
    const auto epoch =
        UnitConversion::between(units.substr(0, date) + known + of_day, "seconds since " + known, {});
    return epoch.scale() == 1 && std::abs(epoch.offset()) < 0.001;
  } catch (const Error& error) {
    if (error.code() != Error::Code::unit) throw;
    return false;
  }
}

// The start in TimeInterval ("14:22:00-15:13:00"), seconds since midnight.
std::optional<double> interval_start(const FlightFile& file) {
  const std::string text = file.text_attribute(FlightFile::whole_file, "TimeInterval");
  int hour = 0, minute = 0, second = 0;
  if (std::sscanf(text.c_str(), "%2d:%2d:%2d", &hour, &minute, &second) != 3) return std::nullopt;
  const auto is_within = [](int number, int limit) { return number >= 0 && number < limit; };
  if (!is_within(hour, 24) || !is_within(minute, 60) || !is_within(second, 61)) return std::nullopt;
  return hour * 3600. + minute * 60. + second;
}

// Plain seconds count from midnight or from the first record; the known start of the flight decides.
std::optional<double> offset_of_seconds(double first_raw, double start) {
  const double midnight = midnight_before(start);
  if (std::abs(first_raw - (start - midnight)) < 1.5) return midnight;
  if (std::abs(first_raw) < 1.5) return start;
  return std::nullopt;
}

std::optional<int> find_time_variable(const FlightFile& file) {
  for (const char* name : {"Time", "time", "TIME"})
    if (const auto variable = file.find_variable(name); variable && file.dimensions_of(*variable).size() == 1)
      return variable;
  if (file.find_variable("time_offset")) return std::nullopt;
  // A coordinate variable, or one with the standard name time, that counts since a date.
  for (int variable = 0; variable < file.variable_count(); ++variable) {
    const std::vector<int> dimensions = file.dimensions_of(variable);
    if (dimensions.size() != 1 || !file.is_numeric(variable)) continue;
    const bool is_time = file.text_attribute(variable, "standard_name") == "time" ||
                         file.dimension_name(dimensions.front()) == file.variable_name(variable);
    if (is_time && file.text_attribute(variable, "units").find(" since ") != std::string::npos)
      return variable;
  }
  return std::nullopt;
}

}  // namespace

bool is_of_aviation(double time) {
  constexpr double year_1900 = -2208988800., year_2200 = 7258118400.;
  return time >= year_1900 && time < year_2200;
}

bool begins_again_at_midnight(const TimeSource& source, double before, double now) {
  constexpr double little = 600;
  const double midnight = midnight_before(source.offset);
  const double from = before - midnight, to = now - midnight;
  const double last_midnight = std::floor(from / day) * day;
  return from - last_midnight > day - little && to >= last_midnight && to < last_midnight + little &&
         now + day > before;
}

TimeSource find_time(const FlightFile& file) {
  const auto time = find_time_variable(file);
  const auto offset = file.find_variable("time_offset");
  if (!time && (!offset || file.dimensions_of(*offset).size() != 1))
    file.refuse(
        Error::Code::time,
        " has neither a variable Time nor base_time and time_offset; it is not a flight file that pcor "
        "reads");

  const int variable = time ? *time : *offset;
  const int dimension = file.dimensions_of(variable).front();
  if (file.dimension_length(dimension) == 0)
    file.refuse(Error::Code::samples, " has no records: its dimension {} is empty; choose a file with data",
                file.dimension_name(dimension));
  const std::string name = file.variable_name(variable);
  const Counting counting = counting_of(file, variable);
  const std::string& units = counting.units;
  const auto raw = first_value(file, variable);
  if (!raw)
    file.refuse(Error::Code::time, ": the variable {} is not numeric at record 0; repair the time axis",
                name);

  const double base = first_value(file, file.find_variable("base_time")).value_or(nan);
  const bool has_base = is_plausible(base);
  if (!time && has_base) return {variable, dimension, 1, base};
  const auto epoch = epoch_conversion(counting);
  const double first = epoch ? (*epoch)(*raw) : 0;
  if (epoch && !is_of_aviation(first))
    file.refuse(Error::Code::time, ": {} counts in \"{}\" and begins with {}, which is the {}; {}", name,
                units, *raw, utc_text(first), counting.how_to_state);
  const double max_seconds =
      file.unpacking_of(variable)(file.max_number(variable)) * (epoch ? epoch->scale() : 1);
  if (max_seconds < day)
    file.refuse(
        Error::Code::time,
        ": {} is stored in integers up to {}, less than the seconds of a day, so times may have wrapped; "
        "store time as 32-bit integers or doubles",
        name, file.max_number(variable));
  if (epoch && is_plausible(first)) {
    constexpr double week = 7 * day;
    if (epoch->scale() > week)
      file.refuse(Error::Code::time, ": {} counts in \"{}\", and months and years are not always as long; {}",
                  name, units, counting.how_to_state);
    return {variable, dimension, epoch->scale(), std::round(epoch->offset() * 1000) / 1000};
  }
  if (const auto start = has_base ? offset_of_seconds(*raw, base) : std::nullopt)
    return {variable, dimension, 1, *start};
  if (const auto midnight = flight_date(file)) {
    if (!counts_from_midnight(units))
      file.refuse(
          Error::Code::time,
          ": {} counts in \"{}\", which pcor cannot read completely; write its date as year-month-day "
          "hour:minute:second +hhmm; if it counts from midnight in UTC, {}",
          name, units, counting.how_to_state);
    const auto start = interval_start(file);
    const auto from = start ? offset_of_seconds(*raw, *midnight + *start)
                            : std::optional(*raw > 0 && *raw < 2 * day ? *midnight : -1);
    if (from && is_plausible(*from)) return {variable, dimension, 1, *from};
  }
  file.refuse(
      Error::Code::time,
      ": {} is not a valid time: its units are \"{}\" and there is no matching base_time or FlightDate; {}",
      name, units, counting.how_to_state);
}

}  // namespace pcor::internal
