#pragma once

#include <pcor/offline/line_fit.hpp>
#include <pcor/offline/noise.hpp>
#include <pcor/offline/residuals.hpp>

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcor {

/// What residuals, hPa, amount to over some samples. NaN where there are too few samples.
struct Statistics {
  std::size_t samples = 0;
  double bias = 0.0;        ///< mean residual, hPa
  double bias_error = 0.0;  ///< its standard error, hPa, for the memory of the noise
  double rms = 0.0;         ///< about zero, hPa
  double noise_rms = 0.0;   ///< of the noise floor over the same samples, hPa: the lowest of all models

  /// The scatter about the bias, hPa.
  double scatter() const;
  /// By how much the rms is larger than the noise alone would make it; NaN where the noise is not known.
  double rms_over_noise() const;
};

/// Whether a model fails more in `a` than in `b`: by how much the mean square is above that of the noise.
/// Where the noise is not known nothing is said to fail.
bool fails_more(const Statistics& a, const Statistics& b);

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

/// One model held against the reference over all flights.
struct ModelComparison {
  std::string name;
  Statistics all;
  /// 1 - sum of squared residuals / sum of squared departures of the reference's delta-p from its mean.
  double r_squared = 0.0;
  double samples_per_independent = 1.0;
  std::vector<PartStatistics> regimes;  ///< those that occur, in the order of `Regime`
  std::vector<PartStatistics> bands;    ///< altitude, Mach, angle of attack, sideslip
  std::vector<PartStatistics> flights;
  std::vector<WorstInterval> worst;  ///< at most five, the worst first
};

/// The residuals of one flight, one value for each record.
struct FlightResiduals {
  std::shared_ptr<const FlightSamples> samples;
  std::vector<Mask> mask;                   ///< of the first model; the samples used are those of all models
  std::vector<std::vector<double>> values;  ///< of each model, hPa; NaN where the sample is not used
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
  std::string reference;  ///< in words
  std::vector<ModelComparison> models;
  std::vector<FlightResiduals> flights;
  /// The total pressures of two systems, of the reference against that of the model: static defects cancel in
  /// it (R6). Where the reference is a static system.
  std::optional<LineFit> total_pressure{};
  /// The corrected static pressures, of the reference against that of the first model, as distances from the
  /// line (R54).
  LineFit static_pressure;
  std::array<std::size_t, mask_count> masks{};  ///< samples with each reason, over all flights
  std::vector<std::string> notes;               ///< what a user should know, a sentence each
};

struct CompareOptions {
  MaskOptions mask;
  TimeStamp time_stamp = TimeStamp::begin;
  std::function<void(std::size_t done, std::size_t total)> progress{};  ///< told after every flight
};

/// A model, and what it is held against.
struct Contender {
  std::string name;  ///< in tables
  ModelFile model;
  Reference reference;
};

/// Holds every contender against its reference over the flights. A sample counts where all models have a
/// residual, so the figures of models can be compared.
///
/// @throws Error if a flight cannot be read, a variable is absent, the flights are of different aircraft, or
/// no sample is left: the message says which mask took how many.
Comparison compare(const std::vector<std::filesystem::path>& flights,
                   const std::vector<Contender>& contenders, const CompareOptions& options = {});

/// Refuses flights of different aircraft. @throws Error that names two that differ.
void require_one_aircraft(const std::vector<std::pair<std::string, std::string>>& flight_and_aircraft);

/// Refuses a flight that is given twice: its samples would count as if they were new. @throws Error
void require_each_once(const std::vector<std::filesystem::path>& paths);

/// For messages: the reasons why samples are not used, the largest first: "1203 on the ground, 17 laser ...".
std::string mask_text(const std::array<std::size_t, mask_count>& counts);

/// Statistics of the residuals of one series at the samples where `used` is true.
/// @param noise the noise floor of the series
Statistics statistics_of(const std::vector<double>& residuals, const NoiseFloor& noise,
                         const std::vector<bool>& used);

/// Writes the residuals of a flight to a netCDF file: for each model RESIDUAL_1, RESIDUAL_2 ..., delta-p of
/// the model PCOR_1 ... and of the reference PCOR_REFERENCE_1 ..., and the mask and the regimes as flags.
/// @throws Error if the file cannot be written.
void write_residuals(const Comparison& comparison, std::size_t flight, const std::filesystem::path& input,
                     const std::filesystem::path& output, const std::string& history);

}  // namespace pcor
