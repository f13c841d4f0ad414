#pragma once

#include <pcor/base/note.hpp>
#include <pcor/campaign/flight_set.hpp>
#include <pcor/numerics/line_fit.hpp>
#include <pcor/residuals/residuals.hpp>
#include <pcor/residuals/statistics.hpp>

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pcor {

/// Statistics of a subset of the samples: a regime, or a band of a variable.
struct PartStatistics {
  std::string name;  ///< "climb", or "Mach 0.30 to 0.35"
  Statistics statistics;
};

template <class Field>
void describe(const PartStatistics& self, Field& field) {
  field("name", self.name, "name of the part");
  describe(self.statistics, field);
}

/// Time range of a flight with the largest residuals.
struct WorstInterval {
  std::string flight;
  double begin = 0.0;  ///< s since 1970 UTC
  double end = 0.0;
  Statistics statistics;
  std::string regimes;  ///< e.g. "climb, turn"
};

template <class Field>
void describe(const WorstInterval& self, Field& field) {
  field("flight", self.flight, "file of the flight");
  field.time("begin", self.begin, "begin of the interval");
  field.time("end", self.end, "end of the interval");
  field("regimes", self.regimes, "regimes in the interval");
  describe(self.statistics, field);
}

/// Line through pressures.
template <class Field>
void describe(const LineFit& self, Field& field) {
  field("slope", self.slope, "slope of the line");
  field("slope_stderr", self.slope_error, "standard error of the slope");
  field("offset_hpa", self.offset, "offset of the line");
  field("rms_hpa", self.rms, "rms distance from the line");
  field("mean_difference_hpa", self.mean_difference, "mean difference of the pressures");
  field("samples", self.samples, "number of samples");
}

/// Comparison of one model with one reference over all flights.
struct ModelComparison {
  std::string name;
  std::string reference;     ///< see `Reference::name`
  bool is_circular = false;  ///< the reference reads the static pressure of the model
  Statistics all;
  /// 1 - sum of squared residuals / sum of squared deviations of the reference's delta-p from its mean; NaN
  /// for a reference that is not a static pressure.
  double r_squared = 0.0;
  /// Fit of the corrected static pressure of the reference against that of the model, as distances from the
  /// line (memo, figure 2), if the reference is a static pressure.
  LineFit static_pressure{};
  double autocorrelation_time = 1.0;  ///< samples; NaN if the residual does not scatter
  /// Standard deviation of the common bias due to the calibration of the reference and of the thermometer,
  /// hPa, in addition to `Statistics::bias_error`: typical sizes (`ParameterInfo::calibration_uncertainty`),
  /// or `[uncertainty]` of the models. Zero for references with a window (wind, height).
  double reference_error = 0.0;
  std::vector<PartStatistics> regimes;  ///< regimes that occur, in the order of `Regime`
  std::vector<PartStatistics> bands;    ///< altitude, Mach, angle of attack, sideslip
  std::vector<PartStatistics> flights;
  std::vector<WorstInterval> worst;  ///< up to five, sorted by decreasing size
  Statistics flaps_out;              ///< samples excluded because of flaps

  /// Whether the reference is wind or height. The residual contains variations of the atmosphere and, within
  /// a minute, errors of the model, and so does its noise: an upper limit of that of the sensors.
  bool is_by_gps() const { return reference == "wind" || reference == "height"; }
  /// Rms residual divided by the noise of the sensors; NaN if this noise is unknown, as by GPS.
  double noise_ratio() const;
};

template <class Field>
void describe(const ModelComparison& self, Field& field) {
  field("name", self.name, "name of the model");
  field("reference", self.reference, "reference");
  field("circular", self.is_circular, "whether the reference reads the static pressure of the model");
  describe(self.all, field);
  field("rms_over_noise", self.all.rms_over_noise(), "rms residual divided by the rms noise");
  field("r2", self.r_squared, "fraction of the variance of delta-p of the reference that the model explains");
  if (field.has(self.static_pressure.samples > 0))
    field("static_pressure", self.static_pressure, "static pressure, reference against model");
  field("flaps_out", self.flaps_out, "residual of samples excluded because of flaps");
  field("samples_per_independent", self.autocorrelation_time, "autocorrelation time", "samples");
  field("reference_stderr_hpa", self.reference_error, "standard error of the bias due to calibrations");
  field("regimes", self.regimes, "residual in each regime");
  field("bands", self.bands, "residual in bands of altitude, Mach number, attack and sideslip");
  field("flights", self.flights, "residual of each flight");
  field("worst", self.worst, "intervals with the largest residuals");
}

/// Residuals of one flight, one value for each record. A quantity with one value for all models belongs to
/// the first model by name, regardless of the order on the command line.
struct FlightResiduals {
  std::shared_ptr<const FlightSamples> samples;
  /// Mask of the first model; used samples are common to all models.
  std::vector<Mask> mask;
  std::vector<std::vector<double>> values;     ///< residuals of each model, hPa; NaN for unused samples
  std::vector<std::vector<double>> flaps_out;  ///< residuals of samples excluded only because of flaps
  std::vector<std::vector<double>> reference_defects;    ///< delta-p of the reference for each model, hPa
  std::vector<std::vector<double>> model_defects;        ///< delta-p of each model, hPa
  std::vector<std::vector<double>> corrected_pressures;  ///< static pressure of each model, hPa
  std::vector<double> static_pressure;                   ///< measured, hPa
  std::vector<double> total_pressure;                    ///< p_m + q_m of the first model, hPa
  /// Total pressure p_m + q_m of the reference, hPa, if it is a static system; otherwise empty.
  std::vector<double> reference_total_pressure;
  std::vector<double> mach;           ///< Mach number from the first model's corrected pressures
  std::vector<double> dynamic_ratio;  ///< q_m/p_m
};

struct Comparison {
  std::string reference;           ///< description
  bool is_static_pressure = true;  ///< false: the residual is another quantity, in hPa
  std::vector<ModelComparison> models;
  /// Flights whose records are kept, in their order: all, or, of many, those with the largest residuals and
  /// others spread over the period of the flights.
  std::vector<FlightResiduals> flights;
  /// Intervals of all flights, with the flight's name.
  std::vector<std::pair<std::string, Interval>> intervals;
  /// Fit of the total pressure of the reference against that of the model, if the reference is a static
  /// system: static defects cancel (memo, figure 1).
  std::optional<LineFit> total_pressure{};
  std::array<std::size_t, mask_count> masks{};  ///< samples with each mask, over all flights
  Notes notes;                                  ///< notes for the user, one sentence each
  /// Comparisons with further references of the models.
  std::vector<Comparison> further{};
};

template <class Field>
void describe(const Comparison& self, Field& field) {
  field("reference", self.reference, "first reference");
  std::vector<ModelComparison> models = self.models;
  for (const Comparison& further : self.further)
    models.insert(models.end(), further.models.begin(), further.models.end());
  field("models", models, "residual of each model with each reference");
  field("total_pressure", self.total_pressure, "total pressure, reference against model");
  field("masks", field.named(mask_info, self.masks), "samples with each mask");
  field.list("intervals", self.intervals, "regimes of all flights", [](const auto& each, Field& of_one) {
    const auto& [flight, interval] = each;
    of_one("flight", flight, "file of the flight");
    of_one("regime", interval.regime == Regime::count ? "" : info_of(interval.regime).name, "regime");
    of_one.time("begin", interval.begin, "begin of the interval");
    of_one.time("end", interval.end, "end of the interval");
    of_one("pair", interval.pair, "number of the reverse-heading pair; otherwise 0");
    of_one("note", interval.note, "description of the interval");
  });
  field("notes", self.notes, "notes on the comparison");
}

/// Comparison of a model with the reference in which its ratio of rms to noise is largest: `first`, of the
/// first reference, or that of a further reference with the same model. Wind and height do not count beside
/// others, because their residuals contain gusts. An unknown ratio is the smallest.
const ModelComparison& worst_by_noise(const Comparison& comparison, const ModelComparison& first);

/// Labels of the models in tables and pictures, in their order: the names, or, if one of several has more
/// than 32 characters, "model 1", "model 2".
std::vector<std::string> model_labels(const Comparison& comparison);

struct CompareOptions {
  MaskOptions mask;
  /// Maximum number of flights whose records are kept; statistics use all flights. If there are more, the
  /// kept ones are read twice.
  std::size_t max_series = 16;
  /// Against wind and height, separates mean residuals and their errors from the variations of the atmosphere
  /// and from the usual errors of heading, flow angles and thermometer. Takes seconds per flight. If false,
  /// the mean residuals contain gusts, drift and shear of the wind.
  bool separates_atmosphere = true;
  /// Callback after every flight of this rank with every reference.
  std::function<void(std::size_t done, std::size_t total)> progress{};
};

/// Model with its references.
struct ComparedModel {
  std::string name;  ///< label in tables
  ModelDefinition model;
  References references;
};

/// Compares the models with the first reference of the first model (by name) over the flights, then with each
/// further reference that any model has. References with equal names are the same; a model without that
/// reference is excluded from its comparison. A sample is used if all models of the comparison have a
/// residual, so that their statistics are comparable. A further reference without usable samples only adds a
/// note.
///
/// @throws Error if a flight cannot be read, a variable is absent, the flights are of different aircraft, or
/// no sample remains: the message lists the number of samples of each mask.
Comparison compare(const FlightSet& flights, const std::vector<ComparedModel>& models,
                   const CompareOptions& options = {});

/// Writes the residuals of a flight to a netCDF file: for each model RESIDUAL_1, RESIDUAL_2 ..., delta-p of
/// the model PCOR_1 ..., their sum PCOR_REFERENCE_1 ... (delta-p of the reference, if that is a static
/// pressure), and the mask and the regimes as flags.
/// @param number index of the flight among those whose records are kept @param input the file of that flight
/// @throws Error if the file cannot be written.
void write_residuals(const Comparison& comparison, std::size_t number, const Flight& input,
                     const std::filesystem::path& output, const std::string& history);

}  // namespace pcor
