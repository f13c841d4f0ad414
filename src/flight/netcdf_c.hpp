#pragma once

#include <cstddef>
#include <filesystem>
#include <netcdf>
#include <optional>
#include <string>
#include <vector>

#include <pcor/flight/flight_writer.hpp>

/// The functions of the netCDF C library that netcdf-cxx4 4.3 lacks. No other file calls the C library.
/// Errors are exceptions of netcdf-cxx4. An `NcVar` of the number NC_GLOBAL has the attributes of the whole
/// file.
namespace pcor::internal {

/// A file of netcdf-cxx4 that the library reads or writes through a buffer of a given size, in bytes.
class BufferedFile : public netCDF::NcFile {
 public:
  /// Opens for reading. NcFile::open takes no size of a buffer.
  void open(const std::filesystem::path& path, std::size_t buffer);

  /// Replaces an existing file. NcFile::create takes no size of a buffer.
  void create(const std::filesystem::path& path, NetcdfFormat kind, std::size_t buffer);

  /// Closes once. After an error of NcFile::close the destructor of NcFile would close the file again.
  void close();

  /// Closes without a message. The destructor of NcFile prints errors.
  void close_quietly() noexcept;
  ~BufferedFile() override { close_quietly(); }

  /// How the file is stored. NcFile has no function for it.
  NetcdfFormat kind() const;
};

/// Id of a variable; empty if the variable does not exist. NcGroup::getVar would list all variables to find
/// one, with names as below.
std::optional<int> find_variable(const netCDF::NcGroup& file, const std::string& name);

/// Names of any length. The functions of netcdf-cxx4 have room for NC_MAX_NAME bytes, and the library copies
/// the longer names that HDF5 allows beyond it.
std::string to_string(const netCDF::NcVar& variable);
std::string to_string(const netCDF::NcDim& dimension);
std::vector<std::string> attribute_names(const netCDF::NcVar& variable);

/// The type of a variable (an nc_type). NcVar::getType looks for a type that a file defines itself in the
/// file that NcFile::open opened last.
int type_of(const netCDF::NcVar& variable);

/// An attribute by its name. The constructor of NcVarAtt takes its number, and NcAtt::getType has the limit
/// of NcVar::getType.
struct Attribute : netCDF::NcVarAtt {
  Attribute(const netCDF::NcVar& variable, const std::string& name);

  int type = 0;  ///< an nc_type
  std::size_t length = 0;
};

/// Empty if the attribute does not exist. NcVar::getAtt would list all attributes to find one, with names as
/// above, and throws if the attribute does not exist.
std::optional<Attribute> find_attribute(const netCDF::NcVar& variable, const std::string& name);

/// Copies an attribute of any type. netcdf-cxx4 has no function for it.
void copy_attribute(const netCDF::NcVar& from, const std::string& name, const netCDF::NcVar& to);

/// Removes an attribute. netcdf-cxx4 has no function for it.
void remove_attribute(const netCDF::NcVar& variable, const std::string& name);

}  // namespace pcor::internal
