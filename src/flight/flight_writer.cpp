#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pcor/base/error.hpp>
#include <pcor/base/utc.hpp>
#include <pcor/flight/flight_writer.hpp>
#include <pcor/units/units.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <map>
#include <optional>

#include <pcor/base/atomic_file.hpp>
#include "base/quoting.hpp"
#include "flight/cf_description.hpp"
#include "flight/netcdf_copy.hpp"
#include "flight/netcdf_output.hpp"

namespace pcor {

using namespace internal;

namespace {

constexpr float fill = -32767;
constexpr int global = FlightFile::whole_file;
constexpr const char* writing = "cannot be written";
constexpr const char* iso_8601 = "%Y-%m-%dT%H:%M:%SZ";

struct Range {
  double minimum = std::numeric_limits<double>::infinity();
  double maximum = -std::numeric_limits<double>::infinity();

  void include(double value) {
    minimum = std::min(minimum, value);
    maximum = std::max(maximum, value);
  }
  bool empty() const { return minimum > maximum; }
};

constexpr Range reserved{fill, fill};  // written until the values of a range are known

/// A duration by ISO 8601, always of the same length.
std::string duration_text(double seconds) {
  const auto whole = static_cast<long>(std::lround(seconds));
  return fmt::format("P{:02}DT{:02}H{:02}M{:02}S", whole / 86400, whole / 3600 % 24, whole / 60 % 60,
                     whole % 60);
}

/// A variable that the program computes.
struct Written {
  std::string name;
  int id = 0;
  int rate = 1;
  bool flags = false;
  std::size_t records = 0;  // written so far
  Range range;
};

NewFlight start_of(const Flight& input) {
  const auto* const netcdf = dynamic_cast<const NetcdfFile*>(&input.file());
  const TimeAxis& time = input.time();
  const bool fits_integers =
      time.whole_seconds && time.last - midnight_before(time.first) <= std::numeric_limits<int>::max();
  return {time.first, fits_integers, netcdf ? netcdf->kind() : NetcdfFormat::netcdf4};
}

}  // namespace

struct FlightWriter::Implementation {
  const Flight* input = nullptr;
  FileDescription description;
  double midnight;
  bool whole_seconds;
  AtomicFile replacement;
  std::optional<NetcdfOutput> file;
  std::optional<NetcdfCopy> copies;                 // netCDF input
  std::vector<std::pair<std::string, int>> series;  // other input: time series that are copied, and their ids

  int time_variable = 0;
  std::vector<Written> written;
  std::map<std::string, Range> copied_ranges;  // coordinates
  std::vector<float> floats;
  std::vector<double> copied_times, copied_values;  // one block
  bool defining = true;
  std::size_t time_records = 0;
  double start_time = 0, end_time = 0;

  Implementation(const std::filesystem::path& output, const Flight* flight, const NewFlight& start,
                 FileDescription what)
      : input(flight),
        description(std::move(what)),
        midnight(midnight_before(start.start_time)),
        whole_seconds(start.whole_seconds),
        replacement(output) {
    std::error_code code;
    if (input && std::filesystem::equivalent(output, input->path(), code))
      throw Error(Error::Code::usage, output.string() + " is the input itself; choose another output");
    file.emplace(replacement.path(), output, start.kind);
    const auto* const source = input ? dynamic_cast<const NetcdfFile*>(&input->file()) : nullptr;
    if (source) {
      const int time = *source->find_variable(input->time_variable());
      copies.emplace(*source, source->dimensions_of(time).front(), *file);
    }
    file->attempt(writing, [&] {
      define_time(start.start_time);
      describe_file();
    });
  }

  void put_text(int variable, const std::string& name, const std::string& text) const {
    file->put_text(variable, name, text);
  }

  // The definition of the file

  void define_time(double first) {
    time_variable = file->add_variable("Time", whole_seconds ? NC_INT : NC_DOUBLE, {file->time()});
    put_text(time_variable, "long_name", "time of measurement");
    put_text(time_variable, "standard_name", "time");
    put_text(time_variable, "axis", "T");
    put_text(time_variable, "calendar", "standard");
    put_text(time_variable, "units", utc_text(first, "seconds since %Y-%m-%d 00:00:00 +0000"));
    put_text(time_variable, "strptime_format", "seconds since %F %T %z");
  }

  void describe_file() {
    const auto now = static_cast<double>(std::time(nullptr));
    std::string history = utc_text(now, iso_8601) + ": " +
                          (description.history.empty() ? "written by pcor" : description.history);
    if (input) {
      if (copies) copies->copy_global_attributes();
      for (const std::string& name :
           copies ? std::vector<std::string>() : input->file().attribute_names(global))
        put_text(global, name, input->file().text_attribute(global, name));
      put_text(global, "time_coverage_resolution", fmt::format("PT{:g}S", input->time().step));
      const std::string earlier = input->attribute("history");
      if (!earlier.empty()) history += "\n" + earlier;
      supply("platform", input->aircraft());
      supply("project", input->project());
    }
    std::string title =
        input ? fmt::format("{} {} {}", input->project(), input->flight_number(), input->aircraft()) : "";
    title.erase(0, title.find_first_not_of(' '));
    put_text(global, "title", description.title);
    supply("title", title.empty() ? "Research flight" : title);
    supply("summary", text_of("title"));
    supply("source", "airborne observations");
    supply("platform_type", "aircraft");
    supply("keywords", "aircraft, airspeed, static pressure, dynamic pressure");
    put_text(global, "Conventions", conventions(true));
    if (!input) put_text(global, "ConventionsURL", "https://www.eol.ucar.edu/raf/Software/netCDF.html");
    put_text(global, "standard_name_vocabulary", "CF Standard Name Table v93");
    put_text(global, "history", history);
    put_text(global, "date_created", utc_text(now, iso_8601));
    put_text(global, "time_coordinate", "Time");
    for (const auto& [name, text] : description.attributes) put_text(global, name, text);
    // Placeholder that is overwritten at the end by a text of the same length.
    put_text(global, "time_coverage_start", utc_text(0, iso_8601));
    put_text(global, "time_coverage_end", utc_text(0, iso_8601));
    supply("FlightDate", utc_text(midnight, "%m/%d/%Y"));
    put_text(global, "TimeInterval", "00:00:00-00:00:00");
    put_text(global, "time_coverage_duration", duration_text(0));
    for (const GeospatialRange& each : geospatial_ranges) {
      if ((description.*each.variable).empty()) continue;
      put_text(global, each.coordinate, description.*each.variable);
      put_range(global, each.range, reserved);
    }
    if (!description.altitude.empty()) put_text(global, "geospatial_vertical_positive", "up");
  }

  std::string conventions(bool is_cf) const {
    std::string claimed = "NCAR-RAF/nimbus-2.1";
    if (input) {
      claimed = input->attribute("Conventions");
      const std::size_t begin = claimed.find("NCAR-RAF");
      claimed = begin == std::string::npos
                    ? ""
                    : claimed.substr(begin, claimed.find_first_of(" ,;", begin) - begin);
    }
    if (!claimed.empty()) claimed += ' ';
    return claimed + (is_cf ? "CF-1.8 ACDD-1.3" : "ACDD-1.3");
  }

  /// Title of the flight: project, flight and date.
  std::string trajectory() const {
    std::string name;
    for (const std::string& part :
         {text_of("project"), text_of("FlightNumber"), utc_text(midnight, "%Y-%m-%d")}) {
      if (!part.empty()) name += (name.empty() ? "" : " ") + part;
    }
    return name;
  }

  /// Whether every unit is one that UDUNITS knows.
  bool has_known_units() const {
    const int count = file->variable_count();
    for (int variable = 0; variable < count; ++variable) {
      const std::string unit = file->text_attribute(variable, "units");
      const bool is_time = unit.find(" since ") != std::string::npos;
      if (!unit.empty() && !is_time && !is_known_unit(unit)) return false;
    }
    return true;
  }

  void end_definition() {
    if (!defining) return;
    defining = false;
    const std::string flight = trajectory();
    const std::optional<int> trajectory_id = describe_by_cf(description, flight, *file);
    if (!has_known_units()) put_text(global, "Conventions", conventions(false));
    file->end_definition();
    if (trajectory_id) file->variable(*trajectory_id).putVar(flight.c_str());
    for (const GeospatialRange& each : geospatial_ranges) {
      const std::string& name = description.*each.variable;
      if (input && file->has(name) && input->has(name) && input->variable(name).is_series)
        copied_ranges.emplace(name, Range());
    }
  }

  std::string text_of(const std::string& name) const { return file->text_attribute(global, name); }

  // A global attribute: the value of the input, otherwise the given default.
  void supply(const std::string& name, const std::string& otherwise) const {
    if (text_of(name).empty()) put_text(global, name, otherwise);
  }

  void check_new(const std::string& name) const {
    if (!defining)
      file->refuse(Error::Code::usage, ": {} is defined after the first value was written", name);
    if (name.empty() || name.find('/') != std::string::npos)
      file->refuse(Error::Code::usage, ": \"{}\" is not a valid variable name; choose another name", name);
    if (file->has(name))
      file->refuse(Error::Code::usage, ": the file already has a variable {}; give the new variable a suffix",
                   name);
  }

  std::size_t define(const OutputVariable& variable) {
    check_new(variable.name);
    if (variable.rate < 1)
      file->refuse(Error::Code::usage, ": {} cannot have {} samples a record", variable.name, variable.rate);
    Written entry;
    entry.name = variable.name;
    entry.rate = variable.rate;
    entry.flags = !variable.flags.empty();
    entry.id = file->add_variable(variable.name, entry.flags ? NC_INT : NC_FLOAT,
                                  file->dimensions_of_series(static_cast<std::size_t>(variable.rate)));
    if (entry.flags) {
      std::vector<int> masks;
      for (const Flag& flag : variable.flags) masks.push_back(flag.mask);
      file->variable(entry.id).putAtt("flag_masks", netCDF::ncInt, masks.size(), masks.data());
      put_text(entry.id, "flag_meanings",
               fmt::format("{}", fmt::join(names_of(variable.flags, &Flag::meaning), " ")));
    } else {
      file->variable(entry.id).putAtt("_FillValue", netCDF::ncFloat, fill);
      put_text(entry.id, "units", standard_unit(variable.units));
    }
    put_text(entry.id, "long_name", variable.long_name);
    put_text(entry.id, "standard_name", variable.standard_name);
    put_text(entry.id, "Category", variable.category);
    put_text(entry.id, "DataQuality", variable.data_quality);
    put_text(entry.id, "coverage_content_type", entry.flags ? "qualityInformation" : "physicalMeasurement");
    if (!variable.dependencies.empty())
      put_text(entry.id, "Dependencies",
               fmt::format("{} {}", variable.dependencies.size(), fmt::join(variable.dependencies, " ")));
    put_text(entry.id, "ancillary_variables",
             fmt::format("{}", fmt::join(variable.ancillary_variables, " ")));
    for (const auto& [name, text] : variable.attributes) put_text(entry.id, name, text);
    if (!entry.flags) put_range(entry.id, "actual_range", reserved);
    written.push_back(entry);
    return written.size() - 1;
  }

  bool can_copy(const std::string& name) const {
    if (!input || !input->has(name)) return false;
    return copies ? copies->can_copy(name) : input->variable(name).is_series;
  }

  void copy(const std::string& name) {
    if (!input) file->refuse(Error::Code::usage, ": {} cannot be copied, because there is no input", name);
    input->variable(name);  // or an error that lists the existing variables
    if (name == input->time_variable() && name != "time_offset") return;
    check_new(name);
    if (copies) return copies->define(name);
    const VariableInfo& info = input->variable(name);
    if (!info.is_series)
      file->refuse(Error::Code::variable, ": {} is not a time series, so it cannot be copied; omit it", name);
    const int variable =
        file->add_variable(name, NC_DOUBLE, file->dimensions_of_series(static_cast<std::size_t>(info.rate)));
    file->variable(variable).putAtt("_FillValue", netCDF::ncDouble, fill);
    put_text(variable, "units", standard_unit(info.units));
    put_text(variable, "long_name", info.long_name.empty() ? name : info.long_name);
    series.emplace_back(name, variable);
  }

  // The data

  void write_time_stamps(RecordBlock block, const double* times) {
    end_definition();
    if (block.count == 0) return;
    std::vector<double> since_midnight(times, times + block.count);
    for (std::size_t i = 0; i < block.count; ++i) {
      const double before = i == 0 ? end_time : times[i - 1];
      if (!std::isfinite(times[i]) || (time_records + i > 0 && times[i] <= before))
        file->refuse(Error::Code::time, ": the time of record {} does not follow the previous time",
                     block.first + i);
      since_midnight[i] -= midnight;
      if (whole_seconds && since_midnight[i] != std::floor(since_midnight[i]))
        file->refuse(Error::Code::time, ": the time of record {} is not a whole second", block.first + i);
    }
    file->variable(time_variable).putVar({block.first}, {block.count}, since_midnight.data());
    if (time_records == 0) start_time = times[0];
    end_time = times[block.count - 1];
    time_records += block.count;
  }

  void write(std::size_t number, RecordBlock block, const double* values) {
    end_definition();
    Written& variable = written.at(number);
    const auto rate = static_cast<std::size_t>(variable.rate);
    const std::size_t total = block.count * rate;
    if (total == 0) return;
    if (variable.flags) {
      for (std::size_t i = 0; i < total; ++i)
        if (!(std::abs(values[i]) <= std::numeric_limits<int>::max()) || values[i] != std::floor(values[i]))
          file->refuse(Error::Code::variable, ": {} is not a whole number at record {}", variable.name,
                       block.first + i / rate);
      file->variable(variable.id).putVar({block.first, 0}, {block.count, rate}, values);
    } else {
      constexpr double max_float = std::numeric_limits<float>::max();
      floats.resize(total);
      Range range = variable.range;  // a local one stays in registers
      for (std::size_t i = 0; i < total; ++i) {
        const bool present = std::abs(values[i]) <= max_float;  // false for NaN
        floats[i] = present ? static_cast<float>(values[i]) : fill;
        if (present) range.include(static_cast<double>(floats[i]));
      }
      variable.range = range;
      file->variable(variable.id).putVar({block.first, 0}, {block.count, rate}, floats.data());
    }
    variable.records += block.count;
  }

  void copy_records(RecordBlock block) {
    end_definition();
    copied_times.resize(block.count);
    input->read_time_stamps(block, copied_times.data());
    write_time_stamps(block, copied_times.data());
    if (copies) copies->copy_records(block);
    for (const auto& [name, variable] : series) {
      read_series(name, block);
      std::replace_if(
          copied_values.begin(), copied_values.end(), [](double value) { return std::isnan(value); }, fill);
      file->variable(variable).putVar({block.first, 0}, {block.count, copied_values.size() / block.count},
                                      copied_values.data());
    }
    for (auto& [name, range] : copied_ranges) {
      read_series(name, block);
      for (const double value : copied_values)
        if (!std::isnan(value)) range.include(value);
    }
  }

  void read_series(const std::string& name, RecordBlock block) {
    copied_values.resize(block.count * static_cast<std::size_t>(input->variable(name).rate));
    input->read(name, block, UnitConversion(), copied_values.data());
  }

  // The end

  Range range_of(const std::string& name) const {
    for (const Written& variable : written)
      if (variable.name == name && !variable.range.empty()) return variable.range;
    const auto copied = copied_ranges.find(name);
    return copied == copied_ranges.end() ? Range() : copied->second;
  }

  // A variable has both bounds in one attribute, the whole file in two. The attributes of an empty range are
  // removed.
  void put_range(int variable, const std::string& name, const Range& range) const {
    const float bounds[] = {static_cast<float>(range.minimum), static_cast<float>(range.maximum)};
    const auto put = [&](const std::string& attribute, std::size_t count, const float* numbers) {
      if (range.empty()) return file->drop(variable, attribute);
      file->variable(variable).putAtt(attribute, netCDF::ncFloat, count, numbers);
    };
    if (variable != global) return put(name, 2, bounds);
    put(name + "_min", 1, &bounds[0]);
    put(name + "_max", 1, &bounds[1]);
  }

  void finish() {
    if (input) {
      for (RecordBlock block : blocks_of(input->records() - time_records, input->file().records_at_once())) {
        block.first = time_records;
        copy_records(block);
      }
      if (copies) copies->copy_constants();
    }
    if (time_records == 0) file->refuse(Error::Code::samples, " would have no records; nothing was written");
    for (const Written& variable : written)
      if (variable.records != time_records)
        file->refuse(Error::Code::usage, ": {} was written for {} of {} records", variable.name,
                     variable.records, time_records);

    put_text(global, "time_coverage_start", utc_text(start_time, iso_8601));
    put_text(global, "time_coverage_end", utc_text(end_time, iso_8601));
    put_text(global, "TimeInterval", utc_text(start_time, "%H:%M:%S-") + utc_text(end_time, "%H:%M:%S"));
    put_text(global, "time_coverage_duration", duration_text(end_time - start_time));
    for (const Written& variable : written)
      if (!variable.flags) put_range(variable.id, "actual_range", variable.range);
    for (const GeospatialRange& each : geospatial_ranges)
      if (const std::string& name = description.*each.variable; !name.empty())
        put_range(global, each.range, range_of(name));
    file->close();
    replacement.commit();
  }
};

FlightWriter::FlightWriter(const std::filesystem::path& output, const Flight& input,
                           const FileDescription& description)
    : implementation_(std::make_unique<Implementation>(output, &input, start_of(input), description)) {}

FlightWriter::FlightWriter(const std::filesystem::path& output, const NewFlight& flight,
                           const FileDescription& description)
    : implementation_(std::make_unique<Implementation>(output, nullptr, flight, description)) {}

FlightWriter::~FlightWriter() = default;

std::size_t FlightWriter::define(const OutputVariable& variable) {
  return implementation_->file->attempt(writing, [&] { return implementation_->define(variable); });
}

void FlightWriter::copy(const std::string& name) {
  implementation_->file->attempt(writing, [&] { implementation_->copy(name); });
}

bool FlightWriter::can_copy(const std::string& name) const {
  return implementation_->file->attempt(writing, [&] { return implementation_->can_copy(name); });
}

bool FlightWriter::has(const std::string& name) const { return implementation_->file->has(name); }

void FlightWriter::write_time_stamps(RecordBlock block, const double* times) {
  implementation_->file->attempt(writing, [&] { implementation_->write_time_stamps(block, times); });
}

void FlightWriter::write(std::size_t variable, RecordBlock block, const double* values) {
  implementation_->file->attempt(writing, [&] { implementation_->write(variable, block, values); });
}

void FlightWriter::copy_records(RecordBlock block) {
  implementation_->file->attempt(writing, [&] { implementation_->copy_records(block); });
}

void FlightWriter::finish() {
  implementation_->file->attempt(writing, [&] { implementation_->finish(); });
}

}  // namespace pcor
