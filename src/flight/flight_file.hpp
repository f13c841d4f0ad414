#pragma once

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/base/note.hpp>
#include <pcor/flight/flight.hpp>
#include "numerics/missing.hpp"

namespace pcor {

/// An open file of any format that may hold a flight: variables over dimensions, with attributes. `Flight`
/// finds time, units and rates in it.
///
/// Variables and dimensions have the numbers 0, 1, 2 ...
class FlightFile {
 public:
  /// In place of a variable's number: the attributes of the whole file.
  static constexpr int whole_file = -1;

  FlightFile() = default;
  FlightFile(const FlightFile&) = delete;
  FlightFile& operator=(const FlightFile&) = delete;
  virtual ~FlightFile() = default;

  virtual const std::filesystem::path& path() const = 0;

  /// Throws an error: the path of the file, followed by `text` with these values.
  template <class... Values>
  [[noreturn]] void refuse(Error::Code code, fmt::format_string<const Values&...> text,
                           const Values&... values) const {
    throw Error(code, path().string() + fmt::format(text, values...));
  }

  virtual int variable_count() const = 0;
  virtual std::optional<int> find_variable(const std::string& name) const;
  virtual std::string variable_name(int variable) const = 0;
  virtual std::vector<int> dimensions_of(int variable) const = 0;
  virtual std::string dimension_name(int dimension) const = 0;
  virtual std::size_t dimension_length(int dimension) const = 0;

  /// The names of a variable's attributes, or of the file's, in their order.
  virtual std::vector<std::string> attribute_names(int variable) const = 0;

  /// An attribute as text: trailing NULs and blanks are cut off, numbers are joined by ", ". Empty if absent.
  virtual std::string text_attribute(int variable, const std::string& name) const = 0;

  /// An attribute as numbers, also if they are stored as text. Empty if absent or not numeric.
  virtual std::vector<double> number_attribute(int variable, const std::string& name) const = 0;

  /// True where the values are numbers.
  virtual bool is_numeric(int /*variable*/) const { return true; }

  /// The greatest number that the type of a numeric variable holds.
  virtual double max_number(int /*variable*/) const { return std::numeric_limits<double>::max(); }

  /// Numbers that mark missing values of a numeric variable, in the units of `read`.
  virtual std::vector<double> missing_values(int /*variable*/) const { return {}; }

  /// Smallest and largest valid number of a numeric variable, in the units of `read`; infinite if the file
  /// states no range. @throws Error if the stated range is invalid.
  virtual std::array<double, 2> valid_range(int /*variable*/) const {
    return {-internal::infinity, internal::infinity};
  }

  /// Attributes for a range of valid values that are not numbers, which `valid_range` ignores: "valid_range =
  /// \"all\"". Empty without such attributes.
  virtual std::string ignored_range(int /*variable*/) const { return {}; }

  /// Notes on how the file was read, for its user: sentences without a full stop.
  virtual Notes notes() const { return {}; }

  /// Conversion of the stored numbers of a variable to values in its unit, from its attributes scale_factor
  /// and add_offset: 1 and 0 if they are absent. @throws Error if one of them is not a valid number.
  UnitConversion unpacking_of(int variable) const;

  /// Number of records to read as one block, variable by variable.
  virtual std::size_t records_at_once() const { return records_per_block; }

  /// Reads the stored numbers of some records, the first dimension, with all that belongs to them; of a
  /// variable without dimensions its number. @throws Error if they cannot be read.
  virtual void read(int variable, RecordBlock records, double* out) const = 0;
};

namespace internal {

/// Name of a variable for the option -a of ncatted, which reads names with . * + and the like as patterns.
std::string ncatted_name(const std::string& variable);

/// Opens a file of any supported format. @throws Error if it is absent, of an unknown format, damaged or
/// truncated.
std::unique_ptr<FlightFile> open_flight_file(const std::filesystem::path& path);

}  // namespace internal

}  // namespace pcor
