#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcor {

/// Flight regime. The phases (ground to level) follow one another without overlap; the other regimes overlap
/// with phases.
enum class Regime : std::uint8_t {
  ground,
  take_off,
  climb,
  descent,
  level,
  turn,
  pitch_manoeuvre,
  yaw_manoeuvre,
  speed_run,
  reverse_heading,
  circle,
  cloud,
  count
};

inline constexpr std::size_t regime_count = static_cast<std::size_t>(Regime::count);

/// Static metadata of a regime.
struct RegimeInfo {
  std::string_view name;  ///< spelling in files and reports, for example "pitch manoeuvre"
};

/// All regimes in the order of `Regime`.
inline constexpr std::array<RegimeInfo, regime_count> regime_info{{{"ground"},
                                                                   {"take-off"},
                                                                   {"climb"},
                                                                   {"descent"},
                                                                   {"level"},
                                                                   {"turn"},
                                                                   {"pitch manoeuvre"},
                                                                   {"yaw manoeuvre"},
                                                                   {"speed run"},
                                                                   {"reverse heading"},
                                                                   {"circle"},
                                                                   {"cloud"}}};

constexpr const RegimeInfo& info_of(Regime regime) { return regime_info[static_cast<std::size_t>(regime)]; }

/// Regime with the given name; `Regime::count` if unknown.
Regime regime_named(std::string_view name);

/// True for a phase; phases are mutually exclusive.
constexpr bool is_phase(Regime regime) { return regime <= Regime::level; }

/// True for a deliberate manoeuvre, of which a part is not useful.
constexpr bool is_manoeuvre(Regime regime) {
  return regime >= Regime::pitch_manoeuvre && regime <= Regime::circle;
}

/// Input series of the search at one rate, one value for each sample, NaN if missing. Empty: not recorded;
/// regimes that depend on it are not found.
struct FlightMotion {
  std::vector<double> time;            ///< s since 1970 UTC, strictly increasing, gaps possible
  std::vector<double> airspeed;        ///< true airspeed, m/s; empty: the ground speed is used
  std::vector<double> altitude;        ///< m
  std::vector<double> vertical_speed;  ///< m/s; empty: from the altitude
  std::vector<double> roll;            ///< deg, right wing down positive
  std::vector<double> pitch;           ///< deg
  std::vector<double> heading;         ///< true heading, deg
  std::vector<double> attack;          ///< angle of attack, deg; replaces a missing pitch
  std::vector<double> sideslip;        ///< deg
  std::vector<double> ground_speed;    ///< m/s
  std::vector<double> ground_track;    ///< ground track, deg; replaces a missing heading
  std::vector<double> liquid_water;    ///< g/m3
};

/// Half-open time interval [begin, end) of a regime.
struct Interval {
  Regime regime = Regime::count;
  double begin = 0.0;  ///< s since 1970 UTC
  double end = 0.0;    ///< s since 1970 UTC
  int pair = 0;        ///< number of the reverse-heading pair, from 1; otherwise 0
  std::string note{};  ///< description, e.g. "7 cycles of 24 s, +-2.1 deg"; may be empty
};

/// Thresholds of the search. The defaults are those of the NSF/NCAR C-130.
///
/// "QAtools" is NCAR's program of data review, whose searches for manoeuvres, and definitions of them, are
/// the source of most of the numbers; "memo" is Cooper's study of manoeuvres for the calibration of these
/// aircraft. Numbers without a source are defaults of this library.
struct RegimeCriteria {
  double flying_speed = 60.0;      ///< m/s: airborne above it, on the ground below it
  double roll_speed = 15.0;        ///< m/s: the take-off roll has begun above it
  double take_off_height = 300.0;  ///< m above the field at the end of the take-off
  double take_off_time = 60.0;     ///< s: maximum duration of the take-off after reaching flying speed

  double climb_rate = 1.5;        ///< m/s: absolute smoothed vertical speed of a climb or descent
  double climb_smoothing = 60.0;  ///< s, applied twice: more than two periods of a pitch manoeuvre
  double phase_time = 60.0;       ///< s: a shorter climb, descent or level is merged with its neighbour

  double turn_roll = 10.0;  ///< deg
  double turn_time = 10.0;  ///< s

  double circle_roll = 15.0;       ///< deg; the nominal one is 26.7 (QAtools)
  double circle_heading = 300.0;   ///< deg of heading in one direction (QAtools)
  double circle_steadiness = 6.0;  ///< deg: maximum standard deviation of the roll

  double pitch_variance = 2.0;          ///< deg2 (QAtools)
  double pitch_time = 90.0;             ///< s (QAtools)
  double pitch_shortest_period = 15.0;  ///< s; pilots aim at 20 (QAtools)
  double pitch_longest_period = 40.0;   ///< s; pilots aim at 30 (QAtools)
  double pitch_vertical_speed = 2.0;    ///< m/s rms, minimum; usual is 9 (amplitude 13, QAtools)

  double yaw_variance = 0.2;         ///< deg2 of sideslip (QAtools)
  double yaw_time = 120.0;           ///< s (QAtools)
  double yaw_shortest_period = 4.0;  ///< s; pilots aim at 5 (QAtools)
  double yaw_longest_period = 18.0;  ///< s; pilots aim at 15 (QAtools)
  /// Minimum magnitude if heading is known: the nose swings, not the wind.
  double yaw_heading_correlation = 0.5;

  double manoeuvre_climb = 5.0;  ///< m/s: maximum smoothed vertical speed in pitch and yaw (QAtools)
  double manoeuvre_roll = 10.0;  ///< deg: maximum mean magnitude of the roll in pitch and yaw
  double periodicity = 0.4;      ///< minimum autocorrelation at one period, of pitch and yaw

  double speed_range = 40.0;        ///< m/s between the slowest and the fastest (QAtools)
  double acceleration = 0.2;        ///< m/s2 (QAtools)
  double acceleration_time = 75.0;  ///< s: minimum duration of the acceleration in one branch (QAtools)
  double branch_time = 20.0;        ///< s: minimum duration of the acceleration in the other branches
  double speed_run_height = 40.0;   ///< m above and below the middle height; pilots aim at 20 (memo)
  double speed_run_pause = 90.0;    ///< s, maximum between the branches

  double leg_shortest = 120.0;     ///< s (QAtools; its search takes 240)
  double leg_longest = 300.0;      ///< s: maximum used part of a longer leg (QAtools)
  double leg_roll = 5.0;           ///< deg (QAtools)
  double leg_height_range = 40.0;  ///< m, of both legs together (QAtools)
  double leg_heading = 10.0;       ///< deg from 180 between the legs; pilots aim at 5 (QAtools)
  double turn_longest = 360.0;     ///< s between the legs; pilots need 120 to 240 (QAtools)

  /// Threshold, g/m3; the zero of a hot-wire (King) probe drifts by up to 0.08 in GOTEX rf06, in a part
  /// without cloud
  double cloud_liquid_water = 0.1;

  double bridged = 5.0;  ///< s: shorter interruptions do not end a turn, a straight leg or a cloud

  static RegimeCriteria c130();

  /// Criteria of the NSF/NCAR GV, which accelerates faster (0.3 m/s2, QAtools).
  static RegimeCriteria gv();

  /// Criteria of the aircraft whose registration is in the text, e.g. "N677F" or "GV N677F"; nullopt if
  /// unknown.
  static std::optional<RegimeCriteria> of(std::string_view aircraft);
};

/// Maximum indicated airspeed with the flaps of an approach, m/s, from the flight manuals: C-130 180 kt with
/// 50 %, GV 220 kt with 20 deg. For other aircraft the limit of the C-130, which is slower.
double max_flap_speed(std::string_view aircraft);

/// Description of the detection of a regime, with the numbers of the criteria.
std::string criterion_of(Regime regime, const RegimeCriteria& criteria = {});

/// Regimes of a flight, sorted by begin and then in the order of `Regime`.
///
/// The motion is averaged over 1 s, so begin and end are whole seconds after the first sample. Gaps of up to
/// 5 s are interpolated; a longer gap ends a turn, a leg or a cloud, and parts of a manoeuvre on both sides
/// of it are joined only within the pauses of the criteria. The phases cover the flight from the first sample
/// to the last: if the speed or the climb is unknown, the previous phase continues. If neither vertical speed
/// nor altitude is recorded, climb, descent and level are absent; if no speed is recorded either, there are
/// no phases. All other regimes are searched only in the air, after the take-off. The computing time is
/// linear in the number of samples.
///
/// @throws Error if the length of a non-empty series differs from that of `time`, or if times do not
/// increase.
std::vector<Interval> find_regimes(const FlightMotion& motion, const RegimeCriteria& criteria = {});

/// Regimes at one time, a bit for each `Regime`.
using RegimeSet = std::bitset<regime_count>;

/// Regimes of each sample: the intervals with begin <= time < end. `time` must increase.
std::vector<RegimeSet> regimes_of_samples(const std::vector<double>& time,
                                          const std::vector<Interval>& intervals);

/// Time range in which detected intervals are removed by the user.
struct Veto {
  std::optional<Regime> regime{};  ///< absent: any
  double begin = 0.0;
  double end = 0.0;
};

/// Samples excluded by the user, in [begin, end).
struct Exclusion {
  double begin = 0.0;
  double end = 0.0;
  std::string reason{};
};

/// User-defined changes to the regimes of one or several flights.
///
/// Times are seconds since 1970 UTC. Values before 1970-01-02 are times of the day, in seconds, of the flight
/// to which they are applied; `placed` converts them.
struct UserIntervals {
  std::string flight;  ///< file name of the only flight to which this applies; empty: any
  std::vector<Interval> add;
  std::vector<Veto> veto;
  std::vector<Exclusion> exclude;

  /// True if this applies to the flight in that file: `flight` is empty or its file name.
  bool is_for(const std::filesystem::path& flight_file) const;
};

/// Interval that has no time in common with a flight.
struct OutsideInterval {
  std::string text;             ///< "[[exclude]] 2011-11-17 20:30:00 to 20:31:00"
  bool is_time_of_day = false;  ///< stated without a date, so for any flight
};

/// Intervals, of all kinds, that have no time in common with a flight from `start_time` to `end_time`.
std::vector<OutsideInterval> intervals_outside(const UserIntervals& intervals, double start_time,
                                               double end_time);

/// Reads the user's intervals from a TOML file:
///
///     format = "pcor-intervals/1"
///     flight = "DC3-TEST-rf01.nc"     # may be left out: for any flight
///     [[add]]
///     regime = "pitch manoeuvre"
///     begin = 2011-11-17T20:10:00Z    # UTC also without Z; or a time of the day, 20:10:00 or "20:10:00"
///     end = 2011-11-17T20:13:00Z
///     note = "seen in VSPD"           # may be left out; `pair = 1` for both legs of a reverse heading
///     [[veto]]
///     regime = "turn"                 # may be left out: any
///     begin = "20:20:00"
///     end = "20:25:00"
///     [[exclude]]
///     begin = "20:30:00"
///     end = "20:31:00"
///     reason = "PSXC iced"
///
/// @throws Error with file:line:column if the file cannot be read, is not TOML, has an unknown key or regime,
/// lacks a key, or an interval ends before its start (times of the day: lasts more than twelve hours).
UserIntervals read_intervals(const std::filesystem::path& path);

/// Reads the user's intervals from text; `name` replaces the file name in messages.
UserIntervals read_intervals_text(std::string_view text, std::string_view name);

/// Intervals with times of the day converted to seconds since 1970 UTC, for a flight from `start_time` to
/// `end_time`: the start is on the day that places it in the flight or nearest to it, the end is the first
/// such time after the start. Times after midnight are therefore those of the next day.
UserIntervals placed(const UserIntervals& user, double start_time, double end_time);

/// Regimes of a flight from `start_time` to `end_time` (s since 1970 UTC) after the user's changes.
///
/// Vetoes are applied first: detected intervals are cut by overlapping vetoes of their regime; manoeuvres are
/// removed completely, and both legs of a reverse-heading pair. Then each added interval, cut to the flight,
/// replaces intervals of the same regime, and an added phase replaces all phases. The user's pairs are
/// numbered after the detected ones. `user.flight` and `user.exclude` are not used.
std::vector<Interval> apply(const UserIntervals& user, std::vector<Interval> found, double start_time,
                            double end_time);

}  // namespace pcor
