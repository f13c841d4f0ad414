#include "flight/netcdf_file.hpp"

#include <fmt/format.h>
#include <netcdf.h>
#include <strings.h>
#include <pcor/words/error.hpp>
#include <pcor/words/shell_word.hpp>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <new>
#include <string_view>
#include <utility>

#include "flight/classic_netcdf.hpp"
#include "flight/file_in_hand.hpp"
#include "words/quoting.hpp"

namespace pcor::internal {
namespace {

constexpr int closed = -1;
constexpr std::size_t chunk_cache_bytes = 1 << 18, chunk_cache_slots = 1009;
constexpr std::size_t page = std::size_t{4} << 10;
// Of records between these only the pages are moved that hold what is wanted. Longer ones hold so much else
// that bringing all of it into memory would take longer.
constexpr std::size_t large_record = std::size_t{32} << 10, longest_brought = std::size_t{1} << 20;

enum class Content { classic, hdf5, other };

/// What the library writes where nothing was; for bytes it is a value like any other.
std::optional<double> default_fill(int type) {
  switch (type) {
    case NC_SHORT:
      return NC_FILL_SHORT;
    case NC_USHORT:
      return NC_FILL_USHORT;
    case NC_INT:
      return NC_FILL_INT;
    case NC_UINT:
      return NC_FILL_UINT;
    case NC_INT64:
      return static_cast<double>(NC_FILL_INT64);
    case NC_UINT64:
      return static_cast<double>(NC_FILL_UINT64);
    case NC_FLOAT:
      return static_cast<double>(NC_FILL_FLOAT);
    case NC_DOUBLE:
      return NC_FILL_DOUBLE;
    default:
      return std::nullopt;
  }
}

/// How many numbers an integer type has; nothing for other types.
std::optional<double> span_of(int type) {
  switch (type) {
    case NC_BYTE:
    case NC_UBYTE:
      return 0x1p8;
    case NC_SHORT:
    case NC_USHORT:
      return 0x1p16;
    case NC_INT:
    case NC_UINT:
      return 0x1p32;
    case NC_INT64:
    case NC_UINT64:
      return 0x1p64;
    default:
      return std::nullopt;
  }
}

bool is_signed(int type) { return type == NC_BYTE || type == NC_SHORT || type == NC_INT || type == NC_INT64; }

Content content_of(const std::filesystem::path& path) {
  char start[4] = {};
  std::ifstream(path, std::ios::binary).read(start, sizeof start);
  const std::string_view text(start, sizeof start);
  if (text.substr(0, 3) == "CDF") return Content::classic;
  if (text == "\211HDF") return Content::hdf5;
  return Content::other;
}

bool is_brought(std::size_t record_bytes) {
  return record_bytes > large_record && record_bytes <= longest_brought;
}

std::string without_trailing_blanks(std::string text) {
  const std::size_t end = text.find_last_not_of(std::string_view("\0 \t\r\n", 5));
  text.resize(end == std::string::npos ? 0 : end + 1);
  return text;
}

ClassicLayout checked_layout_of_classic(const std::filesystem::path& path) {
  const auto layout = layout_of_classic(path);
  if (!layout)
    throw Error(Error::Code::file,
                path.string() +
                    " is truncated or damaged: its header cannot be read; fetch it again from its source");
  const auto size = std::filesystem::file_size(path);
  if (size < layout->size)
    throw Error(
        Error::Code::file,
        fmt::format(
            "{} is truncated or damaged: its header promises {} bytes and it has {}; fetch it again from its "
            "source",
            path.string(), layout->size, size));
  return *layout;
}

/// Room for any name, as the library copies all of one: HDF5 keeps the length of an attribute's in two bytes,
/// and those of variables and dimensions the library has cut off itself. Names in a classic file are looked
/// at before (`layout_of_classic`).
constexpr std::size_t room_for_name = std::size_t{1} << 16;

const char* advice_to_reader(int status) {
  switch (status) {
    case NC_EATTMETA:
      return "; take away what is neither text nor a list of numbers, as a table, or fetch the file again "
             "from its source";
    case NC_ENOFILTER:
      return "; install the plug-in of HDF5 for the filter that it is compressed with, or on a machine that "
             "has it write the file anew with nccopy -F none, or fetch the file again from its source";
    default:
      return "; fetch the file again from its source";
  }
}

/// Whether a word that files hold, or a user gives, is no name that netCDF allows.
bool can_name_nothing(int status) { return status == NC_EBADNAME || status == NC_EMAXNAME; }

}  // namespace

std::size_t elements(const std::vector<std::size_t>& shape) {
  std::size_t product = 1;
  for (const std::size_t length : shape) product *= length;
  return product;
}

std::size_t records_in_buffer(std::size_t record_bytes) {
  // A block does not begin where a buffer does.
  constexpr std::size_t least = 16, most_bytes = classic_buffer_bytes / 4 * 3;
  return std::clamp(most_bytes / std::max<std::size_t>(record_bytes, 1), least, records_per_block);
}

std::size_t NetcdfFile::records_at_once() const {
  return record_bytes_ > 0 ? records_in_buffer(record_bytes_) : records_per_block;
}

std::string netcdf_reason(int status) { return status > 0 ? std::strerror(status) : nc_strerror(status); }

bool is_netcdf(const std::filesystem::path& path) { return content_of(path) != Content::other; }

NetcdfFile NetcdfFile::open(const std::filesystem::path& path) {
  const std::string name = path.string();
  const FileState state(path);
  ClassicLayout layout;
  if (content_of(path) == Content::classic) layout = checked_layout_of_classic(path);
  int id = closed;
  std::size_t buffer = is_brought(layout.record_bytes)      ? page
                       : layout.record_bytes > large_record ? large_record
                                                            : classic_buffer_bytes;
  const int opened = nc__open(name.c_str(), NC_NOWRITE, &buffer, &id);
  if (opened == NC_ENOMEM || opened == ENOMEM) throw std::bad_alloc();
  if (opened > 0)
    throw Error(Error::Code::file, name + " cannot be read: " + netcdf_reason(opened) +
                                       "; check its disk and the limits of the system");
  if (opened != NC_NOERR)
    throw Error(Error::Code::file, name + " is truncated or damaged (" + netcdf_reason(opened) +
                                       "); fetch it again from its source");
  NetcdfFile file(id, path, Use::reading, state);
  file.record_bytes_ = layout.record_bytes;
  file.records_begin_ = layout.records_begin;
  return file;
}

NetcdfFile NetcdfFile::create(const std::filesystem::path& path, const std::filesystem::path& shown_path,
                              int mode) {
  int id = closed;
  std::size_t buffer = classic_buffer_bytes;
  const int status = nc__create(path.c_str(), mode | NC_CLOBBER, 0, &buffer, &id);
  NetcdfFile file(id, shown_path, Use::writing);
  file.check(status, "cannot be created");
  return file;
}

NetcdfFile::NetcdfFile(NetcdfFile&& other) noexcept
    : id_(std::exchange(other.id_, closed)),
      path_(std::move(other.path_)),
      use_(other.use_),
      state_(other.state_),
      record_bytes_(other.record_bytes_),
      records_begin_(other.records_begin_),
      brought_(other.brought_),
      fitted_(std::move(other.fitted_)) {}

NetcdfFile::~NetcdfFile() {
  if (id_ == closed) return;
  std::optional<FileInHand> in_hand;  // the library may crash where the system does not close the file
  if (use_ == Use::reading) in_hand.emplace(path_);
  nc_close(id_);
}

void NetcdfFile::check(int status, const std::string& doing) const {
  if (status == NC_NOERR) return;
  if (status == NC_ENOMEM || status == ENOMEM) throw std::bad_alloc();
  if (use_ == Use::reading) require_unchanged();
  std::string message = path_.string() + ": " + doing + ": " + netcdf_reason(status);
  if (use_ == Use::reading) throw Error(Error::Code::file, message + advice_to_reader(status));
  if (can_name_nothing(status)) throw Error(Error::Code::output, message + "; give it another name");
  std::error_code code;
  const auto space = std::filesystem::space(std::filesystem::absolute(path_).parent_path(), code);
  constexpr std::uintmax_t little = 1 << 20;
  const bool full = status == ENOSPC || (!code && space.available < little);
  if (full && status != ENOSPC) message += " (the disk is full)";
  throw Error(Error::Code::output, message + (full ? "; make room or choose another output"
                                                   : "; check the space and the permissions there"));
}

void NetcdfFile::require_unchanged() const { state_.require(path_); }

void NetcdfFile::close() { check(nc_close(std::exchange(id_, closed)), "cannot be closed"); }

void NetcdfFile::fit_chunk_cache(int variable) const {
  if (!fitted_.insert(variable).second) return;
  int storage = NC_CONTIGUOUS;
  std::vector<std::size_t> chunk(dimensions_of(variable).size());
  if (chunk.empty() || nc_inq_var_chunking(id_, variable, &storage, chunk.data()) != NC_NOERR) return;
  if (storage != NC_CHUNKED) return;
  std::size_t bytes = 0;
  check(nc_inq_type(id_, type_of(variable), nullptr, &bytes), "cannot read a variable's type");
  for (const std::size_t length : chunk) bytes *= length;
  nc_set_var_chunk_cache(id_, variable, std::max(2 * bytes, chunk_cache_bytes), chunk_cache_slots, 1);
}

std::string NetcdfFile::allowed(const std::string& name, const char* what) const {
  if (name.size() <= NC_MAX_NAME) return name;
  throw Error(
      Error::Code::file,
      fmt::format("{}: {} is called {}, and netCDF allows {} bytes for a name; give it a shorter one, "
                  "as h5py can, or fetch the file again from its source",
                  path_.string(), what, in_quotes(name), NC_MAX_NAME));
}

int NetcdfFile::variable_count() const {
  int count = 0;
  check(nc_inq_nvars(id_, &count), "cannot count its variables");
  return count;
}

std::optional<int> NetcdfFile::find_variable(const std::string& name) const {
  int variable = 0;
  const int status = nc_inq_varid(id_, name.c_str(), &variable);
  if (status == NC_ENOTVAR || can_name_nothing(status)) return std::nullopt;
  check(status, "cannot look for the variable " + name);
  return variable;
}

std::string NetcdfFile::variable_name(int variable) const {
  char name[room_for_name];
  check(nc_inq_varname(id_, variable, name), "cannot read a variable's name");
  return allowed(name, "a variable");
}

std::vector<int> NetcdfFile::dimensions_of(int variable) const {
  int rank = 0;
  check(nc_inq_varndims(id_, variable, &rank), "cannot read a variable's dimensions");
  std::vector<int> dimensions(static_cast<std::size_t>(rank));
  check(nc_inq_vardimid(id_, variable, dimensions.data()), "cannot read a variable's dimensions");
  return dimensions;
}

std::string NetcdfFile::dimension_name(int dimension) const {
  char name[room_for_name];
  check(nc_inq_dimname(id_, dimension, name), "cannot read a dimension's name");
  return allowed(name, "a dimension");
}

std::size_t NetcdfFile::dimension_length(int dimension) const {
  std::size_t length = 0;
  check(nc_inq_dimlen(id_, dimension, &length), "cannot read a dimension's length");
  return length;
}

int NetcdfFile::type_of(int variable) const {
  nc_type type = NC_NAT;
  check(nc_inq_vartype(id_, variable, &type), "cannot read a variable's type");
  return type;
}

std::vector<std::string> NetcdfFile::attribute_names(int variable) const {
  int count = 0;
  check(nc_inq_varnatts(id_, variable, &count), "cannot count attributes");
  std::vector<std::string> names;
  for (int i = 0; i < count; ++i) {
    char name[room_for_name];
    check(nc_inq_attname(id_, variable, i, name), "cannot read an attribute's name");
    names.push_back(allowed(name, "an attribute"));
  }
  return names;
}

std::optional<NetcdfFile::Attribute> NetcdfFile::find_attribute(int variable, const std::string& name) const {
  Attribute found;
  const int status = nc_inq_att(id_, variable, name.c_str(), &found.type, &found.length);
  if (status == NC_ENOTATT || can_name_nothing(status)) return std::nullopt;
  check(status, "cannot read its attributes, among them perhaps " + name);
  return found;
}

std::string NetcdfFile::text_attribute(int variable, const std::string& name) const {
  const auto [type, length] = find_attribute(variable, name).value_or(Attribute());
  if (length == 0) return {};
  if (type == NC_CHAR) {
    std::string text(length, '\0');
    check(nc_get_att_text(id_, variable, name.c_str(), text.data()), "cannot read the attribute " + name);
    return without_trailing_blanks(text);
  }
  if (type == NC_STRING) {
    std::vector<char*> strings(length);
    check(nc_get_att_string(id_, variable, name.c_str(), strings.data()),
          "cannot read the attribute " + name);
    std::string text;
    for (const char* each : strings) text += (text.empty() ? "" : ", ") + std::string(each ? each : "");
    nc_free_string(length, strings.data());
    return without_trailing_blanks(text);
  }
  if (type > NC_STRING) return {};
  std::string text;
  for (const double number : number_attribute(variable, name)) {
    if (!text.empty()) text += ", ";
    text += type == NC_FLOAT ? fmt::format("{}", static_cast<float>(number)) : fmt::format("{}", number);
  }
  return text;
}

std::vector<double> NetcdfFile::number_attribute(int variable, const std::string& name) const {
  const auto [type, length] = find_attribute(variable, name).value_or(Attribute());
  if (type == NC_NAT || type > NC_STRING) return {};
  std::vector<double> numbers;
  if (type != NC_CHAR && type != NC_STRING) {
    numbers.resize(length);
    check(nc_get_att_double(id_, variable, name.c_str(), numbers.data()),
          "cannot read the attribute " + name);
    return numbers;
  }
  const std::string text = text_attribute(variable, name);
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

bool NetcdfFile::is_numeric(int variable) const {
  const int type = type_of(variable);
  return type != NC_CHAR && type > NC_NAT && type < NC_STRING;
}

bool NetcdfFile::is_unsigned(int variable) const {
  const int type = type_of(variable);
  if (!is_signed(type)) return span_of(type).has_value();
  return strcasecmp(text_attribute(variable, "_Unsigned").c_str(), "true") == 0;
}

void NetcdfFile::make_unsigned(int variable, double* numbers, std::size_t count) const {
  const int type = type_of(variable);
  if (!is_signed(type) || !is_unsigned(variable)) return;
  const double span = *span_of(type);
  for (std::size_t i = 0; i < count; ++i) numbers[i] += numbers[i] < 0 ? span : 0;
}

double NetcdfFile::greatest_number(int variable) const {
  const std::optional<double> span = span_of(type_of(variable));
  if (!span) return std::numeric_limits<double>::max();
  return (is_unsigned(variable) ? *span : *span / 2) - 1;
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
  if (values.empty() && (type == NC_FLOAT || type == NC_DOUBLE)) values.push_back(-32767);
  if (auto fill = default_fill(type)) {
    make_unsigned(variable, &*fill, 1);
    values.push_back(*fill);
  }
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

void NetcdfFile::refuse_attribute(int variable, const std::string& name, const std::string& why) const {
  const bool is_global = variable == NC_GLOBAL;
  const std::string of = is_global ? "global" : variable_name(variable);
  throw Error(
      Error::Code::variable,
      fmt::format("{}: the attribute {} of {} {}; correct it, or take it away with ncatted -a {} {}, or "
                  "with h5py where that cannot write the file",
                  path_.string(), name, is_global ? "the file" : of, why,
                  shell_word(fmt::format("{},{},d,,", name, of)), shell_word(path_.string())));
}

std::array<double, 2> NetcdfFile::valid_range(int variable) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr struct {
    const char* name;
    std::size_t first, count;
  } attributes[] = {{"valid_range", 0, 2}, {"valid_min", 0, 1}, {"valid_max", 1, 1}};
  const int type = type_of(variable);
  const bool is_packed =
      type != NC_FLOAT && type != NC_DOUBLE &&
      !(text_attribute(variable, "scale_factor") + text_attribute(variable, "add_offset")).empty();
  std::array<double, 2> range{-infinity, infinity};
  for (const auto& each : attributes) {
    const auto attribute = find_attribute(variable, each.name);
    if (!attribute) continue;
    const std::vector<double> numbers = stored_numbers(variable, each.name);
    if (numbers.size() != each.count)
      refuse_attribute(variable, each.name, each.count == 1 ? "is not one number" : "is not two numbers");
    if (is_packed && (attribute->type == NC_FLOAT || attribute->type == NC_DOUBLE))
      refuse_attribute(
          variable, each.name,
          "has another type than the packed integers, so that it cannot be told whether it is of "
          "these or of what they stand for");
    std::copy(numbers.begin(), numbers.end(), range.begin() + each.first);
    if (!(range[0] <= range[1])) refuse_attribute(variable, each.name, "leaves no value");
  }
  return range;
}

void NetcdfFile::bring_into_memory(RecordBlock records) const {
  const std::size_t end = records.first + records.count;
  if (!is_brought(record_bytes_) || records.count == 0 || end <= brought_) return;
  const std::size_t first = std::max(records.first, brought_);
  brought_ = end;
  std::ifstream file(path_, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(records_begin_ + first * record_bytes_));
  std::vector<char> bytes(classic_buffer_bytes);
  for (std::size_t left = (end - first) * record_bytes_; left > 0 && file;) {  // the library tells of trouble
    const std::size_t some = std::min(left, bytes.size());
    file.read(bytes.data(), static_cast<std::streamsize>(some));
    left -= some;
  }
}

void NetcdfFile::read(int variable, RecordBlock records, double* out) const {
  fit_chunk_cache(variable);
  const std::vector<int> dimensions = dimensions_of(variable);
  int unlimited = -1;
  check(nc_inq_unlimdim(id_, &unlimited), "cannot read its dimensions");
  if (!dimensions.empty() && dimensions.front() == unlimited) bring_into_memory(records);
  std::vector<std::size_t> start, count;
  for (const int dimension : dimensions) {
    start.push_back(start.empty() ? records.first : 0);
    count.push_back(count.empty() ? records.count : dimension_length(dimension));
  }
  check(nc_get_vara_double(id_, variable, start.data(), count.data(), out),
        "cannot read " + variable_name(variable));
  require_unchanged();
  make_unsigned(variable, out, elements(count));
}

}  // namespace pcor::internal
