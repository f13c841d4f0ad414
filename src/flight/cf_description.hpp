#pragma once

#include <optional>
#include <string>

#include <pcor/flight/flight_writer.hpp>
#include "flight/netcdf_output.hpp"

namespace pcor::internal {

/// A coordinate of a description and the global attributes that repeat it.
struct GeospatialRange {
  std::string FileDescription::*variable;
  const char *coordinate, *range;  // `range` without _min, _max and _units
};

inline constexpr GeospatialRange geospatial_ranges[] = {
    {&FileDescription::latitude, "latitude_coordinate", "geospatial_lat"},
    {&FileDescription::longitude, "longitude_coordinate", "geospatial_lon"},
    {&FileDescription::altitude, "zaxis_coordinate", "geospatial_vertical"}};

/// Adds the attributes of the CF conventions once all variables of a flight are defined: the position of the
/// aircraft, in degrees north and east, named by every time series for which it is known; the trajectory; and
/// no attribute that names a variable which is not there. Coordinates of the description that are not in the
/// output, or not in degrees, are ignored.
///
/// @param flight the name of the flight
/// @return the number of a variable to which the caller writes `flight` after the definition, if there is one
std::optional<int> describe_by_cf(const FileDescription& description, const std::string& flight,
                                  NetcdfOutput& output);

}  // namespace pcor::internal
