#include "flight/netcdf_copy.hpp"

#include <fmt/format.h>
#include <netcdf.h>

#include <algorithm>

#include <pcor/units/units.hpp>
#include <pcor/words/error.hpp>
#include "flight/file_in_hand.hpp"

namespace pcor::internal {
namespace {

/// How the names of attributes begin in which this program says what a file was made of: they are not true
/// of the next one.
constexpr const char* own_attributes = "pcor_";

/// Numbers and letters. Texts are not: what the library calls so may be any text of a fixed length in HDF5,
/// or a long double, and it writes more bytes of it to where they are read than it says that it has.
bool is_copied(int type) { return type < NC_STRING; }

// Where in a copied variable the records of a block are.
struct Slab {
  std::vector<std::size_t> start, count;

  Slab(const std::vector<std::size_t>& shape, bool over_time, RecordBlock block)
      : start(shape.size(), 0), count(shape) {
    if (!over_time) return;
    start.insert(start.begin(), block.first);
    count.insert(count.begin(), block.count);
  }
};

}  // namespace

void NetcdfCopy::copy_global_attributes() const {
  for (const std::string& name : source_.attribute_names(NC_GLOBAL))
    if (name.rfind(own_attributes, 0) != 0) copy_attribute(NC_GLOBAL, NC_GLOBAL, name, NC_NAT);
}

void NetcdfCopy::copy_attribute(int from, int to, const std::string& name, int type_of_variable) const {
  // What a file may hold and netCDF does not write is a matter of the input.
  const auto check = [&](int status) {
    switch (status) {
      case NC_EBADNAME:
      case NC_EBADTYPE:
      case NC_ECHAR:
      case NC_EINVAL:
      case NC_ERANGE:
      case NC_ESTRICTNC3:
        source_.refuse_attribute(from, name, "cannot be copied (" + netcdf_reason(status) + ")");
      default:
        output_.check(status);
    }
  };
  nc_type type = NC_NAT;
  source_.check(nc_inq_atttype(source_.id(), from, name.c_str(), &type), "cannot read the attribute " + name);
  if (type > NC_STRING) return;  // of the file's own making
  if (type == NC_CHAR) {
    const std::string text = source_.text_attribute(from, name);
    const std::string written = name == "units" ? standard_unit(text) : text;
    if (!written.empty())
      check(nc_put_att_text(output_.id(), to, name.c_str(), written.size(), written.data()));
    return;
  }
  // A marker of missing values must have the type of the variable, which old writers did not know.
  const bool marker = name == "_FillValue" || name == "missing_value";
  if (marker && type != type_of_variable && type < NC_STRING) {
    const std::vector<double> values = source_.number_attribute(from, name);
    check(nc_put_att_double(output_.id(), to, name.c_str(), type_of_variable, values.size(), values.data()));
    return;
  }
  check(nc_copy_att(source_.id(), from, name.c_str(), output_.id(), to));
}

bool NetcdfCopy::can_copy(const std::string& name) const {
  const int variable = *source_.find_variable(name);
  if (!is_copied(source_.type_of(variable))) return false;
  const std::vector<int> shape = source_.dimensions_of(variable);
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const bool fits =
        shape[i] == time_dimension_
            ? i == 0
            : !output_.has_other_length(source_.dimension_name(shape[i]), source_.dimension_length(shape[i]));
    if (!fits) return false;
  }
  return true;
}

void NetcdfCopy::define(const std::string& name) {
  const std::string shown = output_.file().path().string();
  Copied entry;
  entry.from = *source_.find_variable(name);
  entry.type = source_.type_of(entry.from);
  source_.fit_chunk_cache(entry.from);
  if (!is_copied(entry.type))
    throw Error(
        fmt::format("{}: {} holds texts or has a type of its own making, which cannot be copied; "
                    "leave it out",
                    shown, name));
  std::vector<int> shape;
  for (const int each : source_.dimensions_of(entry.from)) {
    const bool time = each == time_dimension_;
    const std::size_t length = source_.dimension_length(each);
    if (time && !shape.empty())
      throw Error(fmt::format("{}: Time is not the first dimension of {}; leave it out", shown, name));
    shape.push_back(time ? output_.time_dimension()
                         : output_.dimension(source_.dimension_name(each), length));
    entry.over_time = entry.over_time || time;
    if (!time) entry.shape.push_back(length);
  }
  entry.to = output_.add_variable(name, entry.type, shape);
  if (entry.over_time) copy_compression(entry);
  for (const std::string& attribute : source_.attribute_names(entry.from))
    copy_attribute(entry.from, entry.to, attribute, entry.type);
  if (source_.text_attribute(entry.from, "long_name").empty() &&
      source_.text_attribute(entry.from, "standard_name").empty())
    output_.put_text(entry.to, "long_name", name);
  copied_.push_back(entry);
}

void NetcdfCopy::copy_compression(const Copied& variable) const {
  int shuffle = 0, deflate = 0, level = 0;
  if (!output_.is_hdf5() ||
      nc_inq_var_deflate(source_.id(), variable.from, &shuffle, &deflate, &level) != NC_NOERR)
    return;
  if (deflate) output_.check(nc_def_var_deflate(output_.id(), variable.to, shuffle, deflate, level));
}

std::size_t NetcdfCopy::record_bytes(const Copied& variable) const {
  std::size_t bytes = 0;
  output_.check(nc_inq_type(source_.id(), variable.type, nullptr, &bytes));
  return elements(variable.shape) * bytes;
}

void NetcdfCopy::read(const Copied& variable, RecordBlock block, char* buffer) const {
  const Slab slab(variable.shape, variable.over_time, block);
  const FileInHand in_hand(source_.path());
  source_.check(nc_get_vara(source_.id(), variable.from, slab.start.data(), slab.count.data(), buffer),
                "cannot read " + source_.variable_name(variable.from));
  source_.require_unchanged();
}

void NetcdfCopy::write(const Copied& variable, RecordBlock block, const char* buffer) const {
  const Slab slab(variable.shape, variable.over_time, block);
  output_.check(nc_put_vara(output_.id(), variable.to, slab.start.data(), slab.count.data(), buffer));
}

// A classic file with an unlimited Time has the records one after the other.
bool NetcdfCopy::source_has_records() const {
  int unlimited = -1;
  output_.check(nc_inq_unlimdim(source_.id(), &unlimited));
  const FileKind kind = kind_of(source_);
  const bool hdf5 = kind == FileKind::netcdf4 || kind == FileKind::netcdf4_classic;
  return !hdf5 && unlimited == time_dimension_;
}

void NetcdfCopy::copy_values(std::size_t records) const {
  std::vector<const Copied*> series;
  std::vector<char> buffer;
  for (const Copied& variable : copied_) {
    if (record_bytes(variable) == 0) continue;
    if (variable.over_time) {
      series.push_back(&variable);
      continue;
    }
    buffer.resize(record_bytes(variable));
    read(variable, {}, buffer.data());
    write(variable, {}, buffer.data());
  }
  std::size_t bytes = 1;
  for (const Copied* variable : series) bytes += record_bytes(*variable);
  const auto copy = [&](const Copied& variable, RecordBlock block) {
    buffer.resize(block.count * record_bytes(variable));
    read(variable, block, buffer.data());
    write(variable, block, buffer.data());
  };
  // HDF5 holds chunks of each variable, so its variables come one after the other; records of classic files
  // are moved together.
  if (source_has_records() || !output_.is_hdf5()) {
    for (const RecordBlock block :
         blocks_of(records, std::min(records_in_buffer(bytes), source_.records_at_once())))
      for (const Copied* variable : series) copy(*variable, block);
  } else {
    for (const Copied* variable : series)
      for (const RecordBlock block : blocks_of(records)) copy(*variable, block);
  }
}

}  // namespace pcor::internal
