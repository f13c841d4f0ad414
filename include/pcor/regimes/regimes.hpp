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

/// What an aircraft does for a while. The phases (ground to level) follow one another without overlap; the
/// others lie over them.
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

/// What is known of a regime without a flight.
struct RegimeInfo {
  std::string_view name;  ///< as files and reports spell it, for example "pitch manoeuvre"
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

/// The regime of that name; `Regime::count` where there is none.
Regime regime_named(std::string_view name);

/// Whether the regime is one of the phases, of which a moment has at most one.
constexpr bool is_phase(Regime regime) { return regime <= Regime::level; }

/// Whether the regime is a manoeuvre flown on purpose, of which a part is worth nothing.
constexpr bool is_manoeuvre(Regime regime) {
  return regime >= Regime::pitch_manoeuvre && regime <= Regime::circle;
}

/// What the search looks at: series at one rate, one value for each sample, NaN where missing. An empty
/// series was not recorded; what cannot be told without it is not found.
struct FlightMotion {
  std::vector<double> time;            ///< s since 1970 UTC, strictly increasing, gaps possible
  std::vector<double> airspeed;        ///< true airspeed, m/s; empty: the ground speed stands in
  std::vector<double> altitude;        ///< m
  std::vector<double> vertical_speed;  ///< m/s; empty: from the altitude
  std::vector<double> roll;            ///< deg, right wing down positive
  std::vector<double> pitch;           ///< deg
  std::vector<double> heading;         ///< true heading, deg
  std::vector<double> attack;          ///< deg; stands in for the pitch where that is not recorded
  std::vector<double> sideslip;        ///< deg
  std::vector<double> ground_speed;    ///< m/s
  std::vector<double> ground_track;    ///< deg; stands in for the heading where that is not recorded
  std::vector<double> liquid_water;    ///< g/m3
};

/// A regime from `begin` up to but not including `end`.
struct Interval {
  Regime regime = Regime::count;
  double begin = 0.0;    ///< s since 1970 UTC
  double end = 0.0;      ///< s since 1970 UTC
  int pair = 0;          ///< number of the reverse-heading pair, from 1; otherwise 0
  std::string note{};    ///< what was found, for example "7 cycles of 24 s, +-2.1 deg"; may be empty
  bool by_user = false;  ///< given by the user, not found
};

/// The thresholds of the search. The defaults are those of the NSF/NCAR C-130.
///
/// "QAtools" is NCAR's program of data review, whose searches for manoeuvres, and definitions of them, set
/// most of the numbers; "memo" is Cooper's study of manoeuvres for the calibration of these aircraft.
/// Where no source is given the number is this library's choice.
struct RegimeCriteria {
  double flying_speed = 60.0;      ///< m/s: airborne above it, on the ground below it
  double roll_speed = 15.0;        ///< m/s: the take-off roll has begun above it
  double take_off_height = 300.0;  ///< m above the field: the take-off is over, and
  double take_off_time = 60.0;     ///< s after the flying speed was reached at the latest

  double climb_rate = 1.5;        ///< m/s: climb or descent where the smoothed vertical speed is beyond it
  double climb_smoothing = 60.0;  ///< s, taken twice: over more than two periods of a pitch manoeuvre
  double phase_time = 60.0;       ///< s: a shorter climb, descent or level is part of its neighbour

  double turn_roll = 10.0;  ///< deg
  double turn_time = 10.0;  ///< s

  double circle_roll = 15.0;       ///< deg; the nominal one is 26.7 (QAtools)
  double circle_heading = 300.0;   ///< deg of heading in one direction (QAtools)
  double circle_steadiness = 6.0;  ///< deg: the standard deviation of the roll is less

  double pitch_variance = 2.0;          ///< deg2 (QAtools)
  double pitch_time = 90.0;             ///< s (QAtools)
  double pitch_shortest_period = 15.0;  ///< s; pilots aim at 20 (QAtools)
  double pitch_longest_period = 40.0;   ///< s; pilots aim at 30 (QAtools)
  double pitch_vertical_speed = 2.0;    ///< m/s rms at least; usual is 9 (amplitude 13, QAtools)

  double yaw_variance = 0.2;             ///< deg2 of sideslip (QAtools)
  double yaw_time = 120.0;               ///< s (QAtools)
  double yaw_shortest_period = 4.0;      ///< s; pilots aim at 5 (QAtools)
  double yaw_longest_period = 18.0;      ///< s; pilots aim at 15 (QAtools)
  double yaw_heading_correlation = 0.5;  ///< magnitude: the nose swings, not the wind, where heading is known

  double manoeuvre_climb = 5.0;  ///< m/s: the smoothed vertical speed in pitch and yaw is less (QAtools)
  double manoeuvre_roll = 10.0;  ///< deg: the mean magnitude of the roll in pitch and yaw is less
  double periodicity = 0.4;      ///< autocorrelation one period later, of pitch and yaw, at least

  double speed_range = 40.0;        ///< m/s between the slowest and the fastest (QAtools)
  double acceleration = 0.2;        ///< m/s2 (QAtools)
  double acceleration_time = 75.0;  ///< s over which one branch at least keeps it (QAtools)
  double branch_time = 20.0;        ///< s over which the other branches keep it
  double speed_run_height = 40.0;   ///< m above and below the middle height; pilots aim at 20 (memo)
  double speed_run_pause = 90.0;    ///< s between the branches at most

  double leg_shortest = 120.0;     ///< s (QAtools; its search takes 240)
  double leg_longest = 300.0;      ///< s: no more of a longer leg is taken (QAtools)
  double leg_roll = 5.0;           ///< deg (QAtools)
  double leg_height_range = 40.0;  ///< m, of both legs together (QAtools)
  double leg_heading = 10.0;       ///< deg from 180 between the legs; pilots aim at 5 (QAtools)
  double turn_longest = 360.0;     ///< s between the legs; pilots need 120 to 240 (QAtools)

  /// g/m3; the zero of a hot-wire (King) probe drifts by up to 0.08 in GOTEX rf06, where there is no cloud
  double cloud_liquid_water = 0.1;

  double bridged = 5.0;  ///< s: a turn, a straight leg or a cloud goes on over a shorter interruption

  static RegimeCriteria c130();

  /// Those of the NSF/NCAR GV, which accelerates faster (0.3 m/s2, QAtools).
  static RegimeCriteria gv();

  /// Those of the aircraft whose registration is in the text, e.g. "N677F" or "GV N677F"; nothing where it is
  /// not known.
  static std::optional<RegimeCriteria> of(std::string_view aircraft);
};

/// How a regime is found, in words with the numbers of the criteria.
std::string criterion_of(Regime regime, const RegimeCriteria& criteria = {});

/// The regimes of a flight, by begin and then in the order of `Regime`.
///
/// The motion is looked at as means over 1 s, so begin and end are whole seconds after the first sample.
/// Up to 5 s without a value are filled by interpolation; a longer gap ends a turn, a leg or a cloud, and
/// what is on both sides of it is one manoeuvre only within the pauses of the criteria. The phases cover the
/// flight from the first sample to the last: where the speed or the climb is not known, the phase before goes
/// on. If neither vertical speed nor altitude is known anywhere, climb, descent and level are absent; if no
/// speed is known either, there are no phases. Everything else is found in the air only, after the take-off.
/// The time it takes grows with the number of samples.
///
/// @throws Error if a series that is not empty has not one value for each time, or if times do not increase.
std::vector<Interval> find_regimes(const FlightMotion& motion, const RegimeCriteria& criteria = {});

/// The regimes of a moment, a bit for each `Regime`.
using RegimeSet = std::bitset<regime_count>;

/// The regimes of each sample: those of the intervals with begin <= time < end. `time` must increase.
std::vector<RegimeSet> regimes_of_samples(const std::vector<double>& time,
                                          const std::vector<Interval>& intervals);

/// Found intervals that the user does not believe.
struct Veto {
  std::optional<Regime> regime{};  ///< absent: any
  double begin = 0.0;
  double end = 0.0;
};

/// Samples that the user does not want used, from `begin` up to but not including `end`.
struct Exclusion {
  double begin = 0.0;
  double end = 0.0;
  std::string reason{};
};

/// What the user says of the regimes of one flight or of several.
///
/// Times are seconds since 1970 UTC. One before 1970-01-02 is a time of the day, in seconds, of whatever
/// flight it is used for; `placed` makes a moment of it.
struct UserIntervals {
  std::string flight;         ///< name of the file of the only flight that this is for; empty: for any
  std::vector<Interval> add;  ///< all `by_user`
  std::vector<Veto> veto;
  std::vector<Exclusion> exclude;

  /// Whether this is for the flight in that file: `flight` is empty or its file name.
  bool is_for(const std::filesystem::path& flight_file) const;
};

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
/// lacks a key, or ends an interval before it begins (of times of the day: lasts more than twelve hours).
UserIntervals read_intervals(const std::filesystem::path& path);

/// The same from a text, which messages call `name`.
UserIntervals read_intervals_text(std::string_view text, std::string_view name);

/// The user's intervals with every time of the day made a moment, for a flight from `first_time` to
/// `last_time` (s since 1970 UTC): of the days, the one that brings the begin into the flight or nearest to
/// it; the end is the first after the begin. So times after midnight are those of the next day.
UserIntervals placed(const UserIntervals& user, double first_time, double last_time);

/// The regimes of a flight from `first_time` to `last_time` (s since 1970 UTC) as the user wants them.
///
/// First the vetoes: what was found is cut where a veto of its regime overlaps it; of a manoeuvre all is
/// removed, of a reverse-heading pair both legs. Then each added interval, cut to the flight, takes the place
/// of what there was of the same regime, and a phase of what there was of any phase. The user's pairs get
/// numbers after those found. `user.flight` is not looked at, and `user.exclude` does not change regimes.
std::vector<Interval> apply(const UserIntervals& user, std::vector<Interval> found, double first_time,
                            double last_time);

}  // namespace pcor
