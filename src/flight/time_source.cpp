#include "flight/time_source.hpp"

#include <pcor/units/units.hpp>
#include <pcor/words/error.hpp>
#include <pcor/words/utc.hpp>

#include <cmath>
#include <cstdio>
#include <ctime>
#include <optional>
#include <vector>

namespace pcor::internal {
namespace {

constexpr double day = 86400;

// Research flights in netCDF files: after 1971, so that seconds since midnight are not taken for 1970.
bool is_plausible(double time) { return time >= 31536000. && time < 4102444800.; }

std::optional<double> first_value(const FlightFile& file, std::optional<int> variable) {
  if (!variable || !file.is_numeric(*variable)) return std::nullopt;
  const std::vector<int> dimensions = file.dimensions_of(*variable);
  if (dimensions.size() > 1 || (!dimensions.empty() && file.dimension_length(dimensions[0]) == 0))
    return std::nullopt;
  double value = 0;
  file.read(*variable, {0, 1}, &value);
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

// "seconds since 2004-02-18 00:00:00 +0000" as a conversion to seconds since 1970.
std::optional<UnitConversion> epoch_conversion(const std::string& units) {
  if (units.find("since") == std::string::npos) return std::nullopt;
  try {
    return UnitConversion::between(units, "seconds since 1970-01-01 00:00:00 UTC", {});
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::optional<double> base_time(const FlightFile& file) {
  const std::optional<double> base = first_value(file, file.find_variable("base_time"));
  return base && is_plausible(*base) ? base : std::nullopt;
}

// FlightDate as the midnight it begins with.
std::optional<double> flight_date(const FlightFile& file) {
  const std::string text = file.text_attribute(FlightFile::whole_file, "FlightDate");
  int year = 0, month = 0, day_of_month = 0;
  if (std::sscanf(text.c_str(), "%d/%d/%d", &month, &day_of_month, &year) != 3 &&
      std::sscanf(text.c_str(), "%4d-%2d-%2d", &year, &month, &day_of_month) != 3)
    return std::nullopt;
  std::tm fields{};
  fields.tm_year = year - 1900;
  fields.tm_mon = month - 1;
  fields.tm_mday = day_of_month;
  const auto midnight = static_cast<double>(timegm(&fields));
  const bool same =
      fields.tm_year == year - 1900 && fields.tm_mon == month - 1 && fields.tm_mday == day_of_month;
  return same && is_plausible(midnight) ? std::optional(midnight) : std::nullopt;
}

// The start in TimeInterval ("14:22:00-15:13:00"), seconds since midnight.
std::optional<double> interval_start(const FlightFile& file) {
  const std::string text = file.text_attribute(FlightFile::whole_file, "TimeInterval");
  int hour = 0, minute = 0, second = 0;
  if (std::sscanf(text.c_str(), "%d:%d:%d", &hour, &minute, &second) != 3) return std::nullopt;
  return hour * 3600. + minute * 60. + second;
}

// Plain seconds count from midnight or from the first record; the known start of the flight tells which.
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
  return std::nullopt;
}

}  // namespace

TimeSource find_time(const FlightFile& file) {
  const std::string path = file.path().string();
  const auto time = find_time_variable(file);
  const auto offset = file.find_variable("time_offset");
  if (!time && (!offset || file.dimensions_of(*offset).size() != 1))
    throw Error(path +
                " has neither a variable Time nor base_time and time_offset; it is not a flight file that "
                "pcor reads");

  TimeSource source;
  source.variable = time ? *time : *offset;
  source.dimension = file.dimensions_of(source.variable).front();
  if (file.dimension_length(source.dimension) == 0)
    throw Error(path + " has no records: its dimension " + file.dimension_name(source.dimension) +
                " is empty; choose a file with data");
  const std::string name = file.variable_name(source.variable);
  const std::string units = file.text_attribute(source.variable, "units");
  const auto raw = first_value(file, source.variable);
  if (!raw)
    throw Error(path + ": the variable " + name + " is not numeric at record 0; repair the time axis");

  const auto base = base_time(file);
  const auto epoch = epoch_conversion(units);
  const bool units_hold = epoch && is_plausible((*epoch)(*raw));
  if (!time && base) {
    source.offset = *base;
    source.words = "base_time + time_offset";
    return source;
  }
  if (units_hold) {
    constexpr double week = 7 * day;
    if (epoch->scale() > week)
      throw Error(path + ": " + name + " counts in \"" + units +
                  "\", and months and years are not always as long; state the unit it is in with ncatted -a "
                  "units," +
                  name + ",o,c,\"seconds since 2004-02-18 00:00:00 +0000\" " + path);
    source.scale = epoch->scale();
    source.offset = std::round(epoch->offset() * 1000) / 1000;
    source.words = name + ", " + units;
    return source;
  }
  if (base)
    if (const auto start = offset_of_seconds(*raw, *base)) {
      source.offset = *start;
      source.words = name + " with base_time, because its units \"" + units + "\" are impossible";
      return source;
    }
  if (const auto midnight = flight_date(file)) {
    const auto start = interval_start(file);
    const auto from = start ? offset_of_seconds(*raw, *midnight + *start)
                            : std::optional(*raw > 0 && *raw < 2 * day ? *midnight : -1);
    if (from && is_plausible(*from)) {
      source.offset = *from;
      source.words = name + " with FlightDate, because its units \"" + units + "\" are impossible";
      return source;
    }
  }
  throw Error(path + ": " + name + " does not tell the time: its units are \"" + units +
              "\" and there is no base_time or FlightDate that fits; state them with ncatted -a units," +
              name + ",o,c,\"seconds since 2004-02-18 00:00:00 +0000\" " + path);
}

}  // namespace pcor::internal
