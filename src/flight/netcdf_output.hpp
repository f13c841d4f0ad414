#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <pcor/flight/flight_writer.hpp>
#include "flight/netcdf_file.hpp"

namespace pcor::internal {

/// How an open netCDF file is stored.
FileKind kind_of(const NetcdfFile& file);

/// A new netCDF file whose variables lie over an unlimited `Time`.
class NetcdfOutput {
 public:
  /// Creates it, over what is there. Messages call it `shown_path`.
  NetcdfOutput(const std::filesystem::path& path, const std::filesystem::path& shown_path, FileKind kind);

  int id() const { return file_.id(); }
  const NetcdfFile& file() const { return file_; }
  int time_dimension() const { return time_dimension_; }
  bool is_hdf5() const { return is_hdf5_; }
  bool has(const std::string& name) const { return file_.find_variable(name).has_value(); }

  /// @throws Error with the reason unless `status` is NC_NOERR.
  void check(int status) const { file_.check(status, "cannot be written"); }

  /// Whether a dimension of this name has another length already.
  bool has_other_length(const std::string& dimension, std::size_t length) const;

  /// The dimension of this name and length, a new one if there is none. @throws Error if it has another
  /// length.
  int dimension(const std::string& name, std::size_t length);

  /// The dimensions of a time series of `rate` samples a record: (Time) or (Time, spsN).
  std::vector<int> dimensions_of_series(std::size_t rate);

  /// Adds a variable, stored in chunks of about a thousand records if it lies over Time. Gives its number.
  int add_variable(const std::string& name, int type, const std::vector<int>& dimensions);

  /// Nothing is put where there is no text.
  void put_text(int variable, const std::string& name, const std::string& text) const;

  /// Ends the definition; no variable may be added after it.
  void end_definition();
  bool is_defining() const { return is_defining_; }

  /// Removes attributes that turned out to have no value: variables and names.
  void remove(const std::vector<std::pair<int, std::string>>& attributes) const;

  void close() { file_.close(); }

 private:
  void store_in_chunks(int variable, int type, const std::vector<int>& dimensions) const;

  NetcdfFile file_;
  bool is_hdf5_;
  bool is_defining_ = true;
  int time_dimension_ = 0;
  std::map<std::string, int> dimensions_;  // but Time
};

}  // namespace pcor::internal
