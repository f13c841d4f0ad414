#pragma once

#include <string>
#include <vector>

#include <pcor/flight/flight_writer.hpp>
#include "flight/netcdf_output.hpp"

namespace pcor::internal {

/// What the CF conventions want said of the variables of a flight once all of them are defined: where the
/// aircraft was, in units that say north and east, named by every time series that it is known for; the
/// trajectory; and no attribute that names a variable which is not there.
class CfDescription {
 public:
  /// Both must outlive it.
  CfDescription(const FileDescription& description, NetcdfOutput& output)
      : description_(description), output_(output) {}

  /// Completes what is defined. Coordinates of the description that are not in the output, or not in degrees,
  /// count as none.
  /// @param flight what the flight is called
  void complete(const std::string& flight);

  /// Writes the name of the trajectory, after the definition.
  void write() const;

 private:
  struct Coordinate {
    std::string name;
    int variable = 0;
    std::vector<int> dimensions;
  };

  const NetcdfFile& file() const { return output_.file(); }
  void find_coordinates();
  bool add(const std::string& name);
  bool add_degrees(const std::string& name, const char* unit, const char* standard_name);
  void describe_series() const;
  void name_coordinates_of(int variable) const;
  void keep_known_names(int variable, const char* attribute) const;
  void describe_whole_file() const;
  void define_trajectory(const std::string& flight);
  void drop(int variable, const std::string& attribute) const;

  const FileDescription& description_;
  NetcdfOutput& output_;
  std::vector<Coordinate> coordinates_;
  bool has_track_ = false;  // both the latitude and the longitude of every record
  std::string trajectory_;
  int trajectory_variable_ = -1;  // not another program's
};

}  // namespace pcor::internal
