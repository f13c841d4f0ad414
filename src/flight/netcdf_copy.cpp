#include "flight/netcdf_copy.hpp"

#include <algorithm>

#include <pcor/units/units.hpp>
#include "flight/current_input.hpp"

using netCDF::NcDim;
using netCDF::NcVar;
using netCDF::exceptions::NcException;

namespace pcor::internal {
namespace {

/// Prefixes of the attributes in which this program records the sources of a file; they do not apply to a
/// copy.
constexpr const char* own_attributes = "pcor_";

/// Whether the type is a number or a character. Strings are excluded: the library reports HDF5 strings of
/// fixed length and long doubles as NC_STRING, and writes more bytes on reading than it reports.
bool is_copied(int type) { return type < NC_STRING; }

/// Whether an error of the writer is caused by content of the input that netCDF does not allow.
bool is_of_input(const NcException& error) {
  constexpr int all[] = {NC_EBADNAME, NC_EBADTYPE, NC_ECHAR, NC_EINVAL, NC_ERANGE, NC_ESTRICTNC3};
  return std::find(std::begin(all), std::end(all), error.errorCode()) != std::end(all);
}

}  // namespace

void NetcdfCopy::copy_global_attributes() const {
  for (const std::string& name : source_.attribute_names(NetcdfFile::whole_file))
    if (name.rfind(own_attributes, 0) != 0)
      copy_attribute(NetcdfFile::whole_file, NetcdfFile::whole_file, name, NC_NAT);
}

void NetcdfCopy::copy_attribute(int from, int to, const std::string& name, int type_of_variable) const {
  const auto attribute = source_.find_attribute(from, name);
  if (!attribute) source_.refuse_attribute(from, name, "has a name that netCDF does not allow");
  const int type = attribute->type;
  if (type > NC_STRING) return;  // user-defined
  // A marker of missing values must have the type of the variable, which old writers did not know.
  const bool is_marker = name == "_FillValue" || name == "missing_value";
  try {
    if (type == NC_CHAR) {
      const std::string text = source_.text_attribute(from, name);
      output_.put_text(to, name, name == "units" ? standard_unit(text) : text);
    } else if (is_marker && type != type_of_variable && type != NC_STRING) {
      const std::vector<double> values = source_.number_attribute(from, name);
      output_.variable(to).putAtt(name, netCDF::NcType(type_of_variable), values.size(), values.data());
    } else {
      internal::copy_attribute(source_.variable(from), name, output_.variable(to));
    }
  } catch (const NcException& error) {
    if (!is_of_input(error)) throw;
    source_.refuse_attribute(from, name, "cannot be copied (" + netcdf_reason(error) + ")");
  }
}

bool NetcdfCopy::can_copy(const std::string& name) const {
  const std::optional<int> variable = source_.find_variable(name);
  if (!variable || !is_copied(source_.type_of(*variable))) return false;
  const std::vector<int> shape = source_.dimensions_of(*variable);
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
  const std::optional<int> from = source_.find_variable(name);
  const int type = from ? source_.type_of(*from) : NC_NAT;
  if (!from || !is_copied(type))
    output_.refuse(
        Error::Code::variable,
        ": {} cannot be copied, because it has strings, a user-defined type or a name that netCDF does "
        "not allow; do not copy it",
        name);
  Copied entry;
  entry.from = *from;
  source_.fit_chunk_cache(entry.from);
  std::vector<NcDim> dimensions;
  for (const int each : source_.dimensions_of(entry.from)) {
    const bool time = each == time_dimension_;
    const std::size_t length = source_.dimension_length(each);
    if (time && !dimensions.empty())
      output_.refuse(Error::Code::variable, ": Time is not the first dimension of {}; do not copy it", name);
    dimensions.push_back(time ? output_.time() : output_.dimension_of(source_.dimension_name(each), length));
    entry.over_time = entry.over_time || time;
    if (!time) entry.shape.push_back(length);
  }
  entry.record_bytes = elements(entry.shape) * netCDF::NcType(type).getSize();
  entry.to = output_.add_variable(name, type, dimensions);
  if (entry.over_time && output_.is_hdf5()) {
    bool shuffle = false, deflate = false;
    int level = 0;
    source_.attempt("cannot read how its variables are compressed",
                    [&] { source_.variable(entry.from).getCompressionParameters(shuffle, deflate, level); });
    if (deflate) output_.variable(entry.to).setCompression(shuffle, deflate, level);
  }
  for (const std::string& attribute : source_.attribute_names(entry.from))
    copy_attribute(entry.from, entry.to, attribute, type);
  if (source_.text_attribute(entry.from, "long_name").empty() &&
      source_.text_attribute(entry.from, "standard_name").empty())
    output_.put_text(entry.to, "long_name", name);
  copied_.push_back(entry);
}

void NetcdfCopy::copy_block(const Copied& variable, RecordBlock block) {
  if (variable.record_bytes == 0) return;
  std::vector<std::size_t> start(variable.shape.size(), 0), count = variable.shape;
  if (variable.over_time) {
    start.insert(start.begin(), block.first);
    count.insert(count.begin(), block.count);
  }
  buffer_.resize((variable.over_time ? block.count : 1) * variable.record_bytes);
  void* const values = buffer_.data();  // any type
  {
    const CurrentInput current(source_.path());
    source_.attempt("cannot read " + source_.variable_name(variable.from),
                    [&] { source_.variable(variable.from).getVar(start, count, values); });
  }
  source_.require_unchanged();
  output_.variable(variable.to).putVar(start, count, values);
}

void NetcdfCopy::copy_constants() {
  for (const Copied& variable : copied_)
    if (!variable.over_time) copy_block(variable, {});
}

void NetcdfCopy::copy_records(RecordBlock block) {
  for (const Copied& variable : copied_)
    if (variable.over_time) copy_block(variable, block);
}

}  // namespace pcor::internal
