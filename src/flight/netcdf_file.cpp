#include "flight/netcdf_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <strings.h>
#include <unistd.h>
#include <pcor/base/shell_quote.hpp>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <new>
#include <numeric>
#include <string_view>

#include "base/quoting.hpp"
#include "flight/current_input.hpp"

using netCDF::NcDim;
using netCDF::NcVar;
using netCDF::exceptions::NcException;

namespace pcor::internal {
namespace {

constexpr std::string_view classic = "CDF", hdf5 = "\211HDF";  // how files begin
constexpr std::size_t chunk_cache_bytes = 1 << 18, chunk_cache_slots = 1009;
constexpr std::size_t page = std::size_t{4} << 10;
// For record sizes between these limits only the pages with the requested values are read. Longer records
// contain mostly other values, and reading all of them would take longer.
constexpr std::size_t large_record = std::size_t{32} << 10, max_brought = std::size_t{1} << 20;

struct NumberType {
  int type = NC_NAT;
  double span = 0;  // number of distinct integers; 0 for other types
  bool is_signed = false;
  // Default fill value of the library for values that were not written; for bytes it is a normal value.
  std::optional<double> fill;
};

constexpr NumberType number_types[] = {{NC_BYTE, 0x1p8, true, {}},
                                       {NC_UBYTE, 0x1p8, false, {}},
                                       {NC_SHORT, 0x1p16, true, NC_FILL_SHORT},
                                       {NC_USHORT, 0x1p16, false, NC_FILL_USHORT},
                                       {NC_INT, 0x1p32, true, NC_FILL_INT},
                                       {NC_UINT, 0x1p32, false, NC_FILL_UINT},
                                       {NC_INT64, 0x1p64, true, static_cast<double>(NC_FILL_INT64)},
                                       {NC_UINT64, 0x1p64, false, static_cast<double>(NC_FILL_UINT64)},
                                       {NC_FLOAT, 0, false, static_cast<double>(NC_FILL_FLOAT)},
                                       {NC_DOUBLE, 0, false, NC_FILL_DOUBLE}};

NumberType number_type(int type) {
  for (const NumberType& each : number_types)
    if (each.type == type) return each;
  return {};
}

/// An attribute that states a range, or one end of it.
struct RangeAttribute {
  const char* name;
  std::size_t first, count;
};

constexpr RangeAttribute range_attributes[] = {
    {"valid_range", 0, 2}, {"valid_min", 0, 1}, {"valid_max", 1, 1}};

bool is_text(const Attribute& attribute) { return attribute.type == NC_CHAR || attribute.type == NC_STRING; }

/// Parses a list of numbers: "1, 2", "c(1, 2)" of R, "[1 2]", "1 to 2". Empty if the text is not a list of
/// numbers.
std::vector<double> numbers_of(std::string text) {
  const std::size_t open = text.find_first_of("([");
  if (open != std::string::npos && (open == 0 || text.substr(0, open) == "c")) text.erase(0, open + 1);
  text.erase(text.find_last_not_of(" )]") + 1);
  if (const std::size_t to = text.find(" to "); to != std::string::npos) text.replace(to, 4, " ");
  std::vector<double> numbers;
  for (const char* at = text.c_str(); *at != '\0';) {
    if (std::strchr(", \t", *at) != nullptr) {
      ++at;
      continue;
    }
    char* end = nullptr;
    const double number = std::strtod(at, &end);
    if (end == at) return {};
    numbers.push_back(number);
    at = *end == 'f' ? end + 1 : end;
  }
  return numbers;
}

bool is_float(int type) { return type == NC_FLOAT || type == NC_DOUBLE; }

bool begins_with(const std::filesystem::path& path, std::string_view bytes) {
  std::string start(bytes.size(), '\0');
  std::ifstream(path, std::ios::binary).read(start.data(), static_cast<std::streamsize>(start.size()));
  return start == bytes;
}

bool is_brought(std::size_t record_bytes) {
  return record_bytes > large_record && record_bytes <= max_brought;
}

void require_memory(const NcException& error) {
  if (error.errorCode() == NC_ENOMEM || error.errorCode() == ENOMEM) throw std::bad_alloc();
}

}  // namespace

std::size_t elements(const std::vector<std::size_t>& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

std::size_t records_in_buffer(std::size_t record_bytes) {
  // A block does not begin where a buffer does.
  constexpr std::size_t minimum = 16, max_bytes = classic_buffer_bytes / 4 * 3;
  return std::clamp(max_bytes / std::max<std::size_t>(record_bytes, 1), minimum, records_per_block);
}

std::size_t NetcdfFile::records_at_once() const {
  return layout_.record_bytes > 0 ? records_in_buffer(layout_.record_bytes) : records_per_block;
}

std::string netcdf_reason(const NcException& error) {
  const std::string text = error.what();
  return text.substr(0, text.find('\n'));  // the place in netcdf-cxx4 follows
}

bool is_netcdf(const std::filesystem::path& path) {
  return begins_with(path, classic) || begins_with(path, hdf5);
}

NetcdfFile::NetcdfFile(std::filesystem::path path) : path_(std::move(path)), state_(path_) {
  const auto refuse_damage = [this](const std::string& why) {
    refuse(Error::Code::file, " is truncated or damaged{}; fetch it again from its source", why);
  };
  if (begins_with(path_, classic)) {
    const auto layout = layout_of_classic(path_);
    if (!layout) refuse_damage(": its header cannot be read");
    const auto size = std::filesystem::file_size(path_);
    if (size < layout->size)
      refuse_damage(fmt::format(": its header promises {} bytes and it has {}", layout->size, size));
    layout_ = *layout;
  }
  try {
    file_.open(path_, is_brought(layout_.record_bytes)      ? page
                      : layout_.record_bytes > large_record ? large_record
                                                            : classic_buffer_bytes);
  } catch (const NcException& error) {
    require_memory(error);
    const std::string reason = netcdf_reason(error);
    if (error.errorCode() < 0) refuse_damage(" (" + reason + ")");
    refuse(Error::Code::file, " cannot be read: {}; check its disk and the limits of the system", reason);
  }
  kind_ = attempt("cannot determine its format", [&] { return file_.kind(); });
}

NetcdfFile::~NetcdfFile() {
  std::optional<CurrentInput> current;  // the library may crash where the system does not close the file
  if (state_ != FileState()) current.emplace(path_);
  file_.close_quietly();
}

void NetcdfFile::fail(const NcException& error, std::string_view doing) const {
  require_memory(error);
  throw error_of(error.errorCode(), fmt::format("{}: {}: {}", path_.string(), doing, netcdf_reason(error)));
}

Error NetcdfFile::error_of(int status, const std::string& message) const {
  require_unchanged();
  const char* const first =
      status == NC_EATTMETA
          ? "remove attributes that are neither text nor a list of numbers, for example a table, or "
      : status == NC_ENOFILTER ? "install the HDF5 plug-in for its compression filter, or rewrite the file "
                                 "on a machine that has the plug-in with nccopy -F none, or "
                               : "";
  return {Error::Code::file, fmt::format("{}; {}fetch the file again from its source", message, first)};
}

void NetcdfFile::require_unchanged() const { state_.require(path_); }

void NetcdfFile::fit_chunk_cache(int number) const {
  if (!is_hdf5() || !fitted_.insert(number).second) return;
  attempt("cannot read how its variables are stored", [&] {
    NcVar::ChunkMode mode{};
    std::vector<std::size_t> chunk;
    variable(number).getChunkingParameters(mode, chunk);
    if (mode != NcVar::nc_CHUNKED || chunk.empty()) return;
    const std::size_t bytes = elements(chunk) * netCDF::NcType(type_of(number)).getSize();
    variable(number).setChunkCache(std::max(2 * bytes, chunk_cache_bytes), chunk_cache_slots, 1);
  });
}

std::string NetcdfFile::allowed(const std::string& name, const char* what) const {
  if (name.size() <= NC_MAX_NAME) return name;
  refuse(Error::Code::file,
         ": {} is called {}, and netCDF allows {} bytes for a name; give it a shorter one, as h5py can, or "
         "fetch the file again from its source",
         what, quote(name), NC_MAX_NAME);
}

int NetcdfFile::variable_count() const {
  return attempt("cannot count its variables", [&] { return file_.getVarCount(); });
}

std::optional<int> NetcdfFile::find_variable(const std::string& name) const {
  return attempt("cannot look for the variable " + name,
                 [&] { return internal::find_variable(file_, name); });
}

std::string NetcdfFile::variable_name(int number) const {
  return allowed(attempt("cannot read a variable's name", [&] { return to_string(variable(number)); }),
                 "a variable");
}

std::vector<int> NetcdfFile::dimensions_of(int number) const {
  std::vector<int> dimensions;
  attempt("cannot read a variable's dimensions", [&] {
    for (const NcDim& each : variable(number).getDims()) dimensions.push_back(each.getId());
  });
  return dimensions;
}

std::string NetcdfFile::dimension_name(int number) const {
  return allowed(attempt("cannot read a dimension's name", [&] { return to_string(dimension(number)); }),
                 "a dimension");
}

std::size_t NetcdfFile::dimension_length(int number) const {
  return attempt("cannot read a dimension's length", [&] { return dimension(number).getSize(); });
}

int NetcdfFile::type_of(int number) const {
  return attempt("cannot read a variable's type", [&] { return internal::type_of(variable(number)); });
}

std::vector<std::string> NetcdfFile::attribute_names(int number) const {
  auto names = attempt("cannot read the names of attributes",
                       [&] { return internal::attribute_names(variable(number)); });
  for (const std::string& name : names) allowed(name, "an attribute");
  return names;
}

std::optional<Attribute> NetcdfFile::find_attribute(int number, const std::string& name) const {
  return attempt("cannot read its attributes, among them perhaps " + name,
                 [&] { return internal::find_attribute(variable(number), name); });
}

std::string NetcdfFile::text_attribute(int number, const std::string& name) const {
  const auto attribute = find_attribute(number, name);
  if (!attribute || attribute->length == 0 || attribute->type > NC_STRING) return {};
  if (!is_text(*attribute)) {
    const std::vector<double> numbers = number_attribute(number, name);
    if (attribute->type != NC_FLOAT) return fmt::format("{}", fmt::join(numbers, ", "));
    return fmt::format("{}", fmt::join(std::vector<float>(numbers.begin(), numbers.end()), ", "));
  }
  std::string text(attribute->type == NC_CHAR ? attribute->length : 0, '\0');
  std::vector<char*> strings(attribute->type == NC_STRING ? attribute->length : 0);
  void* const values = strings.empty() ? static_cast<void*>(text.data()) : strings.data();
  attempt("cannot read the attribute " + name, [&] { attribute->getValues(values); });
  for (const char* each : strings) text += (text.empty() ? "" : ", ") + std::string(each ? each : "");
  if (!strings.empty()) variable(number).freeString(strings.size(), strings.data());
  text.erase(text.find_last_not_of(std::string_view("\0 \t\r\n", 5)) + 1);  // all if there is only such
  return text;
}

std::vector<double> NetcdfFile::number_attribute(int variable, const std::string& name) const {
  const auto attribute = find_attribute(variable, name);
  if (!attribute || attribute->type > NC_STRING) return {};
  if (is_text(*attribute)) return numbers_of(text_attribute(variable, name));
  std::vector<double> numbers(attribute->length);
  attempt("cannot read the attribute " + name, [&] { attribute->getValues(numbers.data()); });
  return numbers;
}

bool NetcdfFile::is_numeric(int variable) const { return number_type(type_of(variable)).type != NC_NAT; }

bool NetcdfFile::is_unsigned(int variable) const {
  const NumberType type = number_type(type_of(variable));
  if (!type.is_signed) return type.span > 0;
  if (!find_attribute(variable, "_Unsigned")) return false;
  const std::string said = text_attribute(variable, "_Unsigned");
  const auto is = [&said](const char* word) { return strcasecmp(said.c_str(), word) == 0; };
  if (!is("true") && !is("false")) {
    refuse_attribute(variable, "_Unsigned", fmt::format("is {}, expected true or false", quote(said)));
  }
  return is("true");
}

void NetcdfFile::make_unsigned(int variable, double* numbers, std::size_t count) const {
  const NumberType type = number_type(type_of(variable));
  if (!type.is_signed || !is_unsigned(variable)) return;
  for (std::size_t i = 0; i < count; ++i) numbers[i] += numbers[i] < 0 ? type.span : 0;
}

double NetcdfFile::max_number(int variable) const {
  const double span = number_type(type_of(variable)).span;
  if (span == 0) return std::numeric_limits<double>::max();
  return (is_unsigned(variable) ? span : span / 2) - 1;
}

std::vector<double> NetcdfFile::stored_numbers(int variable, const std::string& name) const {
  std::vector<double> numbers = number_attribute(variable, name);
  if (type_of(variable) == NC_FLOAT)
    for (double& number : numbers) number = static_cast<double>(static_cast<float>(number));
  make_unsigned(variable, numbers.data(), numbers.size());
  return numbers;
}

std::vector<double> NetcdfFile::missing_values(int variable) const {
  const int type = type_of(variable);
  std::vector<double> values;
  for (const char* name : {"_FillValue", "missing_value", "MissingValue"})
    for (const double value : stored_numbers(variable, name))
      if (!std::isnan(value)) values.push_back(value);
  if (values.empty() && is_float(type)) values.push_back(-32767);
  if (const auto fill = number_type(type).fill) {
    values.push_back(*fill);
    make_unsigned(variable, &values.back(), 1);
  }
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

void NetcdfFile::refuse_attribute(int variable, const std::string& name, const std::string& why) const {
  const bool is_global = variable == whole_file;
  const std::string of = is_global ? "global" : variable_name(variable);
  refuse(Error::Code::variable,
         ": the attribute {} of {} {}; correct it, or remove it with ncatted -a {} {} (with h5py if ncatted "
         "cannot write the file)",
         name, is_global ? "the file" : of, why,
         shell_quote(fmt::format("{},{},d,,", name, ncatted_name(of))), shell_path(path_.string()));
}

std::string NetcdfFile::ignored_range(int variable) const {
  for (const RangeAttribute& each : range_attributes) {
    const auto attribute = find_attribute(variable, each.name);
    if (attribute && is_text(*attribute) && stored_numbers(variable, each.name).size() != each.count)
      return fmt::format("{} = {}", each.name, quote(text_attribute(variable, each.name)));
  }
  return {};
}

std::array<double, 2> NetcdfFile::valid_range(int variable) const {
  const int type = type_of(variable);
  const bool is_packed =
      !is_float(type) &&
      !(text_attribute(variable, "scale_factor") + text_attribute(variable, "add_offset")).empty();
  std::array<double, 2> range{-infinity, infinity};
  for (const RangeAttribute& each : range_attributes) {
    const auto attribute = find_attribute(variable, each.name);
    if (!attribute) continue;
    const std::vector<double> numbers = stored_numbers(variable, each.name);
    if (numbers.size() != each.count && is_text(*attribute)) continue;  // see `ignored_range`
    if (numbers.size() != each.count)
      refuse_attribute(variable, each.name, each.count == 1 ? "is not one number" : "is not two numbers");
    if (is_packed && is_float(attribute->type))
      refuse_attribute(variable, each.name,
                       "has another type than the packed integers, so it may refer to the packed or to the "
                       "unpacked values");
    std::copy(numbers.begin(), numbers.end(), range.begin() + each.first);
    if (!(range[0] <= range[1])) refuse_attribute(variable, each.name, "leaves no value");
  }
  return range;
}

void NetcdfFile::bring_into_memory(RecordBlock records) const {
  const std::size_t end = records.first + records.count;
  if (!is_brought(layout_.record_bytes) || records.count == 0 || end <= brought_) return;
  const std::size_t first = std::max(records.first, brought_);
  brought_ = end;
  const int file = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  posix_fadvise(file, static_cast<off_t>(layout_.records_begin + first * layout_.record_bytes),
                static_cast<off_t>((end - first) * layout_.record_bytes), POSIX_FADV_WILLNEED);
  ::close(file);
}

void NetcdfFile::read(int number, RecordBlock records, double* out) const {
  fit_chunk_cache(number);
  std::vector<std::size_t> start, count;
  attempt("cannot read " + variable_name(number), [&] {
    for (const NcDim& each : variable(number).getDims()) {
      const bool is_first = start.empty();
      if (is_first && each.isUnlimited()) bring_into_memory(records);
      start.push_back(is_first ? records.first : 0);
      count.push_back(is_first ? records.count : each.getSize());
    }
    variable(number).getVar(start, count, out);
  });
  require_unchanged();
  make_unsigned(number, out, elements(count));
}

}  // namespace pcor::internal
