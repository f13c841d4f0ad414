#include <fmt/format.h>
#include <fmt/ranges.h>
#include <strings.h>
#include <pcor/base/error.hpp>
#include <pcor/base/shell_quote.hpp>
#include <pcor/base/suggest.hpp>
#include <pcor/base/utc.hpp>
#include <pcor/flight/flight.hpp>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <set>
#include <unordered_map>

#include "base/phrasing.hpp"
#include "flight/block_cache.hpp"
#include "flight/current_input.hpp"
#include "flight/flight_file.hpp"
#include "flight/missing_variable.hpp"
#include "flight/record_means.hpp"
#include "flight/registration.hpp"
#include "flight/status_flags.hpp"
#include "flight/time_source.hpp"
#include "numerics/missing.hpp"

namespace pcor {

using namespace internal;

namespace {

constexpr double day = 86400;
// Writers mark missing values with 1e30, 1e35, 1e300 or infinity. No measured value is that large in any
// unit.
constexpr double no_value = 1e30;
constexpr double max_samples_a_second = 1000, rounding = 1e-3;  // s, for times of records
constexpr std::size_t min_doubted = 200'000;                    // accepted in a file of any size
constexpr std::size_t min_samples_doubted = 2'000'000;          // likewise
constexpr std::size_t max_records = 100'000'000;                // more than a day has thousandths of a second

/// Size in bytes; the maximum of the type if it is unknown.
std::uintmax_t size_of(const std::filesystem::path& path) {
  std::error_code code;
  return std::filesystem::file_size(path, code);
}

/// A variable of the file, and what turns its stored numbers into values.
struct Variable {
  int id = 0;
  VariableInfo info;
  std::vector<double> missing_values;  // numbers of the stored type
  std::array<double, 2> valid_range;   // numbers of the stored type
  UnitConversion unpacking;            // scale_factor and add_offset
  std::vector<StatusFlags> flags;      // flags of unusable samples
  std::optional<Error> error;          // error for a variable whose numbers are ambiguous
};

std::optional<int> rate_of_dimension(const FlightFile& file, int dimension) {
  const std::string name = file.dimension_name(dimension);
  if (name.rfind("sps", 0) != 0 || name.find_first_not_of("0123456789", 3) != std::string::npos)
    return std::nullopt;
  const std::size_t length = file.dimension_length(dimension);
  if (length > std::numeric_limits<int>::max() ||
      (name.size() > 3 && name.substr(3) != std::to_string(length)))
    return std::nullopt;
  return static_cast<int>(length);
}

Variable read_variable(const FlightFile& file, int id, int time_dimension) {
  Variable variable;
  variable.id = id;
  VariableInfo& info = variable.info;
  info.name = file.variable_name(id);
  info.units = file.text_attribute(id, "units");
  info.long_name = file.text_attribute(id, "long_name");
  for (const std::string& name : file.attribute_names(id))
    info.attributes.emplace_back(name, file.text_attribute(id, name));
  const std::vector<double> modulus = file.number_attribute(id, "modulus_range");
  if (modulus.size() == 2 && modulus[0] < modulus[1]) info.modulus_range = {modulus[0], modulus[1]};

  const std::vector<int> dimensions = file.dimensions_of(id);
  if (!file.is_numeric(id) || dimensions.empty() || dimensions[0] != time_dimension || dimensions.size() > 2)
    return variable;
  if (dimensions.size() == 1) {
    info.rate = 1;
  } else {
    const auto rate = rate_of_dimension(file, dimensions[1]);
    if (!rate || *rate < 1) return variable;
    info.rate = *rate;
  }
  info.is_series = true;
  try {
    variable.missing_values = file.missing_values(id);
    variable.valid_range = file.valid_range(id);
    info.ignored_range = file.ignored_range(id);
    variable.unpacking = file.unpacking_of(id);
    variable.flags = StatusFlags::of(file, id);
    for (const StatusFlags& flags : variable.flags)
      info.flags.push_back(file.variable_name(flags.variable()));
  } catch (const Error& error) {
    variable.error = error;
  }
  return variable;
}

/// The first of some global attributes that has a text; empty without such an attribute.
std::string first_attribute(const Flight& flight, std::initializer_list<const char*> names) {
  for (const char* const name : names) {
    if (std::string text = flight.attribute(name); !text.empty()) return text;
  }
  return {};
}

}  // namespace

std::vector<RecordBlock> blocks_of(std::size_t records, std::size_t size) {
  std::vector<RecordBlock> blocks;
  for (std::size_t first = 0; first < records; first += size)
    blocks.push_back({first, std::min(size, records - first)});
  return blocks;
}

struct Flight::Implementation {
  std::unique_ptr<FlightFile> file;
  TimestampAlignment timestamp_alignment;
  TimeSource source;
  std::size_t records;
  std::uintmax_t bytes;
  TimeAxis axis;
  std::vector<double> times;  // all records, since reading them reads the whole of a classic file
  std::vector<std::string> names;
  std::vector<std::optional<Variable>> variables;  // requested names, in the order of `names`
  std::unordered_map<std::string, std::size_t> index;
  std::unordered_map<int, RecordMeans> means;               // key: id of the variable
  std::unordered_map<std::string, std::string> attributes;  // attributes of the file, by requested name
  BlockCache cache;
  std::vector<double> scratch;
  std::vector<double> flags;

  Implementation(std::unique_ptr<FlightFile> opened, TimestampAlignment stamp)
      : file(std::move(opened)),
        timestamp_alignment(stamp),
        source(find_time(*file)),
        records(file->dimension_length(source.dimension)),
        bytes(size_of(file->path())) {
    if (records > min_doubted && records > bytes)
      file->refuse(
          Error::Code::file,
          " has {} records in {} bytes, more than one record per byte, so most records are empty; cut "
          "it with {}",
          records, bytes, cut_to("FIRST,LAST"));
    if (records > max_records)
      file->refuse(Error::Code::file, " has {} records, and a flight has at most {}; cut it with {}", records,
                   max_records, cut_to("FIRST,LAST"));
    // In files of HDF5 every question how many there are looks at each.
    const int count = file->variable_count();
    for (int id = 0; id < count; ++id) {
      names.push_back(file->variable_name(id));
      if (!index.emplace(names.back(), names.size() - 1).second)
        file->refuse(Error::Code::file,
                     " has two variables {}, which is ambiguous; fetch the file again from its source",
                     names.back());
    }
    variables.resize(names.size());
    scan_time();
  }

  // A file has hundreds of variables with ten attributes each; few of them are needed.
  Variable& variable(std::size_t number) {
    if (!variables[number]) {
      const CurrentInput current(file->path());
      variables[number] = read_variable(*file, static_cast<int>(number), source.dimension);
    }
    return *variables[number];
  }

  std::string path() const { return file->path().string(); }

  /// Command that shortens the file to some records.
  std::string cut_to(const std::string& range) const {
    return "ncks -d " + shell_quote(file->dimension_name(source.dimension) + "," + range);
  }

  Variable& find(const std::string& name) {
    const auto found = index.find(name);
    if (found != index.end()) return variable(found->second);
    const std::vector<std::string> similar = suggest(name, names);
    file->refuse(Error::Code::variable, ": {} is not in this file; it has {}", name,
                 similar.empty()
                     ? fmt::format("{} others, see ncdump -h {}", names.size(), shell_path(path()))
                     : fmt::format("{}", fmt::join(similar, ", ")));
  }

  // The names of rates that can be brought to the requested one, as this file has them: "1, 5 or 25".
  std::string rates_that_fit(int requested) {
    std::set<int> rates;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const int rate = variable(i).info.rate;
      if (rate > 0 && (rate % requested == 0 || requested % rate == 0)) rates.insert(rate);
    }
    std::vector<std::string> texts;
    for (const int rate : rates) texts.push_back(std::to_string(rate));
    return join_list(texts, "or");
  }

  Variable& find_series(const std::string& name) {
    Variable& variable = find(name);
    const VariableInfo& info = variable.info;
    if (!info.is_series) {
      std::string dimensions;
      for (const int each : file->dimensions_of(variable.id)) {
        dimensions += (dimensions.empty() ? "" : ", ") + file->dimension_name(each);
        const bool is_rate = file->dimension_name(each).rfind("sps", 0) == 0;
        if (is_rate && !rate_of_dimension(*file, each))
          dimensions += fmt::format(" = {}", file->dimension_length(each));
      }
      file->refuse(
          Error::Code::variable,
          ": {}({}) is not a time series of numbers over (Time) or (Time, spsN); choose another variable",
          name, dimensions);
    }
    const std::size_t samples = records * static_cast<std::size_t>(info.rate);
    if (samples > min_samples_doubted && samples > bytes)
      file->refuse(
          Error::Code::variable,
          ": {} has {} samples in a file of {} bytes (expected: at most one sample a byte); cut it with {}",
          info.name, samples, bytes, cut_to("FIRST,LAST"));
    const double rate = info.rate / axis.step;
    if (rate > max_samples_a_second * (1 + rounding))
      file->refuse(
          Error::Code::variable,
          ": {} has {:.6g} samples a second, {} in each record of {:.6g} s; at most {:g} a second are "
          "supported; average the variable, or correct the times of the records",
          info.name, rate, info.rate, axis.step, max_samples_a_second);
    return variable;
  }

  void require_records(const std::string& name, RecordBlock block) const {
    if (block.first > records || block.count > records - block.first)
      file->refuse(Error::Code::usage, ": cannot read {} at records {} to {}, there are {}", name,
                   block.first, block.first + block.count, records);
  }

  RejectedCounts read(Variable& variable, RecordBlock block, double* values) {
    if (variable.error) throw *variable.error;
    require_records(variable.info.name, block);
    if (block.count == 0) return {};
    const std::size_t count = block.count * static_cast<std::size_t>(variable.info.rate);
    read_numbers(variable.id, block, count, values);
    for (const double marker : variable.missing_values)
      for (std::size_t i = 0; i < count; ++i) values[i] = values[i] == marker ? nan : values[i];
    RejectedCounts excluded;
    const auto [minimum, maximum] = variable.valid_range;
    for (std::size_t i = 0; i < count; ++i) {
      const bool is_invalid = values[i] < minimum || values[i] > maximum;
      const bool is_enormous = std::abs(values[i]) >= no_value;
      excluded.invalid += is_invalid && !is_enormous ? 1 : 0;
      excluded.enormous += is_enormous ? 1 : 0;
      values[i] = is_invalid || is_enormous ? nan : variable.unpacking(values[i]);
    }
    for (const StatusFlags& unusable : variable.flags) {
      const std::size_t samples_of_flag = unusable.is_of_record() ? count / block.count : 1;
      flags.resize(count / samples_of_flag);
      read_numbers(unusable.variable(), block, flags.size(), flags.data());
      for (std::size_t i = 0; i < count; ++i) {
        if (unusable.unusable(flags[i / samples_of_flag])) values[i] = nan;
      }
    }
    return excluded;
  }

  const RecordMeans* kept_means(const Variable& variable) const {
    const auto found = means.find(variable.id);
    return found == means.end() ? nullptr : &found->second;
  }

  /// Adds the means of a block to those that are kept. False, and nothing is kept, if it cannot be read.
  bool add_means(const std::string& name, RecordBlock block) {
    if (index.count(name) == 0) return false;
    const int id = static_cast<int>(index.at(name));
    try {
      Variable& series = find_series(name);
      scratch.resize(block.count * static_cast<std::size_t>(series.info.rate));
      means[id].add(scratch, block.count, series.info.modulus_range, read(series, block, scratch.data()));
      return true;
    } catch (const Error&) {  // thrown again if the series is needed
      means.erase(id);
      return false;
    }
  }

  void read_numbers(int id, RecordBlock block, std::size_t count, double* out) {
    cache.read(id, block, count, out, [&](double* numbers) {
      const CurrentInput current(file->path());
      file->read(id, block, numbers);
    });
  }

  /// Times without the days after the records at which seconds of the day restart.
  void read_time(RecordBlock block, double* out) {
    read(variable(static_cast<std::size_t>(source.variable)), block, out);
    for (std::size_t i = 0; i < block.count; ++i) {
      if (std::isnan(out[i]))
        file->refuse(Error::Code::time, ": the time of record {} is missing; remove that record",
                     block.first + i);
      out[i] = out[i] * source.scale + source.offset;
      if (!is_of_aviation(out[i]))
        file->refuse(Error::Code::time, ": the time of record {} is {}; remove that record", block.first + i,
                     utc_text(out[i]));
    }
  }

  void scan_time() {
    std::size_t backward = 0, repeated = 0, first_bad = 0;
    double bad = 0, bad_before = 0, before = 0;
    std::vector<double> steps;
    times.resize(records);
    for (const RecordBlock block : blocks_of(records)) {
      read_time(block, times.data() + block.first);
      if (block.first == 0) {
        axis.first = times.front();
        for (std::size_t i = 1; i < block.count; ++i)
          if (times[i] > times[i - 1]) steps.push_back(times[i] - times[i - 1]);
        if (!steps.empty()) {  // the median; for an even count the lower of the two middle values
          const auto middle = steps.begin() + static_cast<std::ptrdiff_t>((steps.size() - 1) / 2);
          std::nth_element(steps.begin(), middle, steps.end());
          axis.step = *middle;
        }
      }
      for (std::size_t record = block.first; record < block.first + block.count; ++record) {
        for (std::size_t i = 0; i < axis.midnight_wraps.size(); ++i) times[record] += day;
        if (record > 0 && begins_again_at_midnight(source, before, times[record])) {
          axis.midnight_wraps.push_back(record);
          times[record] += day;
        }
        const double now = times[record];
        if (record > 0 && now <= before) {
          if (backward + repeated == 0) first_bad = record, bad = now, bad_before = before;
          ++(now < before ? backward : repeated);
        }
        if (record > 0 && now - before > 1.5 * axis.step) ++axis.gap_count;
        axis.whole_seconds = axis.whole_seconds && now == std::floor(now);
        before = now;
      }
    }
    axis.last = before;
    if (backward + repeated > 0)
      file->refuse(
          Error::Code::time,
          ": time {} at record {} ({} after {}), {} backward and {} repeated steps in all; cut the file "
          "there with {}",
          bad < bad_before ? "runs backwards" : "repeats", first_bad, utc_text(bad), utc_text(bad_before),
          backward, repeated, cut_to(fmt::format("0,{}", first_bad - 1)));
  }
};

Flight::Flight(const std::filesystem::path& path, TimestampAlignment timestamp_alignment)
    : Flight(open_flight_file(path), timestamp_alignment) {}
Flight::Flight(std::unique_ptr<FlightFile> file, TimestampAlignment timestamp_alignment) {
  const CurrentInput current(file->path());
  implementation_ = std::make_unique<Implementation>(std::move(file), timestamp_alignment);
}
Flight::Flight(Flight&&) noexcept = default;
Flight& Flight::operator=(Flight&&) noexcept = default;
Flight::~Flight() = default;

const FlightFile& Flight::file() const { return *implementation_->file; }
const std::filesystem::path& Flight::path() const { return implementation_->file->path(); }
std::size_t Flight::records() const { return implementation_->records; }
std::vector<RecordBlock> Flight::blocks() const { return blocks_of(records(), file().records_at_once()); }
const TimeAxis& Flight::time() const { return implementation_->axis; }
TimestampAlignment Flight::timestamp_alignment() const { return implementation_->timestamp_alignment; }

const std::string& Flight::time_variable() const {
  return implementation_->names[static_cast<std::size_t>(implementation_->source.variable)];
}

std::string Flight::attribute(const std::string& name) const {
  const auto known = implementation_->attributes.find(name);
  if (known != implementation_->attributes.end()) return known->second;
  std::string text = file().text_attribute(FlightFile::whole_file, name);
  if (!text.empty()) return text;
  for (const std::string& other : file().attribute_names(FlightFile::whole_file)) {
    if (strcasecmp(other.c_str(), name.c_str()) != 0) continue;
    text = file().text_attribute(FlightFile::whole_file, other);
    if (!text.empty()) break;
  }
  return implementation_->attributes.emplace(name, std::move(text)).first->second;
}

std::string Flight::aircraft() const {
  std::string stated = first_attribute(*this, {"platform", "aircraft", "tail_number", "platform_name"});
  return stated.empty() ? registration_in(first_attribute(*this, {"source", "title"})) : stated;
}

std::string Flight::project() const { return first_attribute(*this, {"project", "ProjectName", "campaign"}); }

std::string Flight::flight_number() const {
  return first_attribute(*this, {"FlightNumber", "flight_number"});
}

const std::vector<std::string>& Flight::variables() const { return implementation_->names; }

bool Flight::has(const std::string& name) const { return implementation_->index.count(name) > 0; }

const VariableInfo& Flight::variable(const std::string& name) const {
  return implementation_->find(name).info;
}

UnitConversion Flight::conversion(const std::string& name, const std::string& requested,
                                  const std::string& role, const std::string& stated) const {
  if (!has(name) && !role.empty()) {
    std::vector<VariableInfo> all;
    for (const std::string& each : variables()) all.push_back(variable(each));
    refuse_missing(file(), all, name, requested, role);
  }
  const std::string& recorded_unit = variable(name).units;
  if (stated.empty()) return UnitConversion::between(recorded_unit, requested, {name, path().string(), role});
  if (!is_convertible(stated, requested))
    file().refuse(
        Error::Code::unit,
        ": the unit \"{}\" that the model states for {} ({}) is not known or does not convert to {}; "
        "correct unit.{} in the [units] of the model",
        stated, name, role, requested, role);
  return UnitConversion::between(stated, requested, {name, path().string(), role});
}

void Flight::require_values(const std::string& name) const {
  Variable& variable = implementation_->find_series(name);
  if (const auto* kept = implementation_->kept_means(variable); kept && has_value(kept->values)) return;
  std::vector<double>& values = implementation_->scratch;
  for (const RecordBlock block : blocks()) {
    values.resize(block.count * static_cast<std::size_t>(variable.info.rate));
    implementation_->read(variable, block, values.data());
    if (has_value(values)) return;
  }
  file().refuse(Error::Code::variable,
                ": {} has no value, all {} records are missing; choose another variable", name, records());
}

RejectedCounts Flight::read(const std::string& name, RecordBlock block, const UnitConversion& conversion,
                            double* out) const {
  Variable& variable = implementation_->find_series(name);
  RejectedCounts excluded = implementation_->read(variable, block, out);
  const std::size_t count = block.count * static_cast<std::size_t>(variable.info.rate);
  for (std::size_t i = 0; i < count; ++i) {
    const double converted = conversion(out[i]);
    excluded.impossible += std::isnan(converted) && !std::isnan(out[i]) ? 1 : 0;
    out[i] = converted;
  }
  return excluded;
}

RejectedCounts Flight::read_at_rate(int rate, const std::string& name, RecordBlock block,
                                    const UnitConversion& conversion, double* out) const {
  Variable& variable = implementation_->find_series(name);
  const int recorded_rate = variable.info.rate;
  if (rate == recorded_rate) return read(name, block, conversion, out);
  if (rate < 1) file().refuse(Error::Code::usage, ": {} samples a record are impossible", rate);
  if (rate % recorded_rate != 0 && recorded_rate % rate != 0)
    file().refuse(Error::Code::samples,
                  ": {} has {} samples a record, which cannot be converted to {}; choose a variable with {} "
                  "samples a record",
                  name, recorded_rate, rate, implementation_->rates_that_fit(rate));
  std::vector<double>& values = implementation_->scratch;
  values.resize(block.count * static_cast<std::size_t>(recorded_rate));
  RejectedCounts excluded = implementation_->read(variable, block, values.data());
  for (double& value : values) {
    if (std::isnan(value) || !std::isnan(conversion(value))) continue;
    value = nan;
    ++excluded.impossible;
  }
  const auto requested = block.count * static_cast<std::size_t>(rate);
  if (rate > recorded_rate) {
    const auto held = static_cast<std::size_t>(rate / recorded_rate);
    for (std::size_t i = 0; i < requested; ++i) out[i] = conversion(values[i / held]);
    return excluded;
  }
  average(values, requested, variable.info.modulus_range, out);
  std::transform(out, out + requested, out, conversion);
  return excluded;
}

void Flight::keep_means(std::set<std::string> names) const {
  implementation_->means.clear();
  for (const RecordBlock block : blocks()) {
    for (auto name = names.begin(); name != names.end();)
      name = implementation_->add_means(*name, block) ? std::next(name) : names.erase(name);
  }
}

RejectedCounts Flight::read_at_rate(int rate, const std::string& name, const UnitConversion& conversion,
                                    double* out) const {
  const RecordMeans* const kept = implementation_->kept_means(implementation_->find_series(name));
  if (rate == 1 && kept != nullptr && kept->are_within(conversion)) {
    std::transform(kept->values.begin(), kept->values.end(), out, conversion);
    return kept->excluded;
  }
  RejectedCounts excluded;
  for (const RecordBlock block : blocks_of(records()))
    excluded +=
        read_at_rate(rate, name, block, conversion, out + block.first * static_cast<std::size_t>(rate));
  return excluded;
}

void Flight::read_time_stamps(RecordBlock block, double* out) const {
  implementation_->require_records(time_variable(), block);
  std::copy_n(implementation_->times.begin() + static_cast<std::ptrdiff_t>(block.first), block.count, out);
}

void Flight::read_sample_times(RecordBlock block, int rate, double* out) const {
  if (rate < 1) file().refuse(Error::Code::usage, ": {} samples a record are impossible", rate);
  std::vector<double>& stamps = implementation_->scratch;
  stamps.resize(block.count);
  read_time_stamps(block, stamps.data());
  const double step = time().step;
  const double begin = timestamp_alignment() == TimestampAlignment::begin ? 0 : -step / 2;
  for (std::size_t i = 0; i < block.count; ++i)
    for (int k = 0; k < rate; ++k) *out++ = stamps[i] + begin + (k + 0.5) / rate * step;
}

}  // namespace pcor
