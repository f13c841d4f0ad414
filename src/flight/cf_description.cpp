#include "flight/cf_description.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include <pcor/units/units.hpp>
#include "base/phrasing.hpp"

namespace pcor::internal {
namespace {

constexpr const char* degrees = "degree";

/// Whether values in the unit are degrees. An absent or unknown unit counts as degrees.
bool is_in_degrees(const std::string& unit) {
  if (!is_known_unit(unit)) return true;
  if (!is_convertible(unit, degrees)) return false;
  const UnitConversion conversion = UnitConversion::between(unit, degrees, {});
  return conversion.scale() == 1.0 && conversion.offset() == 0.0;
}

constexpr int global = FlightFile::whole_file;

class CfDescription {
 public:
  CfDescription(const FileDescription& description, NetcdfOutput& output)
      : description_(description), output_(output) {}

  std::optional<int> complete(const std::string& flight) {
    find_coordinates();
    describe_series();
    describe_whole_file();
    return has_track_ ? define_trajectory(flight) : std::nullopt;
  }

 private:
  struct Coordinate {
    std::string name;
    int variable = 0;
    std::vector<int> dimensions;
  };

  bool add(const std::string& name) {
    const std::optional<int> variable = output_.find_variable(name);
    if (name.empty() || !variable) return false;
    coordinates_.push_back({name, *variable, output_.dimensions_of(*variable)});
    return true;
  }

  bool add_degrees(const std::string& name, const char* unit, const char* standard_name) {
    const std::optional<int> variable = output_.find_variable(name);
    if (name.empty() || !variable || !is_in_degrees(output_.text_attribute(*variable, "units"))) return false;
    output_.put_text(*variable, "units", unit);
    output_.put_text(*variable, "standard_name", standard_name);
    return add(name);
  }

  void find_coordinates() {
    const bool has_latitude = add_degrees(description_.latitude, "degrees_north", "latitude");
    const bool has_longitude = add_degrees(description_.longitude, "degrees_east", "longitude");
    has_track_ = has_latitude && has_longitude &&
                 std::all_of(coordinates_.begin(), coordinates_.end(),
                             [](const Coordinate& each) { return each.dimensions.size() == 1; });
    if (!add(description_.altitude)) return;
    const int height = coordinates_.back().variable;
    if (output_.text_attribute(height, "standard_name").empty())
      output_.put_text(height, "standard_name", description_.altitude_standard_name);
    output_.put_text(height, "positive", "up");
  }

  void describe_series() const {
    for (int variable = 0; variable < output_.variable_count(); ++variable) {
      for (const char* const names : {"ancillary_variables", "bounds"}) keep_known_names(variable, names);
      output_.drop(variable, "coordinates");
      const std::vector<int> dimensions = output_.dimensions_of(variable);
      const bool is_series = !dimensions.empty() && dimensions.front() == output_.time().getId();
      const bool is_place =
          std::any_of(coordinates_.begin(), coordinates_.end(),
                      [variable](const Coordinate& each) { return each.variable == variable; });
      if (is_series && !is_place && output_.variable_name(variable) != "Time") name_coordinates_of(variable);
    }
  }

  /// Those that are known at every value of the variable.
  void name_coordinates_of(int variable) const {
    const std::vector<int> dimensions = output_.dimensions_of(variable);
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

  /// The names in an attribute for which a variable exists.
  void keep_known_names(int variable, const char* attribute) const {
    const std::vector<std::string> names = split_words(output_.text_attribute(variable, attribute));
    std::vector<std::string> known;
    for (const std::string& name : names) {
      if (output_.has(name)) known.push_back(name);
    }
    if (known.size() == names.size()) return;
    output_.drop(variable, attribute);
    output_.put_text(variable, attribute, fmt::format("{}", fmt::join(known, " ")));
  }

  /// The global attributes of the position belong to this file, not to the input.
  void describe_whole_file() const {
    std::vector<std::string> names;
    for (const GeospatialRange& each : geospatial_ranges) {
      const std::string range = each.range, &name = description_.*each.variable;
      const std::optional<int> variable = output_.find_variable(name);
      if (name.empty() || !variable) {
        for (const char* const end : {"_min", "_max", "_units"}) output_.drop(global, range + end);
        output_.drop(global, each.coordinate);
        continue;
      }
      names.push_back(name);
      output_.put_text(global, range + "_units", output_.text_attribute(*variable, "units"));
    }
    // Older programs of NCAR look for the names here.
    const bool had_names = !output_.text_attribute(global, "coordinates").empty();
    output_.drop(global, "coordinates");
    if (had_names && !names.empty())
      output_.put_text(global, "coordinates", fmt::format("{} Time", fmt::join(names, " ")));
    for (const char* const kind : {"featureType", "cdm_data_type"}) output_.drop(global, kind);
  }

  std::optional<int> define_trajectory(const std::string& flight) const {
    output_.put_text(global, "featureType", "trajectory");
    output_.put_text(global, "cdm_data_type", "Trajectory");
    for (int variable = 0; variable < output_.variable_count(); ++variable)
      if (output_.text_attribute(variable, "cf_role") == "trajectory_id") return std::nullopt;
    const std::string name = output_.has("trajectory_id") ? "trajectory_id_of_flight" : "trajectory_id";
    const int trajectory =
        output_.add_variable(name, netCDF::ncChar, {output_.dimension_of(name + "_strlen", flight.size())});
    output_.put_text(trajectory, "long_name", "project, flight and date");
    output_.put_text(trajectory, "cf_role", "trajectory_id");
    return trajectory;
  }

  const FileDescription& description_;
  NetcdfOutput& output_;
  std::vector<Coordinate> coordinates_;
  bool has_track_ = false;  // both the latitude and the longitude of every record
};

}  // namespace

std::optional<int> describe_by_cf(const FileDescription& description, const std::string& flight,
                                  NetcdfOutput& output) {
  return CfDescription(description, output).complete(flight);
}

}  // namespace pcor::internal
