#pragma once

#include <pcor/flight/flight.hpp>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace pcor {

/// Bit of a flag variable.
struct Flag {
  int mask = 0;         ///< the bit, e.g. 4
  std::string meaning;  ///< one word, e.g. "low_speed"
};

/// Variable to be written: 32-bit floats, or with `flags` 32-bit integers.
struct OutputVariable {
  std::string name;
  int rate = 1;  ///< samples per record
  std::string units;
  std::string long_name;
  std::string standard_name;                     ///< CF standard name; empty if there is no such name
  std::string category;                          ///< NCAR category, e.g. "Thermodynamic"
  std::vector<std::string> dependencies;         ///< variables from which it was computed
  std::vector<std::string> ancillary_variables;  ///< e.g. flag variables that qualify it
  std::vector<Flag> flags;
  std::string data_quality = "Preliminary";
  std::vector<std::pair<std::string, std::string>> attributes;  ///< further attributes, text
};

/// Global metadata of a new file.
struct FileDescription {
  /// Empty: from the input, otherwise composed of project, flight and aircraft. A file without a summary gets
  /// the title as its summary.
  std::string title;
  /// Command that creates the file, e.g. the command line; dated and placed before the input's history.
  std::string history;
  std::string latitude, longitude, altitude;        ///< variables of the aircraft's position in the output
  std::string altitude_standard_name = "altitude";  ///< default CF standard name
  /// Further global attributes; they replace the input's.
  std::vector<std::pair<std::string, std::string>> attributes;
};

/// Storage format of a netCDF file.
enum class NetcdfFormat { classic, offset64, cdf5, netcdf4, netcdf4_classic };

/// Time axis and format of a flight without input file.
struct NewFlight {
  /// Time of the first record, seconds since 1970 UTC; `Time` counts from the midnight before it.
  double start_time = 0;
  bool whole_seconds = true;
  NetcdfFormat kind = NetcdfFormat::netcdf4;
};

/// Writes a flight atomically to a netCDF file by the CF and ACDD conventions. The NCAR-RAF/nimbus
/// conventions are followed for new flights and if the input claims them; `Conventions` lists the conventions
/// satisfied: CF is omitted if a copied variable has a unit unknown to UDUNITS.
///
/// The coordinates get the units degrees_north and degrees_east, and every time series names its known
/// coordinates. A flight with both is a CF trajectory, with a variable `trajectory_id`. Attributes of copied
/// variables name only variables that are in the output.
///
/// Data are written to a hidden file in the directory of the output, which `finish` renames; a failure before
/// that leaves an existing output unchanged. First `define` and `copy` every variable, then `write` each
/// defined variable completely, by blocks, then `finish`. The netCDF format is that of the input, netCDF-4
/// for inputs in another format, or `NewFlight::kind`.
///
/// Time is an integer `Time`, seconds since the midnight before the first record, or a double if the times
/// are not whole seconds. Every error names the output and is one line; after an error, do not write further.
class FlightWriter {
 public:
  /// Creates a file with the records, times and global attributes of `input`, which must outlive the writer.
  ///
  /// @throws Error if the output is the input's file (also by a link), exists but is not a regular file, or
  /// cannot be created.
  FlightWriter(const std::filesystem::path& output, const Flight& input, const FileDescription& description);

  /// Creates a file without input; its times are written with `write_time_stamps`. @throws Error as above.
  FlightWriter(const std::filesystem::path& output, const NewFlight& flight,
               const FileDescription& description);

  /// Removes the hidden file if `finish` was not called.
  ~FlightWriter();

  /// Adds a variable and returns its index for `write`. @throws Error if the name is already used.
  std::size_t define(const OutputVariable& variable);

  /// Copies a variable of the input, of any type and shape, with its values and attributes unchanged, except
  /// that units unknown to UDUNITS get its spelling ("M/s" becomes "m/s"), trailing NULs are removed, markers
  /// of missing values get the variable's type, and a missing long_name is set to the variable's name. The
  /// input's time variable is not copied; `Time` replaces it. Attributes of user-defined types are omitted.
  /// From an input that is not netCDF, time series are copied in double precision.
  /// @throws Error if there is no input, no such variable, the name is already used, or the variable cannot
  /// be copied.
  void copy(const std::string& name);

  /// True if the input has the variable and it can be copied. False for text of more than one character per
  /// element, a user-defined type (compound, enum, opaque, variable length), a variable whose first dimension
  /// is not Time, or a dimension that exists in the output with another length.
  bool can_copy(const std::string& name) const;

  /// True if the name is used in the output.
  bool has(const std::string& name) const;

  /// Writes the times of records, seconds since 1970 UTC, strictly increasing. Only for a new flight.
  void write_time_stamps(RecordBlock block, const double* times);

  /// Writes `block.count * rate` values. NaN, infinities and values outside the range of a float become the
  /// fill value -32767; flags must be whole numbers. @throws Error if the disk is full or flags are not
  /// whole.
  void write(std::size_t variable, RecordBlock block, const double* values);

  /// Copies the next records of the variables of `copy` and of the time. Optional: if it is called for the
  /// blocks of the input while these are read, the files are read and written once. Only with an input.
  void copy_records(RecordBlock block);

  /// Copies the remaining records of the variables of `copy`, completes the attributes that depend on the
  /// data and renames the file to the output.
  /// @throws Error if a variable was not written for all records or the file cannot be completed.
  void finish();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace pcor
