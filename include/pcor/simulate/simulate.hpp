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

/// Scenario of a simulated flight: aircraft, atmosphere, flight plan, instruments and their errors.
/// `read_scenario` applies the defaults of the aircraft and checks it; data/scenarios/README.md describes the
/// file.
struct Scenario {
  enum class Aircraft { c130, gv };

  /// Value to be chosen from the aircraft or the preceding leg.
  static constexpr double by_default = std::numeric_limits<double>::quiet_NaN();

  /// A layer of cloud.
  struct Cloud {
    double base = 0.0;    ///< m
    double top = 0.0;     ///< m
    double liquid = 0.3;  ///< liquid water content, g/m3
    double cover = 0.5;   ///< fraction of the track in cloud, 0 to 1
  };

  /// Atmosphere. Heights are above the ellipsoid of the GPS, which here is also sea level.
  struct Atmosphere {
    double ground_pressure = 1000.0;     ///< hPa, at `ground_height`
    double ground_height = 100.0;        ///< m
    double ground_temperature = 288.0;   ///< K
    double lapse_rate = 6.5;             ///< K/km
    double inversion_height = 1500.0;    ///< m
    double inversion_strength = 2.0;     ///< K
    double tropopause = 11000.0;         ///< m
    double ground_humidity = 70.0;       ///< relative humidity over water below the inversion, %
    double upper_humidity = 30.0;        ///< relative humidity above the inversion, %
    double wind_speed = 5.0;             ///< wind speed at the ground, m/s
    double wind_from = 250.0;            ///< deg
    double wind_shear = 2.0;             ///< increase of the wind with height, m/s per km
    double wind_drift = 0.3;             ///< rms of the mesoscale drift of each component, m/s
    double wind_drift_time = 300.0;      ///< correlation time of the drift, s
    double turbulence = 1e-4;            ///< dissipation rate of the free troposphere, m2/s3
    double boundary_layer = 2e-3;        ///< dissipation rate below the inversion, m2/s3
    double pressure_height_east = 0.0;   ///< slope of the isobars, m per 100 km eastward
    double pressure_height_north = 0.0;  ///< m per 100 km northward
    std::vector<Cloud> clouds{};
  };

  /// Flight segment. The numbers used by each kind are listed in data/scenarios/README.md; the others are
  /// ignored.
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
    double rate = by_default;       ///< climb rate, m/s; acceleration of a speed run, m/s2
    double low = by_default;        ///< minimum speed of a speed run, m/s
    double high = by_default;       ///< maximum speed of a speed run, m/s
    double period = by_default;     ///< s
    double cycles = by_default;     ///< 1
    double amplitude = by_default;  ///< vertical acceleration, m/s2; sideslip, deg
    double roll = by_default;       ///< deg, positive
    double angle = by_default;      ///< change of heading, deg, to starboard
    double flaps = by_default;      ///< percent
    std::string position{};         ///< position in the file, for messages
  };

  /// Error of a sensor.
  struct Noise {
    double rms = 0.0;         ///< rms of means over one second, in the variable's unit
    double bias = 0.0;        ///< constant, in the variable's unit
    double memory = 0.0;      ///< correlation time (1/e), s; 0: white
    double resolution = 0.0;  ///< quantisation step, in the variable's unit; 0: not rounded
  };

  /// Static defect of one pair of pressures in the form of published laws, in measured quantities:
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
    bool independent_mach =
        false;  ///< true: M is the true Mach number; false: Mach number of the pair in dry air
  };

  /// The laser.
  struct Lams {
    double elevation = 0.0;        ///< elevation of the beam above the longitudinal axis, deg
    double azimuth = 0.0;          ///< azimuth to starboard, deg
    double mismatch = 0.20;        ///< wind difference to the pitot: rms of 1-s means at 1e-4 m2/s3, m/s
    double mismatch_memory = 2.0;  ///< s
    double dropout = 0.0;  ///< fraction of samples missing for lack of aerosol near the ground, 0 to 1
    double clear_above = by_default;  ///< height at which half of the samples are missing, m
  };

  /// Air data computer of the aircraft: PS_A, QC_A, MACH_A.
  ///
  /// With a `law`, the error of MACH_A is such that the law, with MACH_A as M, gives the defect of the first
  /// system. Therefore a law in which M nearly cancels q/p, such as equation 20 of the memo, can be true:
  /// with the true Mach number as M it holds only for one defect, which is unrealistic at cruise.
  struct Avionics {
    double response = 0.5;  ///< time constant of the filter, s
    double delay = 0.1;     ///< s
    bool has_law = false;
    Law law;
  };

  /// Error that is not corrected by the processing.
  struct Effect {
    std::string id{};
    std::string on{};  ///< affected variable; empty: all possible ones
    std::map<std::string, double> parameters{};
    std::string of{};        ///< variable that causes an "unknown" effect
    std::string location{};  ///< target of an "unknown" effect: static, total, lams or temperature
    std::string shape{};     ///< shape of an "unknown" effect: linear, quadratic, step or sine
  };

  /// Spikes in a variable.
  struct Outliers {
    std::string variable{};
    double fraction = 0.0;  ///< fraction of samples
    double size = 0.0;      ///< standard deviation, in the variable's unit
  };

  /// Missing data.
  struct Gap {
    std::string variable{};  ///< empty: the records are absent from the file
    double start = 0.0;      ///< s after the first record
    double duration = 0.0;   ///< s
  };

  std::string file{};  ///< file name for messages
  std::string name{};
  Aircraft aircraft = Aircraft::c130;
  std::uint64_t seed = 1;
  double start = 1321560000.0;  ///< time of the first record, seconds since 1970 UTC
  int rate = 1;                 ///< sample rate of the fast variables, Hz: 1, 5 or 25
  double latitude = 40.0;       ///< initial latitude, deg
  double longitude = -105.0;    ///< deg
  double heading = 90.0;        ///< initial heading, deg
  double weight = by_default;   ///< initial weight, kg
  double recovery_factor = by_default;
  /// False: no noise, no mismatch of the laser, no dropouts, regardless of other settings.
  bool noise_on = true;
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

/// Reads a scenario (format "pcor-scenario/1") and checks it. Every key must be known.
/// @throws Error with file:line:column if the file cannot be read, or a value is unknown, contradictory or
/// impossible for the aircraft.
Scenario read_scenario(const std::filesystem::path& path);

/// Parses and checks a scenario from text; `name` replaces the file name in messages.
Scenario parse_scenario(std::string_view text, std::string_view name);

/// Options of a simulation.
struct SimulateOptions {
  std::string history{};  ///< history attribute of the output, e.g. the command line
  std::function<void(std::size_t done, std::size_t total)> progress{};  ///< callback after every variable
};

/// Leg with its simulated flight state.
struct SimulatedLeg {
  std::string kind;         ///< kind in the scenario, e.g. "speed-run"
  double start_time = 0.0;  ///< seconds since 1970 UTC
  double end_time = 0.0;    ///< seconds since 1970 UTC
  double altitude = 0.0;    ///< mean, m
  double pressure = 0.0;    ///< mean, hPa
  double min_speed = 0.0;   ///< true airspeed, m/s
  double max_speed = 0.0;
  double min_attack = 0.0;  ///< deg
  double max_attack = 0.0;
};

template <class Field>
void describe(const SimulatedLeg& self, Field& field) {
  field("kind", self.kind, "kind of the leg in the scenario");
  field.time("start", self.start_time, "first time of the leg");
  field.time("end", self.end_time, "last time of the leg");
  field("altitude_m", self.altitude, "mean altitude");
  field("pressure_hpa", self.pressure, "mean pressure");
  field("airspeed_m_s", std::vector<double>{self.min_speed, self.max_speed},
        "least and greatest true airspeed");
  field("attack_deg", std::vector<double>{self.min_attack, self.max_attack},
        "least and greatest angle of attack");
}

/// Result of a simulation.
struct SimulationSummary {
  std::string name;
  std::string aircraft;  ///< e.g. "C-130 N130AR"
  std::uint64_t seed = 0;
  std::size_t records = 0;
  int rate = 1;
  double start_time = 0.0;  ///< seconds since 1970 UTC
  double end_time = 0.0;
  std::vector<SimulatedLeg> legs;
  std::vector<std::string> variables;  ///< recorded variables
  std::vector<std::string> truth;      ///< true values, names with TRUE_
  std::vector<std::string> effects;    ///< ids of the simulated errors
  std::string scenario{};              ///< file of the scenario, filled by the caller
  std::string output{};                ///< file of the flight
};

template <class Field>
void describe(const SimulationSummary& self, Field& field) {
  field("scenario", self.scenario, "file of the scenario");
  field("output", self.output, "file of the flight");
  field("name", self.name, "name of the flight");
  field("aircraft", self.aircraft, "aircraft of the scenario");
  field("seed", self.seed, "seed of the random numbers");
  field.time("start", self.start_time, "time of the first record");
  field.time("end", self.end_time, "time of the last record");
  field("records", self.records, "number of records");
  field("rate", self.rate, "samples in a record");
  field("effects", self.effects, "ids of the simulated errors");
  field("variables", self.variables, "recorded variables");
  field("truth", self.truth, "variables with the true values");
  field("legs", self.legs, "legs of the flight");
}

/// Simulates the flight and writes the recorded variables, and their true values, to the netCDF file
/// `output`.
///
/// The simulation has independent physics at 25 Hz and shares only constants of nature with the corrections
/// under test. Recorded values are means over the sample intervals.
///
/// Equal scenario, seed and program give identical data, byte by byte, for any number of processors. On
/// another machine the random numbers are identical; if its mathematics library rounds differently, values
/// differ in the last digits. Every sensor has independent random numbers, derived from the seed and the
/// variable's name: a change of the noise of one sensor does not affect the others.
///
/// Memory: 200 bytes for each second of flight and variable of the truth, 65 MB for two hours in all.
/// Pressures hPa, temperatures degC, speeds m/s, angles deg.
///
/// @throws Error if the flight cannot be flown (stall, Mach limit) or the output cannot be written.
SimulationSummary simulate_flight(const Scenario& scenario, const std::filesystem::path& output,
                                  const SimulateOptions& options = {});

}  // namespace pcor
