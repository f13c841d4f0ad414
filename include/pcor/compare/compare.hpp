#pragma once

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

/// Statistics of a part of the samples: a regime, or a band of a variable.
struct PartStatistics {
  std::string name;  ///< "climb", or "Mach 0.30 to 0.35"
  Statistics statistics;
};

/// A stretch of a flight in which a model fails most.
struct WorstInterval {
  std::string flight;
  double begin = 0.0;  ///< s since 1970 UTC
  double end = 0.0;
  Statistics statistics;
  std::string regimes;  ///< what was flown, for example "climb, turn"
};

/// One model held against one reference over all flights.
struct ModelComparison {
  std::string name;
  std::string reference;  ///< as `Reference::name` has it
  Statistics all;
  /// 1 - sum of squared residuals / sum of squared departures of the reference's delta-p from its mean; NaN
  /// for a reference that is no static pressure.
  double r_squared = 0.0;
  double autocorrelation_time = 1.0;
  /// By how much the calibration of the reference and of the thermometer may shift the bias of all samples,
  /// hPa, beside `Statistics::bias_error`: usual sizes (`ParameterInfo::doubt`), or what `[uncertainty]` of
  /// the models states. Zero for references of many samples (wind, height).
  double reference_error = 0.0;
  std::vector<PartStatistics> regimes;  ///< those that occur, in the order of `Regime`
  std::vector<PartStatistics> bands;    ///< altitude, Mach, angle of attack, sideslip
  std::vector<PartStatistics> flights;
  std::vector<WorstInterval> worst;  ///< at most five, the worst first
  Statistics flaps_out;              ///< of the samples that take no part because flaps are out
};

/// The residuals of one flight, one value for each record.
struct FlightResiduals {
  std::shared_ptr<const FlightSamples> samples;
  std::vector<Mask> mask;                   ///< of the first model; the samples used are those of all models
  std::vector<std::vector<double>> values;  ///< of each model, hPa; NaN where the sample is not used
  std::vector<std::vector<double>> flaps_out;  ///< the same at samples left out for nothing but their flaps
  std::vector<std::vector<double>> reference_defects;  ///< delta-p that the reference asks of each model, hPa
  std::vector<std::vector<double>> model_defects;      ///< delta-p of each model, hPa
  std::vector<double> static_pressure;                 ///< as measured, hPa
  std::vector<double> corrected_pressure;              ///< static pressure of the first model, hPa
  std::vector<double> total_pressure;                  ///< p_m + q_m of the first model, hPa
  /// p_m + q_m of the reference, hPa, where that is a static system; else empty.
  std::vector<double> reference_total_pressure;
  std::vector<double> mach;           ///< of the first model's corrected pressures
  std::vector<double> dynamic_ratio;  ///< q_m/p_m
};

struct Comparison {
  std::string reference;           ///< in words
  bool is_static_pressure = true;  ///< the reference; else the residual is of something else, in hPa
  std::vector<ModelComparison> models;
  /// Those whose records are kept, in their order: all, or of many those in which the models fail most and
  /// others spread over the time in which they were flown.
  std::vector<FlightResiduals> flights;
  std::vector<std::pair<std::string, Interval>> intervals;  ///< of all flights, with the flight's name
  /// The total pressures of two systems, of the reference against that of the model: static defects cancel in
  /// it (memo, figure 1). Where the reference is a static system.
  std::optional<LineFit> total_pressure{};
  /// The corrected static pressures, of the reference against that of the first model, as distances from the
  /// line (memo, figure 2). Where the reference is a static pressure.
  LineFit static_pressure;
  std::array<std::size_t, mask_count> masks{};  ///< samples with each reason, over all flights
  std::vector<std::string> notes;               ///< what a user should know, a sentence each
  std::vector<Comparison> further{};  ///< with each of the further references, of the models that have it
};

struct CompareOptions {
  MaskOptions mask;
  /// Of how many flights the records are kept; the numbers are of all. Where there are more, those
  /// that are kept are read once more.
  std::size_t max_series = 16;
  /// Told after every flight of this member with every reference.
  std::function<void(std::size_t done, std::size_t total)> progress{};
};

/// A model, and what it is held against.
struct ComparedModel {
  std::string name;  ///< in tables
  ModelDefinition model;
  References references;
};

/// Holds the contenders against the first reference of the first of them over the flights, then against each
/// of the further ones that any has. References are the same where they have one name; a contender without a
/// reference of that name takes no part there. A sample counts where all models that do have a residual, so
/// the figures of models can be compared. A further reference that leaves no sample is only noted.
///
/// @throws Error if a flight cannot be read, a variable is absent, the flights are of different aircraft, or
/// no sample is left: the message says which mask took how many.
Comparison compare(const FlightSet& flights, const std::vector<ComparedModel>& contenders,
                   const CompareOptions& options = {});

/// Writes the residuals of a flight to a netCDF file: for each model RESIDUAL_1, RESIDUAL_2 ..., delta-p of
/// the model PCOR_1 ... and of the reference PCOR_REFERENCE_1 ..., and the mask and the regimes as flags.
/// @param number of the flight among those whose records are kept @param input the file of that flight
/// @throws Error if the file cannot be written.
void write_residuals(const Comparison& comparison, std::size_t number, const Flight& input,
                     const std::filesystem::path& output, const std::string& history);

}  // namespace pcor
