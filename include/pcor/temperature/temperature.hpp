#pragma once

#include <pcor/fit/refit.hpp>
#include <pcor/report/report.hpp>

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcor {

/// What is done about isobaric surfaces that are not level (memo, after eq. 24). In a climb a slope along the
/// way looks like an error of the temperature: 10 m in 100 km like 1 K at 5 m/s.
enum class IsobarSlope {
  fitted,         ///< two slopes of each flight are unknowns of the likelihood, and may change slowly
  none,           ///< surfaces are taken for level
  level_legs,     ///< from the height of the surfaces along level legs (memo ii)
  climb_descent,  ///< from surfaces that climbs and descents cross at different places (memo iii)
  whole_flight,   ///< from all surfaces that the flight meets more than once (memo iv)
  geostrophic     ///< from the measured wind: f/g times the wind across the way, as far as that is in balance
};

std::string_view to_string(IsobarSlope slope);
/// The option of that name, for example "level-legs"; nothing where there is none.
std::optional<IsobarSlope> isobar_slope_named(std::string_view name);

struct TemperatureOptions {
  MaskOptions mask;
  /// The highest power of the temperature, 0 to 2. Absent: chosen by flights that take no part.
  std::optional<int> degree{};
  IsobarSlope slope = IsobarSlope::fitted;
  /// Usual slope of isobars, 1: 10 m in 100 km (memo, after eq. 24). The likelihood of `fitted` starts from
  /// it; what the other options but `none` take off leaves a third of it.
  double slope_size = 1e-4;
  /// Standard deviation of errors of the static pressure that last, hPa, the same in all flights: one that is
  /// the same at all pressures, and one in proportion to the pressure. They make the coefficients less sure,
  /// and the heights do not tell them from the thermometer's. Absent: of the first the standard error that
  /// the model states of psfd-bias, else its usual size, 0.1; of the second what the model states of its law
  /// ([uncertainty], covariance), else the rms that the law states, else 0.3, with 0.1 for the transducer,
  /// and the ranges of each `LawError` beyond three times its size, as the root of the sum of squares. At 0
  /// errors do not know of them, and `pressure_error_text` says how much the first would move the
  /// coefficients.
  std::optional<double> pressure_error{};
  double min_climb_rate = 0.0;  ///< m/s: slower parts take no part (memo i)
  bool skip_returning = false;  ///< flights that end where they began take no part (memo v)
  /// The flights were written by `pcor process --hydrostatic` with the same model, but for its correction of
  /// the temperature: take -(R_a/g0) ln(p_i/p_(i-1)) and the temperature from there.
  bool archived = false;
  /// Flights whose humidity is not known take part with dry air, however low they fly; `worse` says so. Else
  /// those that reach below 5 km are left out.
  bool dry_air = false;
  std::size_t threads = 0;  ///< 0: as many as processors, and one in a team of several
  std::function<void(std::size_t done, std::size_t total)>
      progress{};  ///< told after every flight of this member
};

/// A correction of the temperature by one method: T_corrected = T + a0 + a1 t + a2 t^2, t in degC.
struct TemperatureFit {
  std::vector<double> coefficients{};     ///< a0 (K), a1 (1), a2 (1/K)
  std::vector<double> standard_errors{};  ///< of the coefficients
  double sigma = 0.0;                     ///< standard deviation of a height, m: see `TemperatureResult`
};

/// How well corrections of one degree serve.
struct DegreeChoice {
  int degree = -1;        ///< -1: no correction
  double deviance = 0.0;  ///< -2 ln L of all flights, less that without correction
  /// -2 ln L of flights that took no part in finding the coefficients, less that without correction: the sum
  /// over flights, and its standard error from their scatter. NaN where there are fewer than three flights.
  double held_out = 0.0;
  double held_out_error = 0.0;
};

/// The correction at one temperature.
struct TemperatureCorrection {
  double temperature = 0.0;     ///< degC
  double correction = 0.0;      ///< K
  double standard_error = 0.0;  ///< K
};

/// An error of the law of the static pressure that heights see in climbs, beside that of the thermometer. Its
/// size beforehand is what the law states of delta-p as a whole, with 0.1 hPa more, since standard errors of
/// coefficients know of the noise of a fit and not of the reference; of a law that states nothing and lacks
/// the effect, the usual one of the effect.
struct LawError {
  std::string effect{};     ///< of the catalogue
  std::string parameter{};  ///< its coefficient
  double change = 0.0;      ///< what the law's coefficient lacks, in its unit
  double standard_error = 0.0;
  double size = 0.0;   ///< standard deviation beforehand, in the unit of the coefficient
  double range = 0.0;  ///< of the pressure over the flights by this error, hPa
};

/// What a part of the data says of the correction by itself: the common one with a constant of its own.
struct PartCorrection {
  std::string part{};           ///< a flight, "climbs" or "descents"
  double temperature = 0.0;     ///< degC, the mean of what the part knows it by
  double correction = 0.0;      ///< there, K
  double standard_error = 0.0;  ///< of the noise alone, K
  double common = 0.0;          ///< the correction of all data there, K
};

/// What is seen of one flight, as means over 10 s.
struct FlightHeights {
  std::string flight{};
  std::string left_out{};  ///< why it takes no part; empty where it does
  std::size_t samples = 0;
  std::size_t segments = 0;           ///< over which the integral goes on without a break
  double min_temperature = 0.0;       ///< degC
  double max_temperature = 0.0;       ///< degC
  double rms_before = 0.0;            ///< of height by GPS less integral about its mean in each stretch, m
  double rms_after = 0.0;             ///< with the correction, m
  std::vector<double> time{};         ///< s since 1970 UTC
  std::vector<double> height{};       ///< geopotential height by GPS, m
  std::vector<double> temperature{};  ///< degC
  std::vector<double> before{};       ///< height by GPS less integral, as for `rms_before`, m
  std::vector<double> after{};        ///< with the correction, m
  std::vector<double> innovation{};   ///< what the likelihood did not foresee, in standard deviations
};

struct TemperatureResult {
  ModelDefinition model;  ///< with the correction as its effect temp-calibration, held in refits
  /// Maximum likelihood; sigma is that of the GPS noise, slow and fast, of a sample.
  TemperatureFit likelihood;
  /// Least squares on height, memo eq. 23-24, for comparison: sigma is the rms difference of heights. Its
  /// errors take heights for independent and are too small. Where the slope of isobars is fitted by
  /// the likelihood, here it is that of the whole flight (memo iv).
  TemperatureFit least_squares;
  /// What least squares would add to the likelihood's correction as a constant, K, once the errors of the law
  /// are taken off too; its error knows that heights remember each other. Beyond three of them the two
  /// contradict each other, and the noise or the law is not as described.
  double least_squares_add = 0.0;
  double least_squares_add_error = 0.0;
  std::vector<std::vector<double>> covariance{};  ///< of the likelihood's coefficients
  /// Where the likelihood, with the noise at its best for each value, has fallen by e^(-1/2), lower
  /// and upper, with the errors that it cannot see: agrees with value -+ standard error where the likelihood
  /// is a parabola.
  std::vector<std::array<double, 2>> profile{};
  std::vector<TemperatureCorrection> corrections{};  ///< over the range of temperatures of the flights
  std::vector<DegreeChoice> degrees{};
  /// What an error of the static pressure of 1 hPa in all flights would do to the coefficients.
  std::vector<double> per_hpa{};
  double pressure_error = 0.0;  ///< size of one that lasts, the same at all pressures, hPa: in all errors
  double law_error = 0.0;  ///< size of one that lasts, in proportion to the pressure, at the mean, hPa: too
  std::vector<LawError> law_errors{};  ///< that the likelihood takes off
  /// What the vapour pressure lacks by the heights, as a part of it; it is taken off, and its doubt is in all
  /// errors. Its size beforehand is the usual one of humidity-error, 10 %.
  double humidity_change = 0.0;
  double humidity_error = 0.0;  ///< standard error
  /// Every flight by itself, and climbs and descents: where they differ by more than chance, which happens
  /// once in 100 times, the standard deviation between them is in all standard errors.
  std::vector<PartCorrection> parts_by_flight{};
  std::vector<PartCorrection> parts_by_climb{};
  double spread_of_flights = 0.0;       ///< K; 0 where they agree
  double spread_of_climbs = 0.0;        ///< of climbs and descents, K; 0 where they agree
  double gps_noise = 0.0;               ///< of a sample, without memory, m
  double gps_wander = 0.0;              ///< with memory, m
  double gps_wander_time = 0.0;         ///< s
  double drift = 0.0;                   ///< random walk of the integral, m in a minute
  double innovation_variance = 0.0;     ///< of the innovations; 1 where the noise is as described
  double innovation_correlation = 0.0;  ///< from one 10 s to the next; 0 where the noise is as described
  std::size_t samples = 0;
  std::vector<FlightHeights> flights{};
  /// Why the correction is no better than none by its own numbers; empty where it is better.
  std::string worse{};
  std::vector<std::string> warnings{};  ///< that the numbers are not to be read without, a sentence each
  std::vector<std::string> notes{};     ///< what a user should know, a sentence each, the gravest first
  std::vector<std::string> notes_on_degree{};  ///< those of the notes that say how the degree was chosen
};

/// Calibrates the temperature by the height: the hydrostatic equation is integrated along each flight with
/// the corrected temperature, and held against the height by GPS (memo, eqs. 23 and 24 and GV addition).
///
/// A correction that the model has already is taken off first, so the result takes its place. The flights
/// need climbs or descents, GPS height, latitude, a thermometer and corrected pressures; where the height
/// makes a step or something is missing the integral starts anew.
///
/// The law of the static pressure may be wrong, and differently so in climbs than level: an error in
/// proportion to the dynamic pressure, and one to the angle of attack where the model knows it, are found
/// with the coefficients, and taken off; so is one in proportion to the humidity. One that lasts is in their
/// errors. One in proportion to the static pressure moves no height.
///
/// @throws Error if no flight can be used: the message says why for the first one.
TemperatureResult fit_temperature(const FlightSet& flights, const ModelDefinition& model,
                                  const TemperatureOptions& options = {});

/// One round of `calibrate_iteratively`.
struct CalibrationRound {
  double rms_hpa = 0.0;                ///< of the pressure fit
  std::vector<double> coefficients{};  ///< of the temperature correction
  double defect_change = 0.0;          ///< rms change of delta-p over the flights since the round before, hPa
  double temperature_change = 0.0;  ///< greatest change of the correction over the range of temperatures, K
};

struct IterativeCalibration {
  RefitResult pressure;           ///< of the last round
  TemperatureResult temperature;  ///< of the last round, degrees of the first; its model has both
  std::vector<CalibrationRound> rounds{};
  bool converged = false;
};

/// The memo's iteration: delta-p from LAMS depends on the temperature, and the temperature on the pressure.
/// Fits them in turn until neither moves: delta-p by less than 0.001 hPa and the temperature by less than
/// 0.001 K.
/// @throws Error as `refit` and `fit_temperature`, and for archived flights, whose pressures are as they are.
IterativeCalibration calibrate_iteratively(const FlightSet& flights, const ModelDefinition& model,
                                           const References& references, const RefitOptions& refit_options,
                                           const TemperatureOptions& temperature_options);

/// "none", "constant", "linear" or "quadratic", for a degree of -1 to 2.
std::string degree_name(int degree);

/// The unit of coefficient a0, a1 or a2: "K", "1" or "1/K".
std::string coefficient_unit(std::size_t power);

/// "-0.5377 to -0.5301"; an end that the likelihood does not give is "open".
std::string profile_text(const std::array<double, 2>& ends);

/// "-0.537 +- 0.012": the error with two significant digits, the value with as many decimals.
std::string with_error(double value, double error, std::string_view plus_minus = "+-");

/// What an error of the static pressure that lasts does to the coefficients, and whether their errors know of
/// it: a sentence or two.
std::string pressure_error_text(const TemperatureResult& result);

/// The report of a calibration of the temperature.
Report temperature_report(const TemperatureResult& result);

}  // namespace pcor
