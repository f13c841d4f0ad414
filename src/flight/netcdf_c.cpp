#include "flight/netcdf_c.hpp"

#include <netcdf.h>

using netCDF::ncCheck;
using netCDF::NcVar;

namespace pcor::internal {
namespace {

void check(int status) { ncCheck(status, __FILE__, __LINE__); }

template <class Item>
int group_of(const Item& item) {
  return item.getParentGroup().getId();
}

/// Whether a word names nothing, or is not a name that netCDF allows.
bool names_nothing(int status) {
  return status == NC_ENOTVAR || status == NC_ENOTATT || status == NC_EBADNAME || status == NC_EMAXNAME;
}

/// The name that a function of the library copies. HDF5 stores the length of an attribute's name in two
/// bytes; names in a classic file are checked before the file is opened (`layout_of_classic`).
template <class Function, class... Arguments>
std::string name_by(Function* function, Arguments... arguments) {
  char name[std::size_t{1} << 16];
  check(function(arguments..., name));
  return name;
}

constexpr struct {
  NetcdfFormat kind;
  int format, mode;
} kinds[] = {{NetcdfFormat::classic, NC_FORMAT_CLASSIC, 0},
             {NetcdfFormat::offset64, NC_FORMAT_64BIT_OFFSET, NC_64BIT_OFFSET},
             {NetcdfFormat::cdf5, NC_FORMAT_CDF5, NC_64BIT_DATA},
             {NetcdfFormat::netcdf4, NC_FORMAT_NETCDF4, NC_NETCDF4},
             {NetcdfFormat::netcdf4_classic, NC_FORMAT_NETCDF4_CLASSIC, NC_NETCDF4 | NC_CLASSIC_MODEL}};

}  // namespace

void BufferedFile::open(const std::filesystem::path& path, std::size_t buffer) {
  check(nc__open(path.c_str(), NC_NOWRITE, &buffer, &myId));
  nullObject = false;
}

void BufferedFile::create(const std::filesystem::path& path, NetcdfFormat kind, std::size_t buffer) {
  int mode = NC_CLOBBER;
  for (const auto& each : kinds)
    if (each.kind == kind) mode |= each.mode;
  check(nc__create(path.c_str(), mode, 0, &buffer, &myId));
  nullObject = false;
}

void BufferedFile::close() {
  if (isNull()) return;
  nullObject = true;
  check(nc_close(myId));
}

void BufferedFile::close_quietly() noexcept {
  if (!isNull()) nc_close(myId);
  nullObject = true;
}

NetcdfFormat BufferedFile::kind() const {
  int format = 0;
  check(nc_inq_format(myId, &format));
  for (const auto& each : kinds)
    if (each.format == format) return each.kind;
  return NetcdfFormat::netcdf4;
}

std::optional<int> find_variable(const netCDF::NcGroup& file, const std::string& name) {
  int number = 0;
  const int status = nc_inq_varid(file.getId(), name.c_str(), &number);
  if (names_nothing(status)) return std::nullopt;
  check(status);
  return number;
}

std::string to_string(const NcVar& variable) {
  return name_by(nc_inq_varname, group_of(variable), variable.getId());
}

std::string to_string(const netCDF::NcDim& dimension) {
  return name_by(nc_inq_dimname, group_of(dimension), dimension.getId());
}

std::vector<std::string> attribute_names(const NcVar& variable) {
  std::vector<std::string> names;
  for (int number = 0; number < variable.getAttCount(); ++number)
    names.push_back(name_by(nc_inq_attname, group_of(variable), variable.getId(), number));
  return names;
}

int type_of(const NcVar& variable) {
  nc_type type = NC_NAT;
  check(nc_inq_vartype(group_of(variable), variable.getId(), &type));
  return type;
}

Attribute::Attribute(const NcVar& variable, const std::string& name) {
  nullObject = false;
  groupId = group_of(variable);
  varId = variable.getId();
  myName = name;
}

std::optional<Attribute> find_attribute(const NcVar& variable, const std::string& name) {
  Attribute found(variable, name);
  const int status =
      nc_inq_att(group_of(variable), variable.getId(), name.c_str(), &found.type, &found.length);
  if (names_nothing(status)) return std::nullopt;
  check(status);
  return found;
}

void copy_attribute(const NcVar& from, const std::string& name, const NcVar& to) {
  check(nc_copy_att(group_of(from), from.getId(), name.c_str(), group_of(to), to.getId()));
}

void remove_attribute(const NcVar& variable, const std::string& name) {
  netCDF::ncCheckDefineMode(group_of(variable));
  check(nc_del_att(group_of(variable), variable.getId(), name.c_str()));
}

}  // namespace pcor::internal
