#pragma once

#include <pcor/base/note.hpp>
#include <pcor/fit/refit.hpp>
#include <pcor/report/report.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcor {

/// Treatment of isobaric surfaces that are not level (memo, after eq. 24). In a climb, a slope along the
/// track is equivalent to a temperature error: 10 m in 100 km corresponds to 1 K at 5 m/s.
enum class IsobarSlope {
  fitted,         ///< two slopes per flight are unknowns of the likelihood and may drift
  none,           ///< surfaces are assumed level
  level_legs,     ///< slope of the surface heights along level legs (memo ii)
  climb_descent,  ///< surfaces crossed by climbs and descents at different positions (memo iii)
  whole_flight    ///< all surfaces that the flight crosses more than once (memo iv)
};

std::string_view to_string(IsobarSlope slope);
/// Option by its name, for example "level-legs"; nullopt if unknown.
std::optional<IsobarSlope> isobar_slope_named(std::string_view name);

struct TemperatureOptions {
  MaskOptions mask;
  /// Highest power of the temperature, 0 to 2. Default: chosen by cross-validation over flights.
  std::optional<int> degree{};
  IsobarSlope slope = IsobarSlope::fitted;
  /// Typical slope of isobars, 1: 10 m in 100 km (memo, after eq. 24). Prior of `fitted`; a third of it
  /// remains after the other corrections (not for `none`).
  double slope_size = 1e-4;
  /// Standard deviation of a constant static-pressure bias, hPa, equal in all flights: one independent of
  /// pressure and one proportional to it. They increase the standard errors; heights cannot separate them
  /// from a thermometer error. Default of the first: standard error of psfd-bias in the model, otherwise its
  /// typical size, 0.1. Default of the second: covariance of the model ([uncertainty], covariance), otherwise
  /// its stated rms, otherwise 0.3, with 0.1 for the transducer and the ranges of each `LawError` above three
  /// times its size, as root sum of squares. At 0 the standard errors exclude both, and `pressure_error_text`
  /// gives the sensitivity of the coefficients to the first.
  std::optional<double> pressure_error{};
  double min_climb_rate = 0.0;  ///< m/s: slower parts are not used (memo i)
  bool skip_returning = false;  ///< true: flights that end at their start point are not used (memo v)
  /// Flights were written by `pcor process --hydrostatic` with the same model, except its temperature
  /// correction: -(R_a/g0) ln(p_i/p_(i-1)) and the temperature are read from them.
  bool archived = false;
  /// Flights without known humidity are used with dry air at all altitudes; `worse` reports this. Otherwise
  /// those that reach below 5 km are not used.
  bool dry_air = false;
  std::size_t threads = 0;  ///< 0: number of processors, or one if there are several ranks
  std::function<void(std::size_t done, std::size_t total)>
      progress{};  ///< callback after every flight of this rank
};

/// Temperature correction by one method: T_corrected = T + a0 + a1 t + a2 t^2, t in degC.
struct TemperatureFit {
  std::vector<double> coefficients{};     ///< a0 (K), a1 (1), a2 (1/K)
  std::vector<double> standard_errors{};  ///< standard errors of a0, a1, a2
  double sigma = 0.0;                     ///< standard deviation of a height, m: see `TemperatureResult`
};

/// Values of each power of the temperature, named a0, a1, a2.
template <class Value>
std::vector<std::pair<std::string, Value>> by_power(const std::vector<Value>& values) {
  std::vector<std::pair<std::string, Value>> result;
  for (const Value& value : values) result.emplace_back("a" + std::to_string(result.size()), value);
  return result;
}

/// Unit in the keys of coefficients a0, a1 and a2.
inline constexpr const char* power_units = "K, 1, 1/K";

template <class Field>
void describe(const TemperatureFit& self, Field& field) {
  field("coefficients", by_power(self.coefficients), "T corrected = T + a0 + a1 t + ..., t in degC",
        power_units);
  field("stderr", by_power(self.standard_errors), "standard errors", power_units);
}

/// Fit statistics of corrections of one degree.
struct DegreeChoice {
  int degree = -1;        ///< -1: no correction
  double deviance = 0.0;  ///< -2 ln L of all flights minus its value without correction
  /// -2 ln L of held-out flights, minus its value without correction: the sum over flights, and
  /// its standard error from their scatter. NaN for fewer than three flights.
  double held_out = 0.0;
  double held_out_error = 0.0;
};

template <class Field>
void describe(const DegreeChoice& self, Field& field) {
  field("degree", self.degree, "degree of the correction; -1: no correction");
  field("deviance", self.deviance, "-2 ln L minus its value without correction");
  field("held_out", self.held_out, "the same for held-out flights");
  field("held_out_stderr", self.held_out_error, "its standard error");
}

/// Correction at one temperature.
struct TemperatureCorrection {
  double temperature = 0.0;     ///< degC
  double correction = 0.0;      ///< K
  double standard_error = 0.0;  ///< K

  /// Absolute value less two standard errors, K.
  double min_size() const { return std::abs(correction) - 2.0 * standard_error; }
};

template <class Field>
void describe(const TemperatureCorrection& self, Field& field) {
  field("temperature_degc", self.temperature, "temperature");
  field("correction_k", self.correction, "correction at this temperature");
  field("stderr_k", self.standard_error, "standard error of the correction");
}

/// Error of the static-pressure model that heights detect in climbs, in addition to the thermometer error.
/// Prior size: the stated error of delta-p plus 0.1 hPa, because standard errors of coefficients include the
/// noise of a fit but not the error of the reference; if the model states no error and lacks the effect, the
/// typical size of the effect.
struct LawError {
  std::string effect{};     ///< id in the catalogue
  std::string parameter{};  ///< coefficient
  double change = 0.0;      ///< estimated error of the model's coefficient, in its unit
  double standard_error = 0.0;
  double size = 0.0;   ///< prior standard deviation, in the unit of the coefficient
  double range = 0.0;  ///< range of the pressure error over the flights, hPa
};

template <class Field>
void describe(const LawError& self, Field& field) {
  field("effect", self.effect, "id of the effect");
  field("parameter", self.parameter, "coefficient");
  field("change", self.change, "estimated error of the coefficient", "unit of the coefficient");
  field("stderr", self.standard_error, "standard error of the estimate", "unit of the coefficient");
  field("size", self.size, "prior standard deviation", "unit of the coefficient");
  field("range_hpa", self.range, "range of the pressure error over the flights");
}

/// Correction estimated from one part of the data: the common one plus a constant.
struct PartCorrection {
  std::string part{};           ///< flight, "climbs" or "descents"
  double temperature = 0.0;     ///< weighted mean temperature of the part, degC
  double correction = 0.0;      ///< correction at that temperature, K
  double standard_error = 0.0;  ///< includes noise only, K
  /// Share in the error of a difference, K: the variance of the difference of two parts is the sum of the
  /// squares of their shares. `standard_error` for parts with independent errors.
  double difference_error = 0.0;
  double common = 0.0;  ///< correction of all data at that temperature, K
};

template <class Field>
void describe(const PartCorrection& self, Field& field) {
  field("part", self.part, "flight, climbs or descents");
  field("temperature_degc", self.temperature, "mean temperature of the part");
  field("correction_k", self.correction, "correction of the part at that temperature");
  field("stderr_k", self.standard_error, "standard error of the correction, noise only");
  field("common_k", self.common, "correction of all data at that temperature");
}

/// Heights of one flight, as means over 10 s.
struct FlightHeights {
  std::string flight{};
  std::string excluded{};  ///< reason for exclusion; empty if used
  std::size_t samples = 0;
  std::size_t segments = 0;           ///< contiguous segments of the integral
  double min_temperature = 0.0;       ///< degC
  double max_temperature = 0.0;       ///< degC
  double rms_before = 0.0;            ///< GPS height minus integral, about the mean of each segment, m
  double rms_after = 0.0;             ///< rms with the correction, m
  std::vector<double> time{};         ///< s since 1970 UTC
  std::vector<double> height{};       ///< geopotential height from GPS, m
  std::vector<double> temperature{};  ///< degC
  std::vector<double> before{};       ///< GPS height minus integral, as for `rms_before`, m
  std::vector<double> after{};        ///< difference with the correction, m
  std::vector<double> innovation{};   ///< normalised innovation of the likelihood
};

template <class Field>
void describe(const FlightHeights& self, Field& field) {
  const bool used = self.excluded.empty();
  field("name", self.flight, "file of the flight");
  field("used", used, "whether the flight is used");
  if (field.has(!used))
    field("left_out", self.excluded, "reason for exclusion; absent if the flight is used");
  if (!field.has(used)) return;
  field("samples", self.samples, "number of heights; absent if the flight is not used");
  field("stretches", self.segments, "contiguous segments of the integral; absent if not used");
  field("rms_before_m", self.rms_before, "GPS height minus integral, rms; absent if not used");
  field("rms_after_m", self.rms_after, "the same with the correction; absent if not used");
}

struct TemperatureResult {
  ModelDefinition model;  ///< model with the correction as effect temp-calibration, fixed in refits
  /// Maximum likelihood; sigma is the total GPS noise, slow and fast, of a sample.
  TemperatureFit likelihood;
  /// Least squares on height, memo eq. 23-24, for comparison; sigma is the rms difference of heights. Its
  /// errors assume independent heights and are too small. If the likelihood fits the slope of isobars, this
  /// fit uses the slope of the whole flight (memo iv).
  TemperatureFit least_squares;
  /// Constant that least squares adds to the likelihood's correction, K, after correction for the errors of
  /// the model; the standard error includes the autocorrelation of heights. Beyond three standard errors the
  /// two methods disagree: the noise or the model is not described correctly.
  double least_squares_add = 0.0;
  double least_squares_add_error = 0.0;
  std::vector<std::vector<double>> covariance{};  ///< covariance of the likelihood's coefficients
  /// Corrections over the temperature range of the flights.
  std::vector<TemperatureCorrection> corrections{};
  std::vector<DegreeChoice> degrees{};
  /// Change of the coefficients for a static-pressure bias of 1 hPa in all flights.
  std::vector<double> per_hpa{};
  double pressure_error = 0.0;  ///< standard deviation of the constant bias, hPa; included in all errors
  /// Standard deviation of the bias proportional to pressure, at the mean pressure, hPa; included in all
  /// errors.
  double law_error = 0.0;
  std::vector<LawError> law_errors{};  ///< errors corrected by the likelihood
  /// Relative error of the vapour pressure estimated from heights; corrected, and its uncertainty is in all
  /// errors. Prior: the typical size of humidity-error, 10 %.
  double humidity_change = 0.0;
  double humidity_error = 0.0;  ///< standard error
  /// Corrections of each flight, of climbs and descents, and of the first and second half of the flights. If
  /// they differ significantly (p < 0.01), the standard deviation between them is included in all standard
  /// errors.
  std::vector<PartCorrection> parts_by_flight{};
  std::vector<PartCorrection> parts_by_climb{};
  std::vector<PartCorrection> parts_by_half{};
  /// All parts of which the corrections are compared.
  std::array<const std::vector<PartCorrection>*, 3> parts() const {
    return {&parts_by_flight, &parts_by_climb, &parts_by_half};
  }
  double spread_of_flights = 0.0;    ///< K; 0 if they agree
  double spread_of_climbs = 0.0;     ///< spread between climbs and descents, K; 0 if they agree
  double spread_of_halves = 0.0;     ///< K; 0 if they agree
  double gps_noise = 0.0;            ///< white noise of a sample, m
  double gps_wander = 0.0;           ///< correlated noise, m
  double gps_wander_time = 0.0;      ///< correlation time, s
  double drift = 0.0;                ///< random walk of the integral, m per minute
  double innovation_variance = 0.0;  ///< variance of normalised innovations; 1 for a correct noise model
  /// Correlation of innovations 10 s apart; 0 for a correct noise model.
  double innovation_correlation = 0.0;
  std::size_t samples = 0;
  std::vector<FlightHeights> flights{};
  /// Reason for which the correction is rejected by its statistics; empty if accepted.
  std::string rejection_reason{};
  std::vector<std::string> warnings{};  ///< warnings, one sentence each
  Notes notes{};                        ///< notes for the user, one sentence each, by decreasing severity
  Notes notes_on_degree{};              ///< the notes on the choice of the degree

  /// Correction with the largest `min_size`; 0 K if all are negative.
  TemperatureCorrection largest_correction() const;
  /// Whether its `min_size` exceeds five times the usual error of a thermometer, 0.3 K.
  bool is_implausible() const;
};

template <class Field>
void describe(const TemperatureResult& self, Field& field) {
  describe(self.likelihood, field);
  field("covariance", self.covariance, "covariance of the coefficients", "product of the units");
  field("sigma_m", self.likelihood.sigma, "noise of the GPS height in a sample, slow and fast");
  field("samples", self.samples, "number of heights");
  field("flights", self.flights, "heights of each flight");
  field.object("least_squares", "least squares on height, for comparison", [&self](Field& least_squares) {
    describe(self.least_squares, least_squares);
    least_squares("sigma_m", self.least_squares.sigma, "rms difference of heights");
    least_squares("would_add_k", self.least_squares_add, "constant added by least squares");
    least_squares("would_add_stderr_k", self.least_squares_add_error, "standard error of that constant");
  });
  field("corrections", self.corrections, "correction over the range of temperatures");
  field("degrees", self.degrees, "choice of the degree");
  field("per_hpa", by_power(self.per_hpa), "change by a static-pressure bias of 1 hPa",
        "K/hPa, 1/hPa, 1/(K hPa)");
  field("pressure_error_hpa", self.pressure_error, "standard deviation of a constant static-pressure bias");
  field("law_error_hpa", self.law_error, "standard deviation of a bias proportional to pressure");
  field.object("noise", "noise of the heights", [&self](Field& noise) {
    noise("gps_m", self.gps_noise, "white noise of a sample");
    noise("gps_slow_m", self.gps_wander, "correlated noise");
    noise("gps_memory_s", self.gps_wander_time, "correlation time");
    noise("drift_m_per_minute", self.drift, "random walk of the integral");
    noise("innovation_variance", self.innovation_variance, "variance of innovations; 1 is correct");
    noise("innovation_correlation", self.innovation_correlation, "their correlation; 0 is correct");
  });
  field("law_errors", self.law_errors, "errors of the static-pressure model, which were subtracted");
  field.object("humidity", "relative error of the vapour pressure", [&self](Field& humidity) {
    humidity("change", self.humidity_change, "estimate");
    humidity("stderr", self.humidity_error, "standard error");
  });
  field.object("parts", "corrections from parts of the data", [&self](Field& parts) {
    parts("flights", self.parts_by_flight, "correction of each flight");
    parts("climbs_and_descents", self.parts_by_climb, "correction of climbs and of descents");
    parts("halves", self.parts_by_half, "correction of the first and of the second half of the flights");
    parts("spread_of_flights_k", self.spread_of_flights, "spread of flights; 0 if they agree");
    parts("spread_of_climbs_k", self.spread_of_climbs, "spread of climbs and descents; 0 if they agree");
    parts("spread_of_halves_k", self.spread_of_halves, "spread of the halves; 0 if they agree");
  });
  field("worse", self.rejection_reason, "reason for which the correction is rejected; otherwise empty");
  field("warnings", self.warnings, "warnings");
  field("notes", self.notes, "notes on the calibration");
}

/// Calibrates the temperature by GPS height: the hydrostatic equation, integrated along each flight with the
/// corrected temperature, is compared with the height (memo, eqs. 23 and 24 and GV addition).
///
/// An existing temperature correction of the model is removed first; the result replaces it. Flights need
/// climbs or descents, GPS height, latitude, a thermometer and corrected pressures. The integral restarts at
/// height steps and missing values.
///
/// The static-pressure model may be wrong, with different errors in climbs and in level flight. An error
/// proportional to the dynamic pressure, one proportional to the angle of attack (if the model uses it) and
/// one proportional to the humidity are fitted with the coefficients and corrected. A constant bias is
/// included in the standard errors. An error proportional to the static pressure does not change heights.
///
/// @throws Error if no flight can be used, with the reason for the first one.
TemperatureResult fit_temperature(const FlightSet& flights, const ModelDefinition& model,
                                  const TemperatureOptions& options = {});

/// Iteration of `calibrate_iteratively`.
struct CalibrationRound {
  double rms_hpa = 0.0;                ///< rms residual of the pressure fit
  std::vector<double> coefficients{};  ///< coefficients of the temperature correction
  double defect_change = 0.0;          ///< rms change of delta-p over the flights in this iteration, hPa
  double temperature_change = 0.0;     ///< largest change of the correction over the temperature range, K
};

template <class Field>
void describe(const CalibrationRound& self, Field& field) {
  field("rms_hpa", self.rms_hpa, "rms residual of the pressure fit");
  field("coefficients", by_power(self.coefficients), "coefficients of the temperature correction",
        power_units);
  field("defect_change_hpa", self.defect_change, "change of delta-p, rms over the flights");
  field("temperature_change_k", self.temperature_change, "largest change of the temperature correction");
}

struct IterativeCalibration {
  RefitResult pressure;  ///< result of the last iteration
  /// Result of the last iteration, degree of the first; its model has both corrections.
  TemperatureResult temperature;
  std::vector<CalibrationRound> rounds{};
  bool converged = false;
};

template <class Field>
void describe(const IterativeCalibration& self, Field& field) {
  describe(self.temperature, field);
  if (!field.has(!self.rounds.empty())) return;
  field("rounds", self.rounds, "iterations of pressure and temperature; absent without --iterate");
  field("converged", self.converged, "whether the iterations converged; absent without --iterate");
}

/// The memo's iteration: delta-p from LAMS depends on the temperature, and the temperature on the pressure.
/// Alternates both fits until delta-p changes by less than 0.001 hPa and the temperature by less than 0.001
/// K.
/// @throws Error as `refit` and `fit_temperature`, and for archived flights, whose pressures cannot change.
IterativeCalibration calibrate_iteratively(const FlightSet& flights, const ModelDefinition& model,
                                           const References& references, const RefitOptions& refit_options,
                                           const TemperatureOptions& temperature_options);

/// "none", "constant", "linear" or "quadratic", for a degree of -1 to 2.
std::string degree_name(int degree);

/// The unit of coefficient a0, a1 or a2: "K", "1" or "1/K".
std::string coefficient_unit(std::size_t power);

/// One or two sentences on the effect of a constant static-pressure bias on the coefficients and their
/// standard errors.
std::string pressure_error_text(const TemperatureResult& result);

/// Report of a temperature calibration.
Report temperature_report(const TemperatureResult& result);

}  // namespace pcor
