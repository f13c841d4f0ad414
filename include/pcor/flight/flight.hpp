#pragma once

#include <pcor/units/units.hpp>

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pcor {

class FlightFile;  // defined in src/flight: a file of any format

/// Consecutive records of a flight.
struct RecordBlock {
  std::size_t first = 0;
  std::size_t count = 0;
};

/// Records per block; flights are read and written by blocks, so memory does not depend on their length.
constexpr std::size_t records_per_block = 4096;

/// All of `records` as blocks of at most `size`, in order.
std::vector<RecordBlock> blocks_of(std::size_t records, std::size_t size = records_per_block);

/// Metadata of one variable.
struct VariableInfo {
  std::string name;
  std::string units;       ///< spelling of the file; empty if absent
  std::string long_name;   ///< empty if absent
  bool is_series = false;  ///< numbers over (Time) or (Time, spsN): can be read as a time series
  int rate = 0;            ///< samples per record: 1, or N of (Time, spsN); 0 if not a time series
  std::vector<std::pair<std::string, std::string>> attributes;  ///< all of them as text, without trailing NUL
  std::vector<std::string> flags;  ///< flag variables that mark invalid samples, which become missing
  std::string ignored_range;       ///< valid range stated in the file as text that is not numeric
  std::optional<std::array<double, 2>> modulus_range;  ///< wrapping range of an angle

  /// Text of an attribute; empty if absent.
  std::string attribute(std::string_view requested) const {
    for (const auto& [attribute_name, text] : attributes) {
      if (attribute_name == requested) return text;
    }
    return "";
  }
};

/// Attribute Category of true values in a simulated flight.
inline constexpr std::string_view truth_category = "Truth";

/// Time axis of a flight, strictly increasing. Times are seconds since 1970 UTC.
struct TimeAxis {
  double first = 0;
  double last = 0;
  double step = 1;            ///< the usual step between records, s: the median over the first block
  bool whole_seconds = true;  ///< every time is a whole second
  std::size_t gap_count = 0;  ///< intervals between records more than 1.5 times the usual one
  std::vector<std::size_t> midnight_wraps;  ///< records at which seconds of the day restart at zero
};

/// Number of recorded values treated as missing although the file does not mark them, by reason.
struct RejectedCounts {
  std::size_t impossible = 0;  ///< impossible according to the unit conversion
  std::size_t invalid = 0;     ///< outside the valid range stated in the file
  std::size_t enormous = 0;    ///< 1e30 and above, including infinity

  RejectedCounts& operator+=(const RejectedCounts& other) {
    impossible += other.impossible;
    invalid += other.invalid;
    enormous += other.enormous;
    return *this;
  }
};

/// Position of a record's time in its interval. Both are used in NCAR files; half a second corresponds to 0.9
/// hPa in a climb.
enum class TimestampAlignment { begin, middle };

/// Flight in a file of the NCAR-RAF/nimbus conventions, old or new, at 1 Hz, at higher rates, or both. The
/// file is netCDF; other formats have separate implementations.
///
/// Data are read by blocks of records. Missing values become NaN: `_FillValue`, `missing_value`,
/// `MissingValue`, the default fill value, -32767 in a file that marks no missing values, NaN, values outside
/// `valid_range`, `valid_min` and `valid_max`, 1e30 and above, and values marked as bad or missing by flag
/// variables (`VariableInfo::flags`). `scale_factor`, `add_offset` and `_Unsigned` are applied. Not
/// thread-safe, even for separate objects, because the netCDF library is not.
class Flight {
 public:
  /// Opens the file and checks its time axis.
  ///
  /// Time is the variable `Time` (or `time`) in its units; if these are absent or impossible, with
  /// `base_time` or the global attributes `FlightDate` and `TimeInterval`; without such a variable it is
  /// `base_time` + `time_offset`. Seconds of the day are unwrapped at midnight.
  ///
  /// @throws Error if the file is absent, not netCDF, truncated, without records or with more than a hundred
  /// million, has two variables with the same name, or if a time is missing, repeated, decreasing, of a year
  /// without flights, or undetermined. Gaps are not errors, see `time()`.
  explicit Flight(const std::filesystem::path& path,
                  TimestampAlignment timestamp_alignment = TimestampAlignment::begin);

  /// Opens a flight from an open file of any format.
  Flight(std::unique_ptr<FlightFile> file, TimestampAlignment timestamp_alignment);

  Flight(Flight&&) noexcept;
  Flight& operator=(Flight&&) noexcept;
  ~Flight();

  /// File, which stays open for the lifetime of the flight.
  const FlightFile& file() const;

  const std::filesystem::path& path() const;
  std::size_t records() const;
  /// All records in blocks suited to sequential reading, all variables of one block before the next.
  std::vector<RecordBlock> blocks() const;
  const TimeAxis& time() const;
  TimestampAlignment timestamp_alignment() const;

  /// Variable that holds the time: "Time", "time" or "time_offset".
  const std::string& time_variable() const;

  /// Global attribute as text; empty if absent. The name is case-insensitive if there is no exact match.
  std::string attribute(const std::string& name) const;

  /// Attribute `platform`, `Aircraft`, `tail_number` or `platform_name`, otherwise a registration in `source`
  /// or `title`.
  std::string aircraft() const;
  std::string project() const;        ///< `project`, `ProjectName` in old files, or `campaign`
  std::string flight_number() const;  ///< `FlightNumber` or `flight_number`

  /// Names of all variables, in the file's order.
  const std::vector<std::string>& variables() const;
  bool has(const std::string& name) const;

  /// Metadata of a variable. @throws Error with similar names, if it is absent.
  const VariableInfo& variable(const std::string& name) const;

  /// Conversion of a variable's values to the unit `requested`.
  ///
  /// `role` is the role in the model file, for the message. `stated`, if not empty, is the unit in the model
  /// file; it overrides the unit of the flight file.
  ///
  /// @throws Error as UnitConversion::between, or if the variable is absent: with a role, the message lists
  /// time series with a convertible unit and a similar name with the same prefix, or up to six others with a
  /// convertible unit.
  UnitConversion conversion(const std::string& name, const std::string& requested,
                            const std::string& role = "", const std::string& stated = "") const;

  /// @throws Error if the variable is not a time series or has no value anywhere. Reads up to the first
  /// value.
  void require_values(const std::string& name) const;

  /// Reads `block.count * rate` values at the variable's rate, converted, into `out`. Missing is NaN.
  /// @return values rejected although the file does not mark them
  /// @throws Error if the variable is absent, not a time series, or has an attribute that prevents its
  /// decoding, if the block extends beyond the last record, or if values are read from a file that was
  /// replaced or changed since it was opened. Blocks read before come from memory.
  RejectedCounts read(const std::string& name, RecordBlock block, const UnitConversion& conversion,
                      double* out) const;

  /// Reads `block.count * rate` values at the given rate. The rate of the variable is exact. From a lower
  /// rate, values are held constant over their interval; from a higher one, they are means of the valid
  /// values (NaN without valid values); for an angle (`modulus_range`) circular means. Rejected values are
  /// excluded from means and are counted at the variable's rate.
  /// @throws Error as `read`, and if neither rate is a multiple of the other.
  RejectedCounts read_at_rate(int rate, const std::string& name, RecordBlock block,
                              const UnitConversion& conversion, double* out) const;
  /// Reads all records at the given rate: `records() * rate` values.
  RejectedCounts read_at_rate(int rate, const std::string& name, const UnitConversion& conversion,
                              double* out) const;

  /// Reads the means over the records of several series together, by blocks of records, and keeps them for
  /// `read_at_rate` and `require_values`: each pass over a classic file reads all its variables. Series that
  /// are absent or cannot be read are omitted.
  void keep_means(std::set<std::string> names) const;

  /// Times of the records as stored, seconds since 1970 UTC: `block.count` values.
  void read_time_stamps(RecordBlock block, double* out) const;

  /// Centre times of the samples' intervals, seconds since 1970 UTC: `block.count * rate` values.
  ///
  /// A record covers one usual step, starting at its time stamp or half a step before it
  /// (`TimestampAlignment`), and its samples divide it evenly: the centre of sample k of N is begin + (k +
  /// 1/2) / N * step.
  void read_sample_times(RecordBlock block, int rate, double* out) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace pcor
