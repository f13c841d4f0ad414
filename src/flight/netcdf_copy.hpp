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

  /// Whether the variable of that name, which is there, is one to copy: see FlightWriter.
  bool can_copy(const std::string& name) const;

  /// Defines the variable of that name in the output. @throws Error if it is not one to copy.
  void define(const std::string& name);

  /// Copies the values of all variables that were defined.
  void copy_values(std::size_t records) const;

 private:
  struct Copied {
    int from = 0, to = 0;          // the numbers of the variables
    std::size_t record_bytes = 0;  // of all of it where it does not lie over time
    bool over_time = false;
    std::vector<std::size_t> shape;  // of one record
  };

  void copy_attribute(int from, int to, const std::string& name, int type_of_variable) const;
  void copy_block(const Copied& variable, RecordBlock block, std::vector<char>& buffer) const;

  const NetcdfFile& source_;
  int time_dimension_;
  NetcdfOutput& output_;
  std::vector<Copied> copied_;
};

}  // namespace pcor::internal
