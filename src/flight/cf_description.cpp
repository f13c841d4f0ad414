#include "flight/cf_description.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <netcdf.h>

#include <algorithm>

#include <pcor/units/units.hpp>
#include "words/phrasing.hpp"

namespace pcor::internal {
namespace {

constexpr const char* degrees = "degree";

/// Whether values in the unit are degrees. What says nothing, or nothing that is known, is believed to be.
bool is_in_degrees(const std::string& unit) {
  if (!is_known_unit(unit)) return true;
  if (!is_convertible(unit, degrees)) return false;
  const UnitConversion conversion = UnitConversion::between(unit, degrees, {});
  return conversion.scale() == 1.0 && conversion.offset() == 0.0;
}

}  // namespace

void CfDescription::complete(const std::string& flight) {
  find_coordinates();
  describe_series();
  describe_whole_file();
  if (has_track_) define_trajectory(flight);
}

void CfDescription::write() const {
  if (trajectory_variable_ >= 0)
    output_.check(nc_put_var_text(output_.id(), trajectory_variable_, trajectory_.c_str()));
}

bool CfDescription::add(const std::string& name) {
  const std::optional<int> variable = file().find_variable(name);
  if (name.empty() || !variable) return false;
  coordinates_.push_back({name, *variable, file().dimensions_of(*variable)});
  return true;
}

bool CfDescription::add_degrees(const std::string& name, const char* unit, const char* standard_name) {
  const std::optional<int> variable = file().find_variable(name);
  if (name.empty() || !variable || !is_in_degrees(file().text_attribute(*variable, "units"))) return false;
  output_.put_text(*variable, "units", unit);
  output_.put_text(*variable, "standard_name", standard_name);
  return add(name);
}

void CfDescription::find_coordinates() {
  const bool has_latitude = add_degrees(description_.latitude, "degrees_north", "latitude");
  const bool has_longitude = add_degrees(description_.longitude, "degrees_east", "longitude");
  has_track_ = has_latitude && has_longitude &&
               std::all_of(coordinates_.begin(), coordinates_.end(),
                           [](const Coordinate& each) { return each.dimensions.size() == 1; });
  if (!add(description_.altitude)) return;
  const int height = coordinates_.back().variable;
  if (file().text_attribute(height, "standard_name").empty())
    output_.put_text(height, "standard_name", description_.altitude_standard_name);
  output_.put_text(height, "positive", "up");
}

void CfDescription::describe_series() const {
  for (int variable = 0; variable < file().variable_count(); ++variable) {
    for (const char* const names : {"ancillary_variables", "bounds"}) keep_known_names(variable, names);
    drop(variable, "coordinates");
    const std::vector<int> dimensions = file().dimensions_of(variable);
    const bool is_series = !dimensions.empty() && dimensions.front() == output_.time_dimension();
    const bool is_place =
        std::any_of(coordinates_.begin(), coordinates_.end(),
                    [variable](const Coordinate& each) { return each.variable == variable; });
    if (is_series && !is_place && file().variable_name(variable) != "Time") name_coordinates_of(variable);
  }
}

/// Those that are known at every value of the variable.
void CfDescription::name_coordinates_of(int variable) const {
  const std::vector<int> dimensions = file().dimensions_of(variable);
  std::vector<std::string> names;
  for (const Coordinate& each : coordinates_) {
    const bool fits =
        std::all_of(each.dimensions.begin(), each.dimensions.end(), [&dimensions](int dimension) {
          return std::find(dimensions.begin(), dimensions.end(), dimension) != dimensions.end();
        });
    if (fits) names.push_back(each.name);
  }
  output_.put_text(variable, "coordinates", fmt::format("{}", fmt::join(names, " ")));
}

/// Of the names in an attribute, those of variables that are there.
void CfDescription::keep_known_names(int variable, const char* attribute) const {
  const std::vector<std::string> names = words_of(file().text_attribute(variable, attribute));
  std::vector<std::string> known;
  for (const std::string& name : names) {
    if (output_.has(name)) known.push_back(name);
  }
  if (known.size() == names.size()) return;
  drop(variable, attribute);
  output_.put_text(variable, attribute, fmt::format("{}", fmt::join(known, " ")));
}

/// The global attributes that say where the aircraft was are those of this file, not of the input.
void CfDescription::describe_whole_file() const {
  const struct {
    const std::string& variable;
    const char *coordinate, *range;
  } places[] = {{description_.latitude, "latitude_coordinate", "geospatial_lat"},
                {description_.longitude, "longitude_coordinate", "geospatial_lon"},
                {description_.altitude, "zaxis_coordinate", "geospatial_vertical"}};
  std::vector<std::string> names;
  for (const auto& place : places) {
    const std::optional<int> variable = file().find_variable(place.variable);
    const std::string unit = place.range + std::string("_units");
    if (place.variable.empty() || !variable) {
      for (const std::string end : {"_min", "_max", "_units"}) drop(NC_GLOBAL, place.range + end);
      drop(NC_GLOBAL, place.coordinate);
      continue;
    }
    names.push_back(place.variable);
    output_.put_text(NC_GLOBAL, unit, file().text_attribute(*variable, "units"));
  }
  // Older programs of NCAR look for the names here.
  const bool had_names = !file().text_attribute(NC_GLOBAL, "coordinates").empty();
  drop(NC_GLOBAL, "coordinates");
  if (had_names && !names.empty())
    output_.put_text(NC_GLOBAL, "coordinates", fmt::format("{} Time", fmt::join(names, " ")));
  for (const char* const kind : {"featureType", "cdm_data_type"}) drop(NC_GLOBAL, kind);
}

void CfDescription::define_trajectory(const std::string& flight) {
  output_.put_text(NC_GLOBAL, "featureType", "trajectory");
  output_.put_text(NC_GLOBAL, "cdm_data_type", "Trajectory");
  for (int variable = 0; variable < file().variable_count(); ++variable) {
    if (file().text_attribute(variable, "cf_role") == "trajectory_id") return;
  }
  trajectory_ = flight;
  const std::string name = output_.has("trajectory_id") ? "trajectory_id_of_flight" : "trajectory_id";
  const int length = output_.dimension(name + "_strlen", trajectory_.size());
  trajectory_variable_ = output_.add_variable(name, NC_CHAR, {length});
  output_.put_text(trajectory_variable_, "long_name", "project, flight and date");
  output_.put_text(trajectory_variable_, "cf_role", "trajectory_id");
}

void CfDescription::drop(int variable, const std::string& attribute) const {
  if (file().find_attribute(variable, attribute))
    output_.check(nc_del_att(output_.id(), variable, attribute.c_str()));
}

}  // namespace pcor::internal
