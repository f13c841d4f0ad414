#include <fmt/format.h>
#include <netcdf.h>
#include <pcor/flight/flight_writer.hpp>
#include <pcor/units/units.hpp>
#include <pcor/words/error.hpp>
#include <pcor/words/suggest.hpp>
#include <pcor/words/utc.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>
#include <limits>
#include <map>
#include <optional>

#include <pcor/words/replacement_file.hpp>
#include "flight/netcdf_file.hpp"

namespace pcor {

using namespace internal;

namespace {

constexpr float fill = -32767;
constexpr const char* iso_8601 = "%Y-%m-%dT%H:%M:%SZ";
constexpr std::size_t copied_bytes_at_once = std::size_t{4} << 20;

int creation_mode(FileKind kind) {
  switch (kind) {
    case FileKind::classic:
      return 0;
    case FileKind::offset64:
      return NC_64BIT_OFFSET;
    case FileKind::cdf5:
      return NC_64BIT_DATA;
    case FileKind::netcdf4_classic:
      return NC_NETCDF4 | NC_CLASSIC_MODEL;
    case FileKind::netcdf4:
      break;
  }
  return NC_NETCDF4;
}

struct Range {
  double least = std::numeric_limits<double>::infinity();
  double greatest = -std::numeric_limits<double>::infinity();

  void include(double value) {
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  bool empty() const { return least > greatest; }
};

/// A variable that the program computes.
struct Written {
  std::string name;
  int id = 0;
  int rate = 1;
  bool flags = false;
  std::size_t records = 0;  // written so far
  Range range;
};

/// A variable of the input that is taken over.
struct Copied {
  int from = 0, to = 0;
  int type = NC_NAT;
  bool over_time = false;
  std::vector<std::size_t> shape;  // of all of it, or of one record
};

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::size_t elements(const std::vector<std::size_t>& shape) {
  std::size_t product = 1;
  for (const std::size_t length : shape) product *= length;
  return product;
}

}  // namespace

struct FlightWriter::Implementation {
  std::filesystem::path shown;
  const Flight* input = nullptr;
  std::optional<NetcdfFile> source;  // the input's file, for what is copied as it is
  FileDescription description;
  FileKind kind;
  double midnight;
  bool whole_seconds;
  ReplacementFile replacement;
  std::optional<NetcdfFile> file;

  int time_dimension = 0, time_variable = 0, source_time_dimension = -1;
  bool defining = true;
  std::map<std::string, int> dimensions;  // of the output, but Time
  std::vector<Written> written;
  std::vector<Copied> copied;
  std::vector<float> floats;
  std::vector<int> integers;
  std::size_t time_records = 0;
  double first_time = 0, last_time = 0;
  std::vector<std::pair<int, std::string>> unknown;  // attributes that turned out to have no value

  Implementation(std::filesystem::path output, const Flight* flight, const NewFlight& start,
                 FileDescription what)
      : shown(std::move(output)),
        input(flight),
        description(std::move(what)),
        kind(start.kind),
        midnight(midnight_before(start.first_time)),
        whole_seconds(start.whole_seconds),
        replacement(shown) {
    std::error_code code;
    if (input && std::filesystem::equivalent(shown, input->path(), code))
      throw Error(shown.string() + " is the input itself; choose another output");
    if (input) source.emplace(NetcdfFile::open(input->path()));
    file.emplace(NetcdfFile::create(replacement.path(), shown, creation_mode(kind)));
    int before = 0;
    check(nc_set_fill(id(), NC_NOFILL, &before));  // every value is written
    define_time(start.first_time);
    describe_file();
  }

  ~Implementation() { file.reset(); }

  int id() const { return file->id(); }
  bool is_hdf5() const { return kind == FileKind::netcdf4 || kind == FileKind::netcdf4_classic; }

  void check(int status) const { file->check(status, "cannot be written"); }

  void put_text(int variable, const std::string& name, const std::string& text) const {
    if (!text.empty()) check(nc_put_att_text(id(), variable, name.c_str(), text.size(), text.data()));
  }

  // The definition of the file

  void define_time(double first) {
    check(nc_def_dim(id(), "Time", NC_UNLIMITED, &time_dimension));
    check(nc_def_var(id(), "Time", whole_seconds ? NC_INT : NC_DOUBLE, 1, &time_dimension, &time_variable));
    store_in_chunks(time_variable, 1, sizeof(double));
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
      for (const std::string& name : source->attribute_names(NC_GLOBAL))
        copy_attribute(NC_GLOBAL, NC_GLOBAL, name, NC_NAT);
      const std::string earlier = input->attribute("history");
      if (!earlier.empty()) history += "\n" + earlier;
      source_time_dimension = source->dimensions_of(*source->find_variable(input->time_variable())).front();
      supply("platform", input->aircraft());
      supply("project", input->project());
    }
    std::string title = joined(
        {input ? input->project() : "", input ? input->flight_number() : "", input ? input->aircraft() : ""});
    title.erase(0, title.find_first_not_of(' '));
    supply("title", title.empty() ? "Research flight" : title, description.title);
    supply("summary", text_of("title"), description.summary);
    supply("source", "airborne observations");
    supply("platform_type", "aircraft");
    put_text(NC_GLOBAL, "Conventions", "NCAR-RAF/nimbus-2.1 CF-1.8 ACDD-1.3");
    put_text(NC_GLOBAL, "ConventionsURL", "https://www.eol.ucar.edu/raf/Software/netCDF.html");
    put_text(NC_GLOBAL, "standard_name_vocabulary", "CF Standard Name Table v93");
    put_text(NC_GLOBAL, "history", history);
    put_text(NC_GLOBAL, "date_created", utc_text(now, iso_8601));
    put_text(NC_GLOBAL, "time_coordinate", "Time");
    for (const auto& [name, text] : description.attributes) put_text(NC_GLOBAL, name, text);
    // Filled in at the end, with as many letters.
    put_text(NC_GLOBAL, "time_coverage_start", utc_text(0, iso_8601));
    put_text(NC_GLOBAL, "time_coverage_end", utc_text(0, iso_8601));
    supply("FlightDate", utc_text(midnight, "%m/%d/%Y"));
    put_text(NC_GLOBAL, "TimeInterval", "00:00:00-00:00:00");
    const struct {
      const std::string& variable;
      const char *coordinate, *range;
    } places[] = {{description.latitude, "latitude_coordinate", "geospatial_lat"},
                  {description.longitude, "longitude_coordinate", "geospatial_lon"},
                  {description.altitude, "zaxis_coordinate", "geospatial_vertical"}};
    for (const auto& place : places) {
      if (place.variable.empty()) continue;
      put_text(NC_GLOBAL, place.coordinate, place.variable);
      reserve_range(NC_GLOBAL, std::string(place.range) + "_min", 1);
      reserve_range(NC_GLOBAL, std::string(place.range) + "_max", 1);
    }
    if (!description.altitude.empty()) {
      put_text(NC_GLOBAL, "geospatial_vertical_positive", "up");
      put_text(NC_GLOBAL, "geospatial_vertical_units", "m");
    }
  }

  std::string text_of(const std::string& name) const { return file->text_attribute(NC_GLOBAL, name); }

  // A global attribute as stated, else as the input has it, else as given.
  void supply(const std::string& name, const std::string& otherwise, const std::string& stated = "") const {
    if (!stated.empty())
      put_text(NC_GLOBAL, name, stated);
    else if (text_of(name).empty())
      put_text(NC_GLOBAL, name, otherwise);
  }

  void reserve_range(int variable, const std::string& name, std::size_t count) const {
    const float bounds[] = {fill, fill};
    check(nc_put_att_float(id(), variable, name.c_str(), NC_FLOAT, count, bounds));
  }

  // A thousand records a chunk, and no more of them in memory than a block needs.
  void store_in_chunks(int variable, std::size_t elements_in_record, std::size_t element_bytes) const {
    if (!is_hdf5()) return;
    constexpr std::size_t most_elements = 1 << 16, most_records = records_per_block / 4;
    std::vector<std::size_t> chunk;
    for (const int dimension : file->dimensions_of(variable))
      chunk.push_back(dimension == time_dimension
                          ? std::clamp<std::size_t>(most_elements / elements_in_record, 1, most_records)
                          : file->dimension_length(dimension));
    check(nc_def_var_chunking(id(), variable, NC_CHUNKED, chunk.data()));
    constexpr std::size_t slots = 101;
    check(nc_set_var_chunk_cache(id(), variable, 2 * elements(chunk) * element_bytes, slots, 1));
  }

  int dimension(const std::string& name, std::size_t length) {
    const auto known = dimensions.find(name);
    if (known != dimensions.end()) {
      if (file->dimension_length(known->second) == length) return known->second;
      throw Error(fmt::format("{}: the dimension {} has two lengths, {} and {}; leave one variable out",
                              shown.string(), name, length, file->dimension_length(known->second)));
    }
    int number = 0;
    check(nc_def_dim(id(), name.c_str(), length, &number));
    dimensions.emplace(name, number);
    return number;
  }

  bool has(const std::string& name) const { return file->find_variable(name).has_value(); }

  void check_new(const std::string& name) const {
    if (!defining)
      throw Error(shown.string() + ": " + name + " is defined after the first value was written");
    if (name.empty() || name.find('/') != std::string::npos)
      throw Error(shown.string() + ": a variable cannot be called \"" + name + "\"; choose another name");
    if (has(name))
      throw Error(shown.string() + ": there is a variable " + name + " already; give the new one a suffix");
  }

  std::size_t define(const OutputVariable& variable) {
    check_new(variable.name);
    if (variable.rate < 1)
      throw Error(fmt::format("{}: {} cannot have {} samples a record", shown.string(), variable.name,
                              variable.rate));
    Written entry;
    entry.name = variable.name;
    entry.rate = variable.rate;
    entry.flags = !variable.flags.empty();
    const auto rate = static_cast<std::size_t>(variable.rate);
    const int shape[] = {time_dimension, rate > 1 ? dimension(fmt::format("sps{}", rate), rate) : 0};
    check(nc_def_var(id(), variable.name.c_str(), entry.flags ? NC_INT : NC_FLOAT, rate > 1 ? 2 : 1, shape,
                     &entry.id));
    store_in_chunks(entry.id, rate, sizeof(float));
    if (!entry.flags) check(nc_put_att_float(id(), entry.id, "_FillValue", NC_FLOAT, 1, &fill));
    if (entry.flags)
      put_flags(entry.id, variable.flags);
    else
      put_text(entry.id, "units", standard_unit(variable.units));
    put_text(entry.id, "long_name", variable.long_name);
    put_text(entry.id, "standard_name", variable.standard_name);
    put_text(entry.id, "Category", variable.category);
    put_text(entry.id, "DataQuality", variable.data_quality);
    if (!variable.dependencies.empty())
      put_text(entry.id, "Dependencies",
               fmt::format("{} {}", variable.dependencies.size(), joined(variable.dependencies)));
    put_text(entry.id, "ancillary_variables", joined(variable.ancillary_variables));
    for (const auto& [name, text] : variable.attributes) put_text(entry.id, name, text);
    if (!entry.flags) reserve_range(entry.id, "actual_range", 2);
    written.push_back(entry);
    return written.size() - 1;
  }

  void put_flags(int variable, const std::vector<Flag>& flags) const {
    std::vector<int> masks;
    std::vector<std::string> meanings;
    for (const Flag& flag : flags) {
      masks.push_back(flag.mask);
      meanings.push_back(flag.meaning);
    }
    check(nc_put_att_int(id(), variable, "flag_masks", NC_INT, masks.size(), masks.data()));
    put_text(variable, "flag_meanings", joined(meanings));
  }

  void copy_attribute(int from, int to, const std::string& name, int type_of_variable) const {
    nc_type type = NC_NAT;
    check(nc_inq_atttype(source->id(), from, name.c_str(), &type));
    if (type > NC_STRING) return;  // of the file's own making
    if (type == NC_CHAR) {
      const std::string text = source->text_attribute(from, name);
      return put_text(to, name, name == "units" ? standard_unit(text) : text);
    }
    // A marker of missing values must have the type of the variable, which old writers did not know.
    const bool marker = name == "_FillValue" || name == "missing_value";
    if (marker && type != type_of_variable && type < NC_STRING) {
      const std::vector<double> values = source->number_attribute(from, name);
      check(nc_put_att_double(id(), to, name.c_str(), type_of_variable, values.size(), values.data()));
      return;
    }
    check(nc_copy_att(source->id(), from, name.c_str(), id(), to));
  }

  bool can_copy(const std::string& name) const {
    if (!input || !input->has(name)) return false;
    const int variable = *source->find_variable(name);
    if (source->type_of(variable) > NC_STRING) return false;
    const std::vector<int> shape = source->dimensions_of(variable);
    for (std::size_t i = 0; i < shape.size(); ++i) {
      if (shape[i] == source_time_dimension) {
        if (i > 0) return false;
        continue;
      }
      const auto known = dimensions.find(source->dimension_name(shape[i]));
      if (known != dimensions.end() &&
          file->dimension_length(known->second) != source->dimension_length(shape[i]))
        return false;
    }
    return true;
  }

  void copy(const std::string& name) {
    if (!input) throw Error(shown.string() + ": " + name + " cannot be copied, there is no input");
    input->variable(name);  // or an error that says what there is
    if (name == input->time_variable() && name != "time_offset") return;
    check_new(name);
    Copied entry;
    entry.from = *source->find_variable(name);
    entry.type = source->type_of(entry.from);
    source->fit_chunk_cache(entry.from);
    if (entry.type > NC_STRING)
      throw Error(shown.string() + ": " + name +
                  " has a type of its own making, which cannot be copied; leave it out");
    std::vector<int> shape;
    for (const int each : source->dimensions_of(entry.from)) {
      const bool time = each == source_time_dimension;
      const std::size_t length = source->dimension_length(each);
      if (time && !shape.empty())
        throw Error(shown.string() + ": Time is not the first dimension of " + name + "; leave it out");
      shape.push_back(time ? time_dimension : dimension(source->dimension_name(each), length));
      entry.over_time = entry.over_time || time;
      if (!time) entry.shape.push_back(length);
    }
    check(
        nc_def_var(id(), name.c_str(), entry.type, static_cast<int>(shape.size()), shape.data(), &entry.to));
    if (entry.over_time) {
      store_in_chunks(entry.to, elements(entry.shape), element_bytes(entry.type));
      copy_compression(entry);
    }
    for (const std::string& attribute : source->attribute_names(entry.from))
      copy_attribute(entry.from, entry.to, attribute, entry.type);
    if (input->variable(name).long_name.empty() &&
        source->text_attribute(entry.from, "standard_name").empty())
      put_text(entry.to, "long_name", name);
    copied.push_back(entry);
  }

  std::size_t element_bytes(int type) const {
    std::size_t bytes = 0;
    check(nc_inq_type(source->id(), type, nullptr, &bytes));
    return bytes;
  }

  void copy_compression(const Copied& entry) const {
    int shuffle = 0, deflate = 0, level = 0;
    if (!is_hdf5() || nc_inq_var_deflate(source->id(), entry.from, &shuffle, &deflate, &level) != NC_NOERR)
      return;
    if (deflate) check(nc_def_var_deflate(id(), entry.to, shuffle, deflate, level));
  }

  void end_definition() {
    if (!defining) return;
    defining = false;
    check(nc_enddef(id()));
  }

  // The data

  void write_time_stamps(RecordBlock block, const double* times) {
    end_definition();
    if (block.count == 0) return;
    std::vector<double> since_midnight(times, times + block.count);
    for (std::size_t i = 0; i < block.count; ++i) {
      const double before = i == 0 ? last_time : times[i - 1];
      if (!std::isfinite(times[i]) || (time_records + i > 0 && times[i] <= before))
        throw Error(fmt::format("{}: the time of record {} does not follow the one before", shown.string(),
                                block.first + i));
      since_midnight[i] -= midnight;
      if (whole_seconds && since_midnight[i] != std::floor(since_midnight[i]))
        throw Error(
            fmt::format("{}: the time of record {} is not a whole second", shown.string(), block.first + i));
    }
    check(nc_put_vara_double(id(), time_variable, &block.first, &block.count, since_midnight.data()));
    if (time_records == 0) first_time = times[0];
    last_time = times[block.count - 1];
    time_records += block.count;
  }

  void write(std::size_t number, RecordBlock block, const double* values) {
    end_definition();
    Written& variable = written.at(number);
    const std::size_t start[] = {block.first, 0};
    const std::size_t count[] = {block.count, static_cast<std::size_t>(variable.rate)};
    const std::size_t total = count[0] * count[1];
    if (total == 0) return;
    if (variable.flags) {
      integers.resize(total);
      for (std::size_t i = 0; i < total; ++i) {
        if (!(std::abs(values[i]) <= std::numeric_limits<int>::max()) || values[i] != std::floor(values[i]))
          throw Error(fmt::format("{}: {} is not a whole number at record {}", shown.string(), variable.name,
                                  block.first + i / count[1]));
        integers[i] = static_cast<int>(values[i]);
      }
      check(nc_put_vara_int(id(), variable.id, start, count, integers.data()));
    } else {
      constexpr double most = std::numeric_limits<float>::max();
      floats.resize(total);
      for (std::size_t i = 0; i < total; ++i) {
        const bool present = std::abs(values[i]) <= most;  // false for NaN
        floats[i] = present ? static_cast<float>(values[i]) : fill;
        if (present) variable.range.include(static_cast<double>(floats[i]));
      }
      check(nc_put_vara_float(id(), variable.id, start, count, floats.data()));
    }
    variable.records += block.count;
  }

  // Where in a copied variable the records of a block are.
  struct Slab {
    std::vector<std::size_t> start, count;

    Slab(const Copied& variable, RecordBlock block) : start(variable.shape.size(), 0), count(variable.shape) {
      if (!variable.over_time) return;
      start.insert(start.begin(), block.first);
      count.insert(count.begin(), block.count);
    }
  };

  std::size_t record_bytes(const Copied& variable) const {
    return elements(variable.shape) * element_bytes(variable.type);
  }

  void read_copied(const Copied& variable, RecordBlock block, char* buffer) const {
    const Slab slab(variable, block);
    source->check(nc_get_vara(source->id(), variable.from, slab.start.data(), slab.count.data(), buffer),
                  "cannot read " + source->variable_name(variable.from));
  }

  void write_copied(const Copied& variable, RecordBlock block, char* buffer) const {
    const Slab slab(variable, block);
    const int status = nc_put_vara(id(), variable.to, slab.start.data(), slab.count.data(), buffer);
    if (variable.type == NC_STRING) {
      std::vector<char*> strings(elements(slab.count));
      std::memcpy(strings.data(), buffer, strings.size() * sizeof(char*));
      nc_free_string(strings.size(), strings.data());
    }
    check(status);
  }

  // A classic file with an unlimited Time has the records one after the other.
  bool source_has_records() const {
    int unlimited = -1;
    check(nc_inq_unlimdim(source->id(), &unlimited));
    const bool hdf5 = input->kind() == FileKind::netcdf4 || input->kind() == FileKind::netcdf4_classic;
    return !hdf5 && unlimited == source_time_dimension;
  }

  void copy_data() {
    std::vector<const Copied*> series;
    std::vector<char> buffer;
    for (const Copied& variable : copied) {
      if (record_bytes(variable) == 0) continue;
      if (variable.over_time) {
        series.push_back(&variable);
        continue;
      }
      buffer.resize(record_bytes(variable));
      read_copied(variable, {}, buffer.data());
      write_copied(variable, {}, buffer.data());
    }
    if (source_has_records() || !is_hdf5()) return copy_records(series);
    for (const Copied* variable : series)
      for (const RecordBlock block : blocks_of(input->records())) {
        buffer.resize(block.count * record_bytes(*variable));
        read_copied(*variable, block, buffer.data());
        write_copied(*variable, block, buffer.data());
      }
  }

  // All variables together, block by block, and within a block by as many records as the library keeps in
  // memory.
  void copy_records(const std::vector<const Copied*>& series) {
    std::size_t bytes = 1;
    for (const Copied* variable : series) bytes += record_bytes(*variable);
    const std::size_t at_once = std::clamp<std::size_t>(copied_bytes_at_once / bytes, 1, records_per_block);
    const std::size_t in_buffer = std::clamp<std::size_t>(classic_buffer_bytes * 3 / 4 / bytes, 1, at_once);
    std::vector<std::vector<char>> buffers(series.size());
    for (const RecordBlock block : blocks_of(input->records(), at_once)) {
      for (std::size_t i = 0; i < series.size(); ++i)
        buffers[i].resize(block.count * record_bytes(*series[i]));
      const auto each = [&](bool by_records, auto&& move) {
        for (const RecordBlock part : blocks_of(block.count, by_records ? in_buffer : block.count))
          for (std::size_t i = 0; i < series.size(); ++i)
            move(*series[i], RecordBlock{block.first + part.first, part.count},
                 buffers[i].data() + part.first * record_bytes(*series[i]));
      };
      each(source_has_records(), [this](const Copied& variable, RecordBlock part, char* values) {
        read_copied(variable, part, values);
      });
      each(!is_hdf5(), [this](const Copied& variable, RecordBlock part, char* values) {
        write_copied(variable, part, values);
      });
    }
  }

  // The end

  std::optional<Range> range_of(const std::string& name) const {
    for (const Written& variable : written)
      if (variable.name == name && !variable.range.empty()) return variable.range;
    if (!input || !has(name) || !input->has(name) || !input->variable(name).is_series) return std::nullopt;
    const auto rate = static_cast<std::size_t>(input->variable(name).rate);
    Range range;
    std::vector<double> values;
    for (const RecordBlock block : blocks_of(input->records())) {
      values.resize(block.count * rate);
      input->read(name, block, UnitConversion(), values.data());
      for (const double value : values)
        if (!std::isnan(value)) range.include(value);
    }
    return range.empty() ? std::nullopt : std::optional(range);
  }

  // An attribute that could not be known is taken out again.
  void put_range(int variable, const std::string& name, std::optional<Range> range) {
    const bool both = variable != NC_GLOBAL;
    if (!range) {
      unknown.emplace_back(variable, both ? name : name + "_min");
      if (!both) unknown.emplace_back(variable, name + "_max");
      return;
    }
    const float bounds[] = {static_cast<float>(range->least), static_cast<float>(range->greatest)};
    if (both) return check(nc_put_att_float(id(), variable, name.c_str(), NC_FLOAT, 2, bounds));
    check(nc_put_att_float(id(), variable, (name + "_min").c_str(), NC_FLOAT, 1, &bounds[0]));
    check(nc_put_att_float(id(), variable, (name + "_max").c_str(), NC_FLOAT, 1, &bounds[1]));
  }

  void finish() {
    if (input) {
      std::vector<double> times;
      for (const RecordBlock block : blocks_of(input->records())) {
        times.resize(block.count);
        input->read_time_stamps(block, times.data());
        write_time_stamps(block, times.data());
      }
      copy_data();
    }
    if (time_records == 0) throw Error(shown.string() + " would have no records; nothing was written");
    for (const Written& variable : written)
      if (variable.records != time_records)
        throw Error(fmt::format("{}: {} was written for {} of {} records", shown.string(), variable.name,
                                variable.records, time_records));

    put_text(NC_GLOBAL, "time_coverage_start", utc_text(first_time, iso_8601));
    put_text(NC_GLOBAL, "time_coverage_end", utc_text(last_time, iso_8601));
    put_text(NC_GLOBAL, "TimeInterval", utc_text(first_time, "%H:%M:%S-") + utc_text(last_time, "%H:%M:%S"));
    for (const Written& variable : written)
      if (!variable.flags)
        put_range(variable.id, "actual_range",
                  variable.range.empty() ? std::nullopt : std::optional(variable.range));
    if (!description.latitude.empty()) put_range(NC_GLOBAL, "geospatial_lat", range_of(description.latitude));
    if (!description.longitude.empty())
      put_range(NC_GLOBAL, "geospatial_lon", range_of(description.longitude));
    if (!description.altitude.empty())
      put_range(NC_GLOBAL, "geospatial_vertical", range_of(description.altitude));
    if (!unknown.empty()) {
      check(nc_redef(id()));
      for (const auto& [variable, name] : unknown) check(nc_del_att(id(), variable, name.c_str()));
      check(nc_enddef(id()));
    }
    file->close();
    replacement.commit();
  }
};

namespace {

NewFlight start_of(const Flight& input) {
  return {input.time().first, input.time().whole_seconds, input.kind()};
}

}  // namespace

FlightWriter::FlightWriter(std::filesystem::path output, const Flight& input,
                           const FileDescription& description)
    : implementation_(
          std::make_unique<Implementation>(std::move(output), &input, start_of(input), description)) {}

FlightWriter::FlightWriter(std::filesystem::path output, const NewFlight& flight,
                           const FileDescription& description)
    : implementation_(std::make_unique<Implementation>(std::move(output), nullptr, flight, description)) {}

FlightWriter::FlightWriter(FlightWriter&&) noexcept = default;
FlightWriter& FlightWriter::operator=(FlightWriter&&) noexcept = default;
FlightWriter::~FlightWriter() = default;

std::size_t FlightWriter::define(const OutputVariable& variable) { return implementation_->define(variable); }
void FlightWriter::copy(const std::string& name) { implementation_->copy(name); }
bool FlightWriter::can_copy(const std::string& name) const { return implementation_->can_copy(name); }
bool FlightWriter::has(const std::string& name) const { return implementation_->has(name); }

void FlightWriter::write_time_stamps(RecordBlock block, const double* times) {
  implementation_->write_time_stamps(block, times);
}

void FlightWriter::write(std::size_t variable, RecordBlock block, const double* values) {
  implementation_->write(variable, block, values);
}

void FlightWriter::finish() { implementation_->finish(); }

}  // namespace pcor
