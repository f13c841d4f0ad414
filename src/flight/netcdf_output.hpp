#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "flight/netcdf_file.hpp"

namespace pcor::internal {

/// A new netCDF file whose variables lie over an unlimited `Time`. Callers use `attempt`: the functions below
/// may throw exceptions of netcdf-cxx4.
class NetcdfOutput final : public NetcdfFile {
 public:
  /// Creates it, over what is there. Messages call it `shown_path`.
  NetcdfOutput(const std::filesystem::path& path, const std::filesystem::path& shown_path, NetcdfFormat kind);

  const netCDF::NcDim& time() const { return time_; }
  bool has(const std::string& name) const { return find_variable(name).has_value(); }

  /// Whether the dimension `name` already exists with another length.
  bool has_other_length(const std::string& dimension, std::size_t length) const;

  /// The dimension with this name and length, created if absent. @throws Error if it has another length.
  netCDF::NcDim dimension_of(const std::string& name, std::size_t length);

  /// The dimensions of a time series of `rate` samples a record: (Time) or (Time, spsN).
  std::vector<netCDF::NcDim> dimensions_of_series(std::size_t rate);

  /// Adds a variable, stored in chunks of about a thousand records if it lies over Time. Gives its number.
  int add_variable(const std::string& name, netCDF::NcType type,
                   const std::vector<netCDF::NcDim>& dimensions);

  /// Nothing is put where there is no text. @param variable or `whole_file`
  void put_text(int variable, const std::string& name, const std::string& text) const;

  /// Removes an attribute if it is there.
  void drop(int variable, const std::string& attribute) const;

  /// Ends the definition; no variable may be added after it.
  void end_definition() { file_.enddef(); }

  /// Closes for good; errors that the library kept until now are thrown.
  void close() {
    attempt("cannot be closed", [&] { file_.close(); });
  }

 private:
  Error error_of(int status, const std::string& message) const override;

  netCDF::NcDim time_;
};

}  // namespace pcor::internal
