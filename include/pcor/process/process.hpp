#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/model/quality.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/realtime/stages.hpp>

namespace pcor {

/// Which part of the standard uncertainties of results is written: all of it, what stays the same from sample
/// to sample (the covariance of the model's parameters), or what does not (sensors, and what the law leaves).
enum class UncertaintyPart { total_if_stated, total, systematic, random, none };

/// How a flight is processed.
struct ProcessOptions {
  CorrectWith correct_with = CorrectWith::model;
  /// Copy every variable of the input but texts, not only coordinates and what was used.
  bool copy_all = false;
  /// Write the steps of hydrostatic height, `HYDSTEP`, and copy what a fit of temperature needs besides.
  bool hydrostatic = false;
  UncertaintyPart uncertainty = UncertaintyPart::total_if_stated;
  /// Correct what a frozen sensor reads, too; else it is missing. The bit `sensor_frozen` stands either way.
  bool keep_frozen = false;
  std::string suffix{};  ///< added to the name of every derived variable
  TimestampAlignment timestamp_alignment = TimestampAlignment::begin;
  std::string history{};  ///< what the output says of its making, e.g. the command line
  std::function<void(std::size_t done, std::size_t total)> progress{};  ///< told after every block of records
};

/// What was done to a flight.
struct ProcessSummary {
  std::string aircraft;
  std::string project;
  std::string flight;
  std::size_t records = 0;
  int rate = 1;  ///< samples in a record
  std::size_t samples = 0;
  std::size_t corrected = 0;  ///< samples in which both pressures could be corrected
  std::size_t gaps = 0;
  double first_time = 0.0;  ///< seconds since 1970 UTC
  double last_time = 0.0;
  /// In flight: with a measured dynamic pressure (hPa) of this or more, that of the flying speed of the
  /// aircraft (`RegimeCriteria::flying_speed`) at sea level in the standard atmosphere.
  double flying_dynamic_pressure = 0.0;
  std::size_t in_flight = 0;  ///< of the corrected samples
  double mean_defect = 0.0;   ///< of the delta-p applied in flight, hPa; NaN where none was
  double min_defect = 0.0;    ///< in flight, hPa
  double max_defect = 0.0;    ///< in flight, hPa
  std::array<std::size_t, quality_info.size()> flagged{};  ///< samples with each quality bit, flown or not
  std::vector<std::string> outputs;                        ///< names of the derived variables, in order
  std::vector<std::string> notes;                          ///< what a user should know, a sentence each
};

/// Runs every sample of the flight `input` through the real-time loop of `model` and writes the derived
/// variables to `output`: delta-p (`PCOR`, `PCOR_LAMS`), corrected pressures (`PSXC`, `QCXC`), `MACHX`,
/// `ATX`, `TASX`, `ATLAMS`, `ATLAMSF`, `QCLAMS` and the quality bits `PCORFLAG`, under the names of the
/// model's `[output]` table, with the coordinates and inputs they came from. Pressures in hPa, temperatures
/// in degC, speeds in m/s. Without a temperature there is no TASX; without LAMS, none of its variables. ATX
/// is written where it is found from a recovery temperature, and where a recorded one is calibrated.
///
/// ATLAMSF is ATLAMS without periods under 3 s (`LowPass`), each value at the time of the sample that it is
/// of: the delay of the loop is taken out, and so it is for the bit `filter_window_incomplete`. Nothing goes
/// across a gap. At 25 Hz the first and last 0.8 s of a stretch without gaps have none.
///
/// Where the model states uncertainties (`uncertainty_of`), `PCOR_uncertainty`, `PSXC_uncertainty`,
/// `QCXC_uncertainty`, `ATX_uncertainty` and `TASX_uncertainty` are written beside their results, which name
/// them in `ancillary_variables` (`ResultUncertainty`); notes say what is not in them.
///
/// `hydrostatic` asks for `HYDSTEP`, -(R_a/g0) ln(p_i/p_(i-1)) in m/K (`hydrostatic_step`): times the mean
/// temperature of two samples in K it is the step of geopotential height (standard gravity) between them. It
/// has no value for the first sample, after a gap, and where either PSXC is missing. Its attribute
/// `temperature_calibration` holds a0 (K), a1 and a2 (1/K) of the model's temp-calibration, which ATX has in
/// it already, and its attribute `model` what of the rest of the model the pressures depend on.
///
/// The loop runs at the higher rate of the two pressures; other inputs are brought to it
/// (`Flight::read_at_rate`). Missing or impossible input gives missing output and a quality bit, and so
/// does a sensor that is frozen, which is found as comparisons and fits find it, from its whole series at one
/// sample per record. But for such a series memory does not depend on the length of the flight.
///
/// @throws Error, and leaves `output` as it was, if the flight or a variable that the model needs cannot be
/// read, a unit is unknown, the model cannot be used, an uncertainty is asked for of which the model states
/// nothing, a name is taken, or the output cannot be written.
ProcessSummary process_flight(const std::filesystem::path& input, const ModelDefinition& model,
                              const std::filesystem::path& output, const ProcessOptions& options = {});

}  // namespace pcor
