#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace pcor {

/// A flight to be simulated: the aircraft, the air, what is flown, the instruments, and what is wrong with
/// them. `read_scenario` fills it with the defaults of the aircraft and checks it; data/scenarios/README.md
/// is the reference of the file.
struct Scenario {
  enum class Aircraft { c130, gv };

  /// Where the choice is left to the aircraft or to what came before.
  static constexpr double by_default = std::numeric_limits<double>::quiet_NaN();

  /// A layer of cloud.
  struct Cloud {
    double base = 0.0;    ///< m
    double top = 0.0;     ///< m
    double liquid = 0.3;  ///< liquid water content, g/m3
    double cover = 0.5;   ///< the part of the track that is in cloud, 0 to 1
  };

  /// The air. Heights are above the ellipsoid of the GPS, which here is also sea level.
  struct Atmosphere {
    double ground_pressure = 1000.0;     ///< hPa, at `ground_height`
    double ground_height = 100.0;        ///< m
    double ground_temperature = 288.0;   ///< K
    double lapse_rate = 6.5;             ///< K/km
    double inversion_height = 1500.0;    ///< m
    double inversion_strength = 2.0;     ///< K
    double tropopause = 11000.0;         ///< m
    double ground_humidity = 70.0;       ///< relative humidity over water below the inversion, %
    double upper_humidity = 30.0;        ///< above the inversion, %
    double wind_speed = 5.0;             ///< at the ground, m/s
    double wind_from = 250.0;            ///< deg
    double wind_shear = 2.0;             ///< increase of the wind with height, m/s per km
    double wind_drift = 0.3;             ///< rms of the mesoscale drift of each component, m/s
    double wind_drift_time = 300.0;      ///< its memory, s
    double turbulence = 1e-4;            ///< dissipation rate of the free troposphere, m2/s3
    double boundary_layer = 2e-3;        ///< dissipation rate below the inversion, m2/s3
    double pressure_height_east = 0.0;   ///< slope of the isobars, m per 100 km eastward
    double pressure_height_north = 0.0;  ///< m per 100 km northward
    std::vector<Cloud> clouds{};
  };

  /// What is flown, one after another. Which numbers a kind takes is in data/scenarios/README.md; the others
  /// are not used.
  struct Leg {
    enum class Kind {
      ground,
      take_off,
      climb,
      descent,
      level,
      pitch,
      yaw,
      speed_run,
      reverse_heading,
      circle,
      turn,
      landing
    };
    Kind kind = Kind::level;
    double duration = by_default;   ///< s
    double altitude = by_default;   ///< m
    double speed = by_default;      ///< true airspeed, m/s
    double rate = by_default;       ///< of climb, m/s; of a speed run, m/s2
    double low = by_default;        ///< slowest speed of a speed run, m/s
    double high = by_default;       ///< greatest speed of a speed run, m/s
    double period = by_default;     ///< s
    double cycles = by_default;     ///< 1
    double amplitude = by_default;  ///< of the vertical acceleration, m/s2; of the sideslip, deg
    double roll = by_default;       ///< deg, positive
    double angle = by_default;      ///< change of heading, deg, to starboard
    double flaps = by_default;      ///< percent
    std::string place{};            ///< where it stands in the file, for messages
  };

  /// What a sensor adds to the truth.
  struct Noise {
    double rms = 0.0;         ///< of means over one second, in the variable's unit
    double bias = 0.0;        ///< constant, in the variable's unit
    double memory = 0.0;      ///< the time after which the noise has forgotten itself to 1/e, s; 0: white
    double resolution = 0.0;  ///< values are whole multiples of it; 0: not rounded
  };

  /// The static defect of one pair of pressures as published laws have it, in what that pair measures:
  ///
  ///     d/p_m = a0 + a1 A + a2 x + a3 alpha + a4 x alpha^2 + m1 M + m2 M^2 + m3 M^3 + b1 B + b2 beta^2
  ///
  /// A = ADIFR/QCR, B = BDIFR/QCR, x = q_m/p_m, angles in deg.
  struct Law {
    double a0 = 0.0;  ///< static-constant
    double a1 = 0.0;  ///< static-alpha
    double a2 = 0.0;  ///< static-qp
    double a3 = 0.0;  ///< static-attack, 1/deg
    double a4 = 0.0;  ///< static-alpha-quad, 1/deg2
    double m1 = 0.0;  ///< static-mach
    double m2 = 0.0;  ///< static-mach2
    double m3 = 0.0;  ///< static-mach3
    double b1 = 0.0;  ///< static-beta-odd
    double b2 = 0.0;  ///< static-beta-even, 1/deg2
  };

  /// A pair of static and pitot pressure.
  struct System {
    std::string static_pressure{};
    std::string dynamic_pressure{};
    Law law;
    bool independent_mach = false;  ///< M is the true Mach number; else that of the pair in dry air
  };

  /// The laser.
  struct Lams {
    double elevation = 0.0;        ///< of the beam above the longitudinal axis, deg
    double azimuth = 0.0;          ///< to starboard, deg
    double mismatch = 0.20;        ///< air ahead of the pitot's: rms of 1-s means at 1e-4 m2/s3, m/s
    double mismatch_memory = 2.0;  ///< s
    double dropout = 0.0;  ///< part of the samples missing for lack of aerosol near the ground, 0 to 1
    double clear_above = by_default;  ///< half of the samples are missing at this height, m
  };

  /// The aircraft's own air data computer: PS_A, QC_A, MACH_A.
  ///
  /// With a `law`, the error of MACH_A is such that the law, with MACH_A as M, gives the defect of the first
  /// system. So a law in which M nearly cancels q/p, as equation 20 of the memo, can be true: with the true
  /// Mach number as M it holds for one defect only, at cruise an absurd one.
  struct Avionics {
    double response = 0.5;  ///< time constant of its filter, s
    double delay = 0.1;     ///< s
    bool has_law = false;
    Law law;
  };

  /// Something wrong that the processing does not know.
  struct Effect {
    std::string id{};
    std::string on{};  ///< the variable it acts on; empty: all that it can act on
    std::map<std::string, double> parameters{};
    std::string of{};        ///< of "unknown": the variable that causes it
    std::string location{};  ///< of "unknown": static, total, lams or temperature
    std::string shape{};     ///< of "unknown": linear, quadratic, step or sine
    std::string place{};     ///< where it stands in the file, for messages
  };

  /// Spikes in a variable.
  struct Outliers {
    std::string variable{};
    double fraction = 0.0;  ///< of the samples
    double size = 0.0;      ///< standard deviation, in the variable's unit
  };

  /// Missing data.
  struct Gap {
    std::string variable{};  ///< empty: the records are not in the file at all
    double start = 0.0;      ///< s after the first record
    double duration = 0.0;   ///< s
  };

  std::string file{};  ///< what messages call it
  std::string name{};
  Aircraft aircraft = Aircraft::c130;
  std::uint64_t seed = 1;
  double start = 1321560000.0;  ///< of the first record, seconds since 1970 UTC
  int rate = 1;                 ///< samples a second of the fast variables: 1, 5 or 25
  double latitude = 40.0;       ///< at the start, deg
  double longitude = -105.0;    ///< deg
  double heading = 90.0;        ///< at the start, deg
  double weight = by_default;   ///< at the start, kg
  double recovery_factor = by_default;
  bool noise_on = true;  ///< false: no noise, no mismatch of the laser, no dropouts, whatever is stated
  Atmosphere atmosphere;
  std::vector<Leg> legs{};
  std::vector<System> systems{};
  std::map<std::string, Noise> noise{};
  Lams lams;
  Avionics avionics;
  std::vector<Effect> effects{};
  std::vector<Outliers> outliers{};
  std::vector<Gap> gaps{};
};

/// Reads a scenario (format "pcor-scenario/1") and checks it. Nothing in the file is ignored.
/// @throws Error with file:line:column if the file cannot be read, or says something that is not known,
/// contradicts itself, or is impossible for the aircraft.
Scenario read_scenario(const std::filesystem::path& path);

/// The same from a text, which messages call `name`.
Scenario parse_scenario(std::string_view text, std::string_view name);

/// How a flight is simulated.
struct SimulateOptions {
  std::string history{};  ///< what the output says of its making, e.g. the command line
  std::function<void(std::size_t done, std::size_t total)> progress{};  ///< told after every variable
};

/// A leg as it was flown.
struct LegFlown {
  std::string kind;         ///< as in the scenario, e.g. "speed-run"
  double first_time = 0.0;  ///< seconds since 1970 UTC
  double last_time = 0.0;   ///< seconds since 1970 UTC
  double altitude = 0.0;    ///< mean, m
  double pressure = 0.0;    ///< mean, hPa
  double min_speed = 0.0;   ///< true airspeed, m/s
  double max_speed = 0.0;
  double min_attack = 0.0;  ///< deg
  double max_attack = 0.0;
};

/// What was simulated.
struct SimulationSummary {
  std::string name;
  std::string aircraft;  ///< e.g. "C-130 N130AR"
  std::uint64_t seed = 0;
  std::size_t records = 0;
  int rate = 1;
  double first_time = 0.0;  ///< seconds since 1970 UTC
  double last_time = 0.0;
  std::vector<LegFlown> legs;
  std::vector<std::string> variables;  ///< as recorded
  std::vector<std::string> truth;      ///< what really was, names with TRUE_
  std::vector<std::string> effects;    ///< the ids of what is wrong
};

/// Flies the scenario and writes what the aircraft would have recorded to the netCDF file `output`, with the
/// truth beside it.
///
/// The truth side has physics of its own, at 25 Hz, and shares only constants of nature with the corrections
/// that are to find it. Recorded values are means over the sample intervals.
///
/// The same scenario, seed and program give the same data, byte by byte, whatever the number of processors.
/// On another machine the random numbers are the same; where its mathematics library rounds otherwise, values
/// differ in the last digits. Every sensor has random numbers of its own, found from the seed and the
/// variable's name: to change the noise of one leaves all others as they were.
///
/// Memory: 200 bytes for each second of flight and variable of the truth, 65 MB for two hours in all.
/// Pressures hPa, temperatures degC, speeds m/s, angles deg.
///
/// @throws Error if the flight cannot be flown (stall, Mach limit) or the output cannot be written.
SimulationSummary simulate_flight(const Scenario& scenario, const std::filesystem::path& output,
                                  const SimulateOptions& options = {});

}  // namespace pcor
