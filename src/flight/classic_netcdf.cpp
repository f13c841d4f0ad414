#include "flight/classic_netcdf.hpp"

#include <algorithm>
#include <fstream>
#include <limits>
#include <vector>

namespace pcor::internal {
namespace {

constexpr std::uint64_t maximum = std::numeric_limits<std::uint64_t>::max();

// Saturates: a result that is too large is the largest number of the type.
std::uint64_t times(std::uint64_t a, std::uint64_t b) { return b != 0 && a > maximum / b ? maximum : a * b; }
std::uint64_t plus(std::uint64_t a, std::uint64_t b) { return a > maximum - b ? maximum : a + b; }
std::uint64_t padded(std::uint64_t bytes) { return bytes > maximum - 3 ? maximum : (bytes + 3) / 4 * 4; }

// The header as the netCDF classic format specification lays it out; all numbers are big-endian. An
// impossible number makes the header unsound, and every further number is then 0.
class Header {
 public:
  explicit Header(const std::filesystem::path& path)
      : stream_(path, std::ios::binary), remaining_bytes_(std::filesystem::file_size(path)) {
    require(number(1) == 'C' && number(1) == 'D' && number(1) == 'F');
    version_ = number(1);
    require(version_ == 1 || version_ == 2 || version_ == 5);
  }

  bool sound() const { return sound_; }
  std::uint64_t count() { return number(version_ == 5 ? 8 : 4); }
  std::uint64_t offset() { return number(version_ == 1 ? 4 : 8); }

  // Number of dimensions (tag 10), variables (11) or attributes (12) that follow; each has at least the
  // stated number of bytes.
  std::uint64_t list_of(std::uint64_t tag, std::uint64_t min_bytes) {
    const std::uint64_t found = number(4), length = count();
    require(found == tag || (found == 0 && length == 0));
    require(length <= remaining_bytes_ / min_bytes);
    return sound_ ? length : 0;
  }

  // Size in bytes of an element of the type that follows.
  std::uint64_t element_bytes() {
    constexpr std::uint64_t sizes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    const std::uint64_t type = number(4);
    require(type > 0 && type < std::size(sizes));
    return sound_ ? sizes[type] : 0;
  }

  // The netCDF library writes no longer one, and would copy it beyond the room that it has.
  void skip_name() {
    constexpr std::uint64_t longest = 256;
    const std::uint64_t length = count();
    require(length <= longest);
    skip(padded(length));
  }

  void skip_attributes() {
    constexpr std::uint64_t tag = 12, min_bytes = 12;
    for (std::uint64_t remaining = list_of(tag, min_bytes); remaining > 0 && sound_; --remaining) {
      skip_name();
      const std::uint64_t bytes = element_bytes();
      skip(padded(times(bytes, count())));
    }
  }

  void require(bool condition) { sound_ = sound_ && condition; }

 private:
  std::uint64_t number(std::uint64_t bytes) {
    std::uint64_t value = 0;
    require(bytes <= remaining_bytes_);
    for (std::uint64_t i = 0; i < bytes && sound_; ++i) {
      const int byte = stream_.get();
      require(stream_.good());
      value = value << 8 | static_cast<std::uint64_t>(byte);
    }
    if (sound_) remaining_bytes_ -= bytes;
    return sound_ ? value : 0;
  }

  void skip(std::uint64_t bytes) {
    require(bytes <= remaining_bytes_);
    if (!sound_) return;
    stream_.ignore(static_cast<std::streamsize>(bytes));
    remaining_bytes_ -= bytes;
  }

  std::ifstream stream_;
  std::uint64_t remaining_bytes_;
  std::uint64_t version_ = 0;
  bool sound_ = true;
};

struct Extent {
  bool record = false;
  std::uint64_t bytes = 0;  // size of the whole variable, or of one record
  std::uint64_t begin = 0;
};

}  // namespace

std::optional<ClassicLayout> layout_of_classic(const std::filesystem::path& path) {
  Header header(path);
  const std::uint64_t records = header.count();

  constexpr std::uint64_t dimension_tag = 10, min_dimension_bytes = 8;
  std::vector<std::uint64_t> lengths;  // lengths of the dimensions; 0 is the unlimited dimension
  for (std::uint64_t remaining = header.list_of(dimension_tag, min_dimension_bytes);
       remaining > 0 && header.sound(); --remaining) {
    header.skip_name();
    lengths.push_back(header.count());
  }
  header.skip_attributes();

  constexpr std::uint64_t variable_tag = 11, min_variable_bytes = 28;
  std::vector<Extent> variables;
  for (std::uint64_t remaining = header.list_of(variable_tag, min_variable_bytes);
       remaining > 0 && header.sound(); --remaining) {
    Extent variable;
    header.skip_name();
    std::uint64_t elements = 1;
    for (std::uint64_t rank = header.count(); rank > 0 && header.sound(); --rank) {
      const std::uint64_t dimension = header.count();
      header.require(dimension < lengths.size());
      const std::uint64_t length = header.sound() ? lengths[dimension] : 0;
      if (length == 0)
        variable.record = true;
      else
        elements = times(elements, length);
    }
    header.skip_attributes();
    variable.bytes = times(elements, header.element_bytes());
    header.count();  // stored size, redundant
    variable.begin = header.offset();
    variables.push_back(variable);
  }
  if (!header.sound()) return std::nullopt;

  std::uint64_t record_variables = 0, record_bytes = 0;
  for (const Extent& variable : variables) {
    if (!variable.record) continue;
    ++record_variables;
    record_bytes = plus(record_bytes, padded(variable.bytes));
  }
  ClassicLayout layout{0, record_bytes, maximum};
  for (const Extent& variable : variables) {
    if (variable.record) layout.records_begin = std::min(layout.records_begin, variable.begin);
    const std::uint64_t stride = record_variables == 1 ? variable.bytes : record_bytes;
    const std::uint64_t end = plus(variable.begin, variable.bytes);
    if (!variable.record)
      layout.size = std::max(layout.size, end);
    else if (records > 0)
      layout.size = std::max(layout.size, plus(end, times(records - 1, stride)));
  }
  return layout;
}

}  // namespace pcor::internal
