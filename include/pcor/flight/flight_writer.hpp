#pragma once

#include <pcor/flight/flight.hpp>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace pcor {

/// One bit of a variable of flags.
struct Flag {
  int mask = 0;         ///< the bit, e.g. 4
  std::string meaning;  ///< one word, e.g. "low_speed"
};

/// A variable to be written: 32-bit floats, or with `flags` 32-bit integers.
struct OutputVariable {
  std::string name;
  int rate = 1;  ///< samples per record
  std::string units;
  std::string long_name;
  std::string standard_name;                     ///< of the CF table; empty if it has none
  std::string category;                          ///< of the NCAR conventions, e.g. "Thermodynamic"
  std::vector<std::string> dependencies;         ///< the variables it was computed from
  std::vector<std::string> ancillary_variables;  ///< e.g. the flags that qualify it
  std::vector<Flag> flags;
  std::string data_quality = "Preliminary";
  std::vector<std::pair<std::string, std::string>> attributes;  ///< further ones, text
};

/// What a new file says of itself.
struct FileDescription {
  std::string title;    ///< empty: as in the input, else composed from project, flight and aircraft
  std::string summary;  ///< empty: as in the input, else the title
  std::string history;  ///< what makes this file, e.g. the command line; it is dated and put before what was
                        ///< done before
  std::string latitude, longitude, altitude;  ///< variables of the output that say where the aircraft was
  std::string altitude_standard_name = "altitude";  ///< of the CF table, where the variable states none
  std::vector<std::pair<std::string, std::string>>
      attributes;  ///< further global ones; they replace the input's
};

/// How a netCDF file is stored.
enum class NetcdfFormat { classic, offset64, cdf5, netcdf4, netcdf4_classic };

/// What a flight that comes from no file needs instead of an input.
struct NewFlight {
  double first_time =
      0;  ///< of the first record, seconds since 1970 UTC; its midnight is where `Time` counts from
  bool whole_seconds = true;
  NetcdfFormat kind = NetcdfFormat::netcdf4;
};

/// Writes a flight to a netCDF file by the CF and ACDD conventions, whole or not at all. Those of
/// NCAR-RAF/nimbus are kept where the input claims them, and by a new flight; `Conventions` names those that
/// are kept: CF not where a copied variable has a unit that UDUNITS does not know.
///
/// The coordinates get the units degrees_north and degrees_east, and every time series names those that are
/// known for it. A flight with both is a CF trajectory, with a variable `trajectory_id`. What an attribute of
/// a copied variable names is in the output, or is not named.
///
/// The data go to a hidden file beside the output, which `finish` puts in its place; whatever fails before
/// that leaves an existing output as it was. First `define` and `copy` every variable, then `write` each of
/// the defined ones in full, by blocks, then `finish`. The kind of file is that of the input, netCDF-4 where
/// the input has another format, or the one that `NewFlight` asks for.
///
/// The time is an integer `Time`, seconds since the midnight before the first record, or a double where the
/// times are not whole seconds. Every error names the output and is one line; after one, write nothing more.
class FlightWriter {
 public:
  /// A file with the records of `input`, which must outlive the writer: the times and global attributes are
  /// taken over.
  ///
  /// @throws Error if the output is the input's file (also by a link), is there but not a regular file, or
  /// cannot be created.
  FlightWriter(std::filesystem::path output, const Flight& input, const FileDescription& description);

  /// A file from nothing; its times are written with `write_time_stamps`. @throws Error as above.
  FlightWriter(std::filesystem::path output, const NewFlight& flight, const FileDescription& description);

  FlightWriter(FlightWriter&&) noexcept;
  FlightWriter& operator=(FlightWriter&&) noexcept;

  /// Removes what was written if `finish` was not reached.
  ~FlightWriter();

  /// Adds a variable and gives its number for `write`. @throws Error if the name is taken.
  std::size_t define(const OutputVariable& variable);

  /// Copies a variable of the input, of any type and shape, with its values and attributes as they are,
  /// except that units which UDUNITS does not know get its spelling ("M/s" becomes "m/s"), trailing NULs are
  /// cut off, markers of missing values get the variable's type, and one that has no name in words is called
  /// by its own. The input's time variable is not copied: `Time` takes its place.
  /// Attributes of types that the file makes itself are left out. Of an input that is not a netCDF file, time
  /// series are copied, in double precision.
  /// @throws Error if there is no input, no such variable, the name is taken, or it is not one to copy.
  void copy(const std::string& name);

  /// Whether the input has a variable of this name that is one to copy: not if it holds texts, of more than
  /// one letter each, if its type is one that the file makes itself (compound, enum, opaque, variable
  /// length), if Time is not the first of its dimensions, or if one of them is in the output with another
  /// length.
  bool can_copy(const std::string& name) const;

  /// Whether a name is taken in the output.
  bool has(const std::string& name) const;

  /// Writes the times of records, seconds since 1970 UTC, strictly increasing. Only for a new flight.
  void write_time_stamps(RecordBlock block, const double* times);

  /// Writes `block.count * rate` values. NaN, infinities and what a float cannot hold become the fill value
  /// -32767; flags must be whole numbers. @throws Error if the disk is full or flags are not whole.
  void write(std::size_t variable, RecordBlock block, const double* values);

  /// Copies what is to be copied, completes the attributes that depend on the data and puts the file in
  /// place.
  /// @throws Error if a variable was not written for all records or the file cannot be completed.
  void finish();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace pcor
