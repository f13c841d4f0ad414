#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "flight/netcdf_output.hpp"

namespace pcor::internal {

/// Variables and attributes of a netCDF file that are copied into a new one as they are stored. Callers use
/// `attempt` of the output: the functions below may throw exceptions of netcdf-cxx4.
class NetcdfCopy {
 public:
  /// Both files must outlive it. `time_dimension` is that of the source's records.
  NetcdfCopy(const NetcdfFile& source, int time_dimension, NetcdfOutput& output)
      : source_(source), time_dimension_(time_dimension), output_(output) {}

  void copy_global_attributes() const;

  /// Whether the existing variable is copied: see FlightWriter.
  bool can_copy(const std::string& name) const;

  /// Defines the variable in the output. @throws Error if it cannot be copied.
  void define(const std::string& name);

  /// Copies the values of the variables that were defined and have no time dimension.
  void copy_constants();

  /// Copies some records of all other variables that were defined.
  void copy_records(RecordBlock block);

 private:
  struct Copied {
    int from = 0, to = 0;          // the numbers of the variables
    std::size_t record_bytes = 0;  // size of the whole variable if it has no time dimension
    bool over_time = false;
    std::vector<std::size_t> shape;  // size of one record
  };

  void copy_attribute(int from, int to, const std::string& name, int type_of_variable) const;
  void copy_block(const Copied& variable, RecordBlock block);

  const NetcdfFile& source_;
  int time_dimension_;
  NetcdfOutput& output_;
  std::vector<Copied> copied_;
  std::vector<char> buffer_;
};

}  // namespace pcor::internal
