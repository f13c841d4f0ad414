#include "classic_netcdf.hpp"

#include <algorithm>
#include <fstream>
#include <limits>
#include <vector>

namespace pcor {
namespace {

// The header as the netCDF classic format specification lays it out; all numbers are big-endian.
class Header {
 public:
  explicit Header(const std::filesystem::path& path) : stream_(path, std::ios::binary) {
    skip(3);
    version_ = number(1);
  }

  bool whole() const { return stream_.good(); }
  std::uint64_t type() { return number(4); }
  std::uint64_t count() { return number(version_ == 5 ? 8 : 4); }
  std::uint64_t offset() { return number(version_ == 1 ? 4 : 8); }
  std::uint64_t unknown_count() const { return version_ == 5 ? ~std::uint64_t{0} : 0xffffffffU; }

  void skip_name() { skip_padded(count()); }

  void skip_attributes() {
    type();
    for (std::uint64_t left = count(); left > 0 && whole(); --left) {
      skip_name();
      const std::uint64_t bytes = size_of(type());
      skip_padded(bytes * count());
    }
  }

  static std::uint64_t size_of(std::uint64_t type) {
    constexpr std::uint64_t sizes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    return type < std::size(sizes) ? sizes[type] : 0;
  }

  static std::uint64_t padded(std::uint64_t bytes) { return (bytes + 3) / 4 * 4; }

 private:
  std::uint64_t number(int bytes) {
    std::uint64_t value = 0;
    for (; bytes > 0; --bytes) {
      const int byte = stream_.get();
      if (!stream_) return 0;
      value = value << 8 | static_cast<std::uint64_t>(byte);
    }
    return value;
  }

  void skip(std::uint64_t bytes) { stream_.ignore(static_cast<std::streamsize>(bytes)); }
  void skip_padded(std::uint64_t bytes) { skip(padded(bytes)); }

  std::ifstream stream_;
  std::uint64_t version_ = 0;
};

struct Extent {
  bool record = false;
  std::uint64_t bytes = 0;  // of the whole variable, or of one record of it
  std::uint64_t begin = 0;
};

}  // namespace

std::uintmax_t promised_size_of_classic(const std::filesystem::path& path) {
  Header header(path);
  std::uint64_t records = header.count();
  if (records == header.unknown_count()) records = 0;

  std::vector<std::uint64_t> lengths;  // of the dimensions; 0 is the unlimited one
  header.type();
  for (std::uint64_t left = header.count(); left > 0 && header.whole(); --left) {
    header.skip_name();
    lengths.push_back(header.count());
  }
  header.skip_attributes();

  std::vector<Extent> variables;
  header.type();
  for (std::uint64_t left = header.count(); left > 0 && header.whole(); --left) {
    Extent variable;
    header.skip_name();
    std::uint64_t elements = 1;
    for (std::uint64_t rank = header.count(); rank > 0 && header.whole(); --rank) {
      const std::uint64_t dimension = header.count();
      const std::uint64_t length = dimension < lengths.size() ? lengths[dimension] : 0;
      if (length == 0)
        variable.record = true;
      else
        elements *= length;
    }
    header.skip_attributes();
    variable.bytes = elements * Header::size_of(header.type());
    header.count();  // the size as stored, which says no more
    variable.begin = header.offset();
    variables.push_back(variable);
  }
  if (!header.whole()) return std::numeric_limits<std::uintmax_t>::max();

  std::uint64_t record_variables = 0, record_bytes = 0;
  for (const Extent& variable : variables) {
    if (!variable.record) continue;
    ++record_variables;
    record_bytes += Header::padded(variable.bytes);
  }
  std::uintmax_t size = 0;
  for (const Extent& variable : variables) {
    const std::uint64_t stride = record_variables == 1 ? variable.bytes : record_bytes;
    if (!variable.record)
      size = std::max(size, variable.begin + variable.bytes);
    else if (records > 0)
      size = std::max(size, variable.begin + (records - 1) * stride + variable.bytes);
  }
  return size;
}

}  // namespace pcor
