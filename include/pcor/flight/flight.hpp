#pragma once

#include <pcor/units/units.hpp>

#include <array>
#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pcor {

namespace internal {
class FlightFile;
}

/// Consecutive records of a flight.
struct RecordBlock {
  std::size_t first = 0;
  std::size_t count = 0;
};

/// A flight is read and written by blocks of so many records, so memory does not grow with its length.
constexpr std::size_t records_per_block = 4096;

/// All of `records` as blocks of at most `size`, in order.
std::vector<RecordBlock> blocks_of(std::size_t records, std::size_t size = records_per_block);

/// What a file says of one variable.
struct VariableInfo {
  std::string name;
  std::string units;       ///< as the file spells it; empty if it does not say
  std::string long_name;   ///< empty if absent
  bool is_series = false;  ///< numbers over (Time) or (Time, spsN): can be read as a time series
  int rate = 0;            ///< samples per record: 1, or N of (Time, spsN); 0 if not a time series
  std::vector<std::string> dimensions;
  std::vector<std::pair<std::string, std::string>> attributes;  ///< all of them as text, without trailing NUL
  std::vector<std::string> flags;  ///< variables of flags that call samples unusable, which are missing then
  std::string ignored_range;       ///< what the file states as valid values in words that are no numbers
  std::optional<std::array<double, 2>> modulus_range;  ///< of an angle: where it starts again
};

/// The attribute Category of what a simulated flight holds beside what was recorded: what really was.
inline constexpr std::string_view truth_category = "Truth";

/// Where the step to the next record is more than half as long again as the usual one.
struct TimeGap {
  std::size_t record = 0;  ///< the first record after the gap
  double before = 0;       ///< time of the record before it, seconds since 1970 UTC
  double after = 0;        ///< time of the first record after it
};

/// The facts about the time of a flight's records, which strictly increases. Times are seconds since 1970
/// UTC.
struct TimeAxis {
  std::string source;  ///< what the time was read from, in words
  double first = 0;
  double last = 0;
  double step = 1;            ///< the usual step between records, s: the median over the first block
  bool whole_seconds = true;  ///< every time is a whole second
  std::size_t gap_count = 0;
  std::vector<TimeGap> gaps;                ///< the first thousand of them
  std::vector<std::size_t> midnight_wraps;  ///< records at which seconds of the day began again at zero
};

/// Recorded numbers that are taken as missing though the file does not mark them so, counted by the reason.
struct RejectedCounts {
  std::size_t impossible = 0;  ///< the conversion calls them so
  std::size_t invalid = 0;     ///< outside the range that the file states as valid
  std::size_t enormous = 0;    ///< 1e30 and more, infinity too

  RejectedCounts& operator+=(const RejectedCounts& other) {
    impossible += other.impossible;
    invalid += other.invalid;
    enormous += other.enormous;
    return *this;
  }
};

/// Which moment of its interval a record's time is. NCAR files have both; half a second is 0.9 hPa in a
/// climb.
enum class TimestampAlignment { begin, middle };

/// A flight in a file of the NCAR-RAF/nimbus conventions, old or new, at 1 Hz, at higher rates, or both. The
/// file is netCDF; another format is a class of its own beside that of netCDF.
///
/// All reading is by blocks of records. Missing values, however the file marks them (`_FillValue`,
/// `missing_value`, `MissingValue`, the default fill value, -32767 in a file that marks none, NaN, what
/// `valid_range`, `valid_min` and `valid_max` leave out, 1e30 and more, what flags beside the variable call
/// bad or missing, see `VariableInfo::flags`), become NaN. `scale_factor`, `add_offset` and `_Unsigned` are
/// applied. Objects of this class are not for use by several threads at once, nor are two of them: the netCDF
/// library is not made for it.
class Flight {
 public:
  /// Opens the file and checks its time axis.
  ///
  /// The time is that of the variable `Time` (or `time`) by its units; where these are absent or impossible,
  /// with `base_time` or the global attributes `FlightDate` and `TimeInterval`; without such a variable it is
  /// `base_time` + `time_offset`. Seconds of the day that begin again at midnight are carried on.
  ///
  /// @throws Error if the file is absent, not netCDF, truncated, without records or with more than a hundred
  /// million, has two variables of one name, or if a time is missing, repeated, earlier than the one before,
  /// of a year without flights, or cannot be told at all. Gaps are no error, see `time()`.
  explicit Flight(const std::filesystem::path& path,
                  TimestampAlignment timestamp_alignment = TimestampAlignment::begin);

  /// The same for a file of any format that is open already.
  Flight(std::unique_ptr<internal::FlightFile> file, TimestampAlignment timestamp_alignment);

  Flight(Flight&&) noexcept;
  Flight& operator=(Flight&&) noexcept;
  ~Flight();

  /// The file, which is open as long as the flight.
  const internal::FlightFile& file() const;

  const std::filesystem::path& path() const;
  std::size_t records() const;
  /// All records in blocks that are best read one after the other, every variable of one before the next.
  std::vector<RecordBlock> blocks() const;
  const TimeAxis& time() const;
  TimestampAlignment timestamp_alignment() const;

  /// The variable that holds the time: "Time", "time" or "time_offset".
  const std::string& time_variable() const;

  /// A global attribute as text; empty if absent. Its name is looked for without regard to case where none is
  /// spelt so.
  std::string attribute(const std::string& name) const;

  /// `platform`, `Aircraft`, `tail_number` or `platform_name`, else a registration in `source` or `title`.
  std::string aircraft() const;
  std::string project() const;        ///< `project`, in old files `ProjectName`, or `campaign`
  std::string flight_number() const;  ///< `FlightNumber` or `flight_number`

  /// The names of all variables, in the file's order.
  const std::vector<std::string>& variables() const;
  bool has(const std::string& name) const;

  /// What the file says of a variable. @throws Error with the names that look like it, if it is absent.
  const VariableInfo& variable(const std::string& name) const;

  /// The conversion of a variable's values to the unit `wanted`.
  ///
  /// `role` is what the model file calls the variable, for the message. `stated`, if not empty, is the unit
  /// that the model file states; it takes the place of the file's own.
  ///
  /// @throws Error as UnitConversion::between, or if the variable is absent: with a role, the message has the
  /// names that begin and look like it among the time series whose unit fits, or else up to six of these time
  /// series.
  UnitConversion conversion(const std::string& name, const std::string& wanted, const std::string& role = "",
                            const std::string& stated = "") const;

  /// @throws Error if the variable is not a time series or has no value anywhere. Reads until it finds one.
  void require_values(const std::string& name) const;

  /// Reads `block.count * rate` values at the variable's own rate, converted, into `out`. Missing is NaN.
  /// @return what is missing though the file does not mark it so
  /// @throws Error if the variable is absent, not a time series, or has an attribute by which its numbers
  /// cannot be told, if the block goes beyond the last record, or the file was replaced or changed meanwhile.
  RejectedCounts read(const std::string& name, RecordBlock block, const UnitConversion& conversion,
                      double* out) const;

  /// Reads `block.count * rate` values at the wanted rate. The variable's own rate is exact. A lower one is
  /// held constant over its interval. A higher one gives the mean of the values that are there (NaN if there
  /// are none); for an angle (`modulus_range`) the mean on the circle.
  /// Values that are left out, which are counted at the variable's own rate, take no part in a mean.
  /// @throws Error as `read`, and if neither rate is a multiple of the other.
  RejectedCounts read_at_rate(int rate, const std::string& name, RecordBlock block,
                              const UnitConversion& conversion, double* out) const;

  /// The times of the records as the file has them, seconds since 1970 UTC: `block.count` values.
  void read_time_stamps(RecordBlock block, double* out) const;

  /// The middles of the samples' intervals, seconds since 1970 UTC: `block.count * rate` values.
  ///
  /// A record covers one usual step, which begins at its time stamp or half a step before it
  /// (`TimestampAlignment`), and its samples divide it evenly: sample k of N lies at begin + (k + 1/2) / N *
  /// step.
  void read_sample_times(RecordBlock block, int rate, double* out) const;

 private:
  std::string first_attribute(std::initializer_list<const char*> names) const;

  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace pcor
