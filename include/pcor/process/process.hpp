#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <pcor/base/note.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/model/quality.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/realtime/stages.hpp>

namespace pcor {

/// Part of the standard uncertainties of results that is written: total; systematic, constant from sample to
/// sample (covariance of the model's parameters); or random, independent between samples (sensors and the
/// remaining error of the model).
enum class UncertaintyPart { total_if_stated, total, systematic, random, none };

/// How a flight is processed.
struct ProcessOptions {
  CorrectWith correct_with = CorrectWith::model;
  /// Copy all variables of the input except text, instead of only coordinates and inputs.
  bool copy_all = false;
  /// Write `HYDSTEP`, the hydrostatic height per kelvin of each step, and copy the other inputs of a
  /// temperature fit.
  bool hydrostatic = false;
  UncertaintyPart uncertainty = UncertaintyPart::total_if_stated;
  /// Correct the readings of a frozen sensor, too; otherwise they are missing. The bit `sensor_frozen` is set
  /// in both cases.
  bool keep_frozen = false;
  std::string suffix{};  ///< added to the name of every derived variable
  TimestampAlignment timestamp_alignment = TimestampAlignment::begin;
  std::string history{};  ///< history attribute of the output, e.g. the command line
  /// Callback after every block of records.
  std::function<void(std::size_t done, std::size_t total)> progress{};
};

/// Time for which the law of a model was not fitted: its results have no stated uncertainty.
struct OutsideSpan {
  std::string reason;  ///< "flaps extended" or "outside the domain"
  double begin = 0.0;  ///< seconds since 1970 UTC
  double end = 0.0;    ///< end of the last record
};

/// Result of processing a flight.
struct ProcessSummary {
  std::string aircraft;
  std::string project;
  std::string flight;
  std::size_t records = 0;
  int rate = 1;  ///< samples in a record
  std::size_t samples = 0;
  std::size_t corrected = 0;  ///< samples in which both pressures could be corrected
  std::size_t gaps = 0;
  double start_time = 0.0;  ///< seconds since 1970 UTC
  double end_time = 0.0;
  /// Minimum measured dynamic pressure of samples in flight, hPa: its value at `RegimeCriteria::flying_speed`
  /// at sea level in the standard atmosphere.
  double flying_dynamic_pressure = 0.0;
  std::size_t in_flight = 0;  ///< corrected samples in flight
  double mean_defect = 0.0;   ///< mean delta-p applied in flight, hPa; NaN if no sample was corrected
  double min_defect = 0.0;    ///< minimum in flight, hPa
  double max_defect = 0.0;    ///< maximum in flight, hPa
  /// Mean standard uncertainty of delta-p in flight, hPa; NaN if it is not stated.
  double defect_uncertainty = missing<double>();
  /// Samples with each quality bit, in flight and on the ground.
  std::array<std::size_t, quality_info.size()> flagged{};
  std::vector<OutsideSpan> outside{};  ///< spans without stated uncertainties; of the domain: in flight
  std::vector<std::string> outputs;    ///< names of the derived variables, in order
  Notes notes;                         ///< notes for the user, one sentence each
};

template <class Field>
void describe(const ProcessSummary& self, Field& field) {
  field("aircraft", self.aircraft, "aircraft, from the attributes of the file");
  field("project", self.project, "project, from the attributes of the file");
  field("flight", self.flight, "number of the flight, from the attributes of the file");
  field.time("start", self.start_time, "time of the first record");
  field.time("end", self.end_time, "time of the last record");
  field("records", self.records, "number of records");
  field("rate", self.rate, "samples in a record");
  field("samples", self.samples, "number of samples");
  field("corrected", self.corrected, "samples in which both pressures were corrected");
  field("flying_dynamic_pressure_hpa", self.flying_dynamic_pressure, "minimum of samples in flight");
  field("in_flight", self.in_flight, "corrected samples in flight");
  field("gaps", self.gaps, "number of gaps in time");
  field.object("delta_p_hpa", "delta-p applied in flight", [&self](Field& delta_p) {
    delta_p("mean", self.mean_defect, "mean", "hPa");
    delta_p("least", self.min_defect, "minimum", "hPa");
    delta_p("greatest", self.max_defect, "maximum", "hPa");
    delta_p("uncertainty", self.defect_uncertainty, "mean standard uncertainty; null if not stated", "hPa");
  });
  field("flags", field.named(quality_info, self.flagged), "samples with each quality bit");
  field.list("outside", self.outside, "spans for which the law was not fitted",
             [](const OutsideSpan& span, Field& outside) {
               outside("reason", span.reason, "flaps extended, or outside the domain");
               outside.time("begin", span.begin, "first record");
               outside.time("end", span.end, "end of the last record");
             });
  field("variables", self.outputs, "derived variables of the output");
  field("notes", self.notes, "notes on the flight");
}

/// Text: "delta-p 0.01 hPa on average (-0.18 to 0.27), standard uncertainty 4.40 hPa", or that delta-p is
/// zero.
std::string format_defect(const ProcessSummary& summary);

/// Runs every sample of the flight `input` through the real-time loop of `model` and writes the derived
/// variables to `output`: delta-p (`PCOR`, `PCOR_LAMS`), corrected pressures (`PSXC`, `QCXC`), `MACHX`,
/// `ATX`, `TASX`, `ATLAMS`, `ATLAMSF`, `QCLAMS` and the quality bits `PCORFLAG`, named by the model's
/// `[output]` table, with their coordinates and inputs. Pressures in hPa, temperatures in degC, speeds in
/// m/s. TASX requires a temperature; the LAMS variables require LAMS. ATX is written if it is computed from a
/// recovery temperature or if a recorded temperature is calibrated.
///
/// ATLAMSF is ATLAMS without periods under 3 s (`LowPass`), each value at the time of its sample: the delay
/// of the loop is compensated, also for the bit `filter_window_incomplete`. The filter does not extend across
/// gaps: at 25 Hz the first and last 0.4 s of a contiguous segment have no value.
///
/// If the model states uncertainties (`uncertainty_of`), `PCOR_uncertainty`, `PSXC_uncertainty`,
/// `QCXC_uncertainty`, `ATX_uncertainty` and `TASX_uncertainty` are written with their results, which name
/// them in `ancillary_variables` (`ResultUncertainty`); notes list the contributions that are not included.
///
/// `hydrostatic` adds `HYDSTEP`, -(R_a/g0) ln(p_i/p_(i-1)) in m/K (`hydrostatic_step`): multiplied by the
/// mean temperature of two samples in K it is the step of geopotential height (standard gravity) between
/// them. It is missing for the first sample, after a gap, and if either PSXC is missing. Its attribute
/// `temperature_calibration` holds a0 (K), a1 and a2 (1/K) of the model's temp-calibration, which ATX already
/// includes, and its attribute `model` the other parts of the model on which the pressures depend.
///
/// The loop runs at the higher rate of the two pressures; other inputs are resampled to it
/// (`Flight::read_at_rate`). Missing or impossible input gives missing output and a quality bit. The same
/// holds for a frozen sensor, detected as in comparisons and fits from its whole series at one sample per
/// record. Records with extended flaps, recorded or inferred from the lift, have the bit `outside_domain`
/// unless an effect of the model depends on the flaps; notes state this, or that the flaps are unknown. Their
/// uncertainties are missing, as outside the domain of the law (`ResultUncertainty`).
/// Except for the series of these two tests, memory does not depend on the length of the flight.
///
/// @throws Error, and leaves `output` unchanged, if the flight or a variable of the model cannot be read, a
/// unit is unknown, the model cannot be used, an uncertainty is requested that the model does not state, a
/// name is already used, no sample of a flight that flew can be corrected, or the output cannot be written.
ProcessSummary process_flight(const std::filesystem::path& input, const ModelDefinition& model,
                              const std::filesystem::path& output, const ProcessOptions& options = {});

}  // namespace pcor
