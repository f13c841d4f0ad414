#include <pcor/process/process.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/effects/catalogue.hpp>
#include <pcor/flight/flight_writer.hpp>
#include <pcor/physics/air_data.hpp>
#include <pcor/physics/standard_atmosphere.hpp>
#include <pcor/realtime/height_step.hpp>
#include <pcor/realtime/loop.hpp>
#include <pcor/regimes/regimes.hpp>
#include "flight/flight_file.hpp"
#include "model_io/archived_model.hpp"
#include "model_io/output_table.hpp"
#include "numerics/missing.hpp"
#include "process/copied_variables.hpp"
#include "process/delay_line.hpp"
#include "process/frozen_inputs.hpp"
#include "process/origin.hpp"
#include "process/output_uncertainty.hpp"
#include "process/outside_law.hpp"
#include "process/sample_statistics.hpp"
#include "roles/fast_series.hpp"
#include "roles/find_frozen.hpp"
#include "roles/model_inputs.hpp"
#include "roles/recorded_series.hpp"

namespace pcor::internal {
namespace {

/// Dynamic pressure, hPa, at the flying speed of an aircraft at sea level in the standard atmosphere. The
/// lift depends on the dynamic pressure, at any height.
double flying_dynamic_pressure(const std::string& aircraft) {
  const double speed = RegimeCriteria::of(aircraft).value_or(RegimeCriteria{}).flying_speed;
  return dynamic_pressure_from_airspeed(standard_pressure(0.0), speed, standard_temperature(0.0),
                                        dry_air<double>());
}

/// One flight on its way through the loop.
class Processing {
 public:
  Processing(const std::filesystem::path& input, const ModelDefinition& file, const ProcessOptions& options)
      : flight_(input, options.timestamp_alignment), given_(file), file_(file), options_(options) {}

  ProcessSummary run(const std::filesystem::path& output) {
    summary_.aircraft = flight_.aircraft();
    summary_.flying_dynamic_pressure = flying_dynamic_pressure(file_.model.aircraft);
    summary_.project = flight_.project();
    summary_.flight = flight_.flight_number();
    summary_.records = flight_.records();
    summary_.gaps = flight_.time().gap_count;
    summary_.start_time = flight_.time().first;
    summary_.end_time = flight_.time().last;

    choose_roles();
    for (Note& each : flight_.file().notes()) summary_.notes.push_back(std::move(each));
    for (Note& each : notes_on_law(flight_, file_)) summary_.notes.push_back(std::move(each));
    note_archive();
    // After the checks of variables: an error would wait for the end of this thread.
    sha256_ = std::async(sha256_of_file, flight_.path());
    keep_means();
    for (ModelInput& input : model_inputs(flight_, file_, *chain_, roles_, summary_.notes))
      inputs_.push_back({std::move(input)});
    for (const LoopInput& input : inputs_) names_.emplace(input.quantity, input.variable);
    find_frozen_sensors();
    flaps_ = find_extended_flaps(flight_, file_, options_, summary_);
    choose_rate();
    uncertainty_->note_unstated(file_, summary_.notes);
    statistics_.emplace(*chain_,
                        options_.correct_with == CorrectWith::model && uncertainty_->states_defect_error(),
                        summary_);
    const FileDescription description = describe();
    FlightWriter writer(output, flight_, description);
    copy_variables(writer, description);
    define_outputs(writer);
    define_flags(writer);

    for (const RecordBlock block : flight_.blocks()) {
      process_block(block);
      if (block.first + block.count == flight_.records()) flush();
      for (const auto line : {&results_, &filtered_})
        (*line)->write(writer, static_cast<std::size_t>(summary_.rate));
      writer.copy_records(block);
      if (options_.progress) options_.progress(block.first + block.count, flight_.records());
    }
    refuse_uncorrected();
    writer.finish();
    statistics_->finish();
    for (const LoopInput& input : inputs_) note_excluded(input, input.excluded, summary_.notes);
    statistics_->note_impossible_temperature(file_);
    note_outside_domain(flight_, statistics_->outside_domain(), flaps_, summary_);
    return summary_;
  }

 private:
  [[noreturn]] void fail_model(const std::string& what) const {
    throw Error(Error::Code::model, fmt::format("model '{}': {}", file_.model.name, what));
  }

  template <class... Values>
  void note(fmt::format_string<const Values&...> format, const Values&... values) {
    summary_.notes.push_back(fmt::format(format, values...));
  }

  std::string to_string(const std::string& standard) const {
    return file_.output_name(standard) + options_.suffix;
  }

  /// The roles that the flight can serve. LAMS may be off: its variable may be absent.
  void choose_roles() {
    for (const auto& [role, variable] : file_.variables) {
      if (role == Quantity::lams_airspeed && !flight_.has(variable)) {
        if (options_.correct_with == CorrectWith::lams) {
          flight_.file().refuse(
              Error::Code::variable,
              ": {} (lams_airspeed) is not in this file, so the flight cannot be corrected with "
              "LAMS; omit --correct-with lams",
              variable);
        }
        note("{} is not in this file: the flight is processed without LAMS", variable);
        continue;
      }
      roles_.push_back(role);
    }
    choose_chain();
  }

  /// Reads the series that are needed before the loop runs.
  void keep_means() const {
    std::set<std::string> names(chain_->extra_names().begin(), chain_->extra_names().end());
    for (const Quantity role : roles_) {
      if (chain_->needs(role) || is_always_read(role)) names.insert(file_.variables.at(role));
    }
    const VariableNaming& naming = naming_of(file_, flight_);
    for (const auto* pairs : {&naming.measured, &naming.processed}) {
      for (const PressurePair& pair : *pairs) names.insert({pair.static_pressure, pair.dynamic_pressure});
    }
    for (const Quantity role : {Quantity::altitude, Quantity::flaps, Quantity::recovery_temperature,
                                Quantity::vertical_speed, Quantity::roll, Quantity::attack,
                                Quantity::attack_differential_pressure, Quantity::radome_dynamic_pressure})
      names.insert(series_name(flight_, file_, role));
    flight_.keep_means(std::move(names));
  }

  void choose_chain() { chain_ = std::make_shared<const Chain>(chain_of(file_.model, roles_)); }

  /// Marks frozen sensors, and notes a flight that did not fly.
  void find_frozen_sensors() {
    std::vector<bool> flying;
    for (const LoopInput& input : inputs_) {
      if (input.quantity != Quantity::dynamic_pressure) continue;
      const std::vector<double> values = read_values(flight_, input.variable, input.conversion).values;
      flying = in_flight(values, summary_.flying_dynamic_pressure);
      note_no_flight(input.variable, values);
    }
    frozen_ = find_frozen_inputs(flight_, flying, options_.keep_frozen, inputs_, summary_.notes);
  }

  void note_no_flight(const std::string& variable, const std::vector<double>& dynamic_pressure) {
    double maximum = nan;
    for (const double value : dynamic_pressure) maximum = std::fmax(maximum, value);
    // A unit that the model states is the more likely cause.
    did_not_fly_ =
        maximum < summary_.flying_dynamic_pressure && file_.units.count(Quantity::dynamic_pressure) == 0;
    if (!did_not_fly_) return;
    summary_.notes.push_back(warning_note(fmt::format(
        "the aircraft did not fly, or the unit of {} is wrong: its maximum is {:.1f} hPa, less than "
        "the {:.0f} hPa of flight",
        variable, maximum, summary_.flying_dynamic_pressure)));
  }

  /// Warns of fewer than 1 % corrected samples. @throws Error if a flight that flew has no corrected sample;
  /// the output is then not written
  void refuse_uncorrected() {
    const std::string text = statistics_->uncorrected_text();
    if (text.empty()) return;
    if (summary_.corrected > 0 || did_not_fly_) {
      summary_.notes.push_back(warning_note(text));
    } else {
      flight_.file().refuse(
          Error::Code::samples, ": {}; {}", text,
          frozen_.texts.empty()
              ? "compare the [variables] and [units] of the model with the roles that 'pcor inspect' finds"
              : fmt::format("{}; --keep-frozen uses these readings", fmt::join(frozen_.texts, "; ")));
    }
  }

  void choose_rate() {
    for (const Quantity pressure : {Quantity::static_pressure, Quantity::dynamic_pressure}) {
      summary_.rate = std::max(summary_.rate, flight_.variable(file_.variable_of(pressure)).rate);
    }
    std::string why;
    const double rate = summary_.rate / flight_.time().step;
    summary_.samples = summary_.records * static_cast<std::size_t>(summary_.rate);
    uncertainty_.emplace(file_, chain_, options_);
    const ShortestPeriods periods = choose_periods();
    loop_ = Loop::build(chain_, rate, &why, options_.correct_with, uncertainty_->stated(), periods);
    if (!loop_) fail_model(why);
    loop_->do_not_watch_sensors();  // this host knows their whole series
    results_.emplace(loop_->delay());
    filtered_.emplace(loop_->delay() + (chain_->has_lams() ? LowPass::delay(rate) : 0));
    sample_step_ = 1.0 / rate;
    if (!options_.hydrostatic) return;
    loop_->add(std::make_unique<HeightStep>());
    if (!loop_->order(&why)) fail_model(why);
  }

  /// Rates of change are limited to the frequencies at which the recorded values are signal.
  ShortestPeriods choose_periods() {
    ShortestPeriods periods;
    std::vector<double> time;
    for (const auto& [quantity, rate] : rates) {
      if (!chain_->derives(rate)) continue;
      if (time.empty()) time = record_times(flight_);
      const auto input = std::find_if(inputs_.begin(), inputs_.end(),
                                      [of = quantity](const LoopInput& each) { return each.quantity == of; });
      const FastSeries series = read_fast(flight_, *input, flight_.variable(input->variable).rate);
      const SignalBand band = signal_band_of(series, time, flight_.time().step);
      periods.emplace_back(rate, std::max(RateFilter::usual_period, band.min_period));
      leave_out_noise(rate, band);
    }
    return periods;
  }

  /// Effects that add more noise to a result than they remove error are not applied.
  void leave_out_noise(Quantity rate, const SignalBand& band) {
    const double signal = band.rate_variance - band.rate_noise;
    if (!(band.rate_noise > signal)) return;
    for (ModelEffect& effect : file_.model.effects) {
      if (effect.is_formula()) continue;
      const EffectInfo& info = *effect_named(effect.id);
      const bool reads = std::find(info.needs.begin(), info.needs.end(), rate) != info.needs.end();
      double& time = effect.parameters[0];
      if (!reads || time == info.parameters[0].neutral) continue;
      const std::string_view unit = info_of(info.location).unit;
      note(
          "{} of {:g} s is not applied: it would add {:.2g} {} of noise and remove {:.2g} {} of error on "
          "this flight",
          effect.id, time, std::abs(time) * std::sqrt(band.rate_noise), unit,
          std::abs(time) * std::sqrt(std::max(0.0, signal)), unit);
      time = info.parameters[0].neutral;
    }
    choose_chain();
  }

  /// Notes that the archive corrected the pressures, or that the model changes no pressure.
  void note_archive() {
    const std::string& static_pressure = file_.variables.at(Quantity::static_pressure);
    const std::string& dynamic_pressure = file_.variables.at(Quantity::dynamic_pressure);
    const std::vector<PressurePair>& processed = naming_of(file_, flight_).processed;
    const bool is_corrected = std::any_of(processed.begin(), processed.end(), [&](const PressurePair& pair) {
      return pair.static_pressure == static_pressure && pair.dynamic_pressure == dynamic_pressure;
    });
    if (changes_no_pressure(file_, options_)) {
      note(
          "the model changes no pressure: all its coefficients are zero; pcor refit finds them if the flight "
          "determines them; the pressures of the output are the {} {} and {}",
          is_corrected ? "archived" : "recorded", static_pressure, dynamic_pressure);
    } else if (is_corrected) {
      note(
          "{} and {} were corrected by the archive; only a model that was fitted to them corrects the "
          "remaining error",
          static_pressure, dynamic_pressure);
    }
  }

  FileDescription describe() {
    FileDescription description;
    description.history = options_.history;
    name_coordinates(flight_, file_, description);
    description.attributes = origin_attributes(flight_.path(), sha256_.get(), given_, options_);
    description.attributes.emplace_back("pcor_time_stamp",
                                        flight_.timestamp_alignment() == TimestampAlignment::begin
                                            ? "begin of the record"
                                            : "middle of the record");
    Names notes;
    for (const Note& note : summary_.notes) notes.push_back(format_note(note));
    if (!notes.empty())
      description.attributes.emplace_back("pcor_notes", fmt::format("{}", fmt::join(notes, "; ")));
    return description;
  }

  void copy_variables(FlightWriter& writer, const FileDescription& description) {
    Names names{description.latitude, description.longitude, description.altitude};
    for (const LoopInput& input : inputs_) names.push_back(input.variable);
    if (options_.hydrostatic) {
      for (const std::string& name : motion_variables(flight_, file_)) names.push_back(name);
    }
    if (options_.copy_all) names = flight_.variables();
    for (const std::string& name : names) {
      if (name.empty() || writer.has(name)) continue;
      if (!options_.copy_all || writer.can_copy(name)) {
        writer.copy(name);
      } else if (name != flight_.time_variable()) {
        note("{} has a type that cannot be copied and is omitted", name);
      }
    }
  }

  /// Inputs of a result by their names in the file: other results, and recorded variables.
  Names dependencies_of(const OutputRow& row) const {
    Names names;
    for (const Quantity quantity : row.from({*chain_, options_.correct_with})) {
      const auto name = names_.find(quantity);
      if (name != names_.end() && std::find(names.begin(), names.end(), name->second) == names.end())
        names.push_back(name->second);
    }
    return names;
  }

  void define_outputs(FlightWriter& writer) {
    for (const OutputRow& row : output_table()) {
      if (!is_written(row)) continue;
      const bool is_uncertainty = row.uncertainty_of != Quantity::count;
      const bool is_temperature = !is_uncertainty && info_of(row.quantity).unit == "K";
      OutputVariable variable;
      variable.name = to_string(row.name);
      variable.rate = summary_.rate;
      variable.units = is_temperature ? "degC" : std::string(info_of(row.quantity).unit);
      variable.long_name = row.long_name;
      variable.standard_name = row.standard_name;
      variable.category = row.category;
      variable.dependencies = dependencies_of(row);
      for (const OutputRow& other : output_table()) {
        if (other.uncertainty_of == row.quantity && is_written(other))
          variable.ancillary_variables.push_back(to_string(other.name));
      }
      variable.ancillary_variables.push_back(to_string(std::string(quality_output)));
      if (is_uncertainty) {
        variable.dependencies = {names_.at(row.uncertainty_of)};
        variable.attributes = {{"coverage_factor", "1"},
                               {"coverage_content_type", "qualityInformation"},
                               {"comment", uncertainty_->comment()}};
      }
      if (row.quantity == Quantity::height_step) {
        variable.attributes = {{"temperature_calibration", temperature_calibration()},
                               {"model", archived_model(file_, options_.correct_with)}};
      }
      Output output{row.quantity, is_temperature ? -constants::ice_point : 0.0, define(writer, variable)};
      names_[row.quantity] = variable.name;
      if (row.is_filtered) {
        filtered_->add(std::move(output));
      } else {
        results_->add(std::move(output));
      }
    }
  }

  /// An uncertainty is written only with its result; for a pressure the error of delta-p must be stated, too.
  bool is_written(const OutputRow& row) const {
    if (!loop_->writes(row.quantity)) return false;
    if (row.uncertainty_of == Quantity::count) return true;
    const bool is_pressure = info_of(row.uncertainty_of).unit == "hPa";
    return loop_->writes(row.uncertainty_of) && (!is_pressure || uncertainty_->states_defect_error());
  }

  void define_flags(FlightWriter& writer) {
    OutputVariable flags;
    flags.name = to_string(std::string(quality_output));
    flags.rate = summary_.rate;
    flags.long_name = "Quality bits of the pressure correction";
    flags.standard_name = "status_flag";
    flags.category = "Housekeeping";
    for (const QualityInfo& info : quality_info) {
      flags.flags.push_back({static_cast<int>(info.bit), std::string(info.name)});
    }
    flags.dependencies = summary_.outputs;
    filtered_->set_flags(define(writer, flags));
  }

  std::size_t define(FlightWriter& writer, const OutputVariable& variable) {
    if (writer.has(variable.name)) {
      flight_.file().refuse(
          Error::Code::usage,
          ": it has a variable {} already; give --suffix to name the derived variables apart "
          "from the input's, e.g. --suffix _NEW",
          variable.name);
    }
    summary_.outputs.push_back(variable.name);
    return writer.define(variable);
  }

  /// Coefficients a0, a1 and a2 of the calibration included in ATX, zero without calibration.
  std::string temperature_calibration() {
    std::vector<double> coefficients(3, 0.0);
    for (const ModelEffect& effect : file_.model.effects) {
      if (effect.id == effects::TempCalibration::info().id) {
        coefficients = effect.parameters;
      } else if (effect.is_formula() && effect.location == EffectLocation::ambient_temperature) {
        note("the attribute temperature_calibration of HYDSTEP omits the effect {}, because it is a formula",
             effect.id);
      }
    }
    return fmt::format("{}", fmt::join(coefficients, " "));
  }

  /// Takes the results of the last run, which may belong to an earlier sample.
  void take_results() {
    const std::size_t record = statistics_->record_of_next();
    const bool has_flaps = record < flaps_.size() && flaps_[record];
    if (has_flaps) {  // the stated uncertainty does not apply
      for (const UncertainResult& each : uncertain_results)
        loop_->state()[each.uncertainty] = missing<double>();
    }
    if (results_->leave(*loop_)) {
      QualityFlags quality = loop_->quality();
      quality.set(frozen_.has(record), Quality::sensor_frozen);
      quality.set(has_flaps, Quality::outside_domain);
      filtered_->enter_flags(statistics_->add(loop_->state(), quality));
    }
    if (!filtered_->leave(*loop_) || !loop_->quality().has(Quality::filter_window_incomplete)) return;
    filtered_->add_flag(static_cast<double>(Quality::filter_window_incomplete));
    statistics_->count(Quality::filter_window_incomplete);
  }

  /// Before a gap and at the end: runs the loop with missing values until its last sample has left it.
  void flush() {
    const double last = loop_->last_time();
    for (std::size_t i = 1; filtered_->inside() > 0; ++i) {
      for (const LoopInput& input : inputs_) loop_->state()[input.quantity] = missing<double>();
      loop_->run(last + static_cast<double>(i) * sample_step_);
      take_results();
    }
    loop_->reset();
    results_->reset();
    filtered_->reset();
  }

  void process_block(RecordBlock block) {
    const std::size_t samples = block.count * static_cast<std::size_t>(summary_.rate);
    for (LoopInput& input : inputs_) {
      input.values.resize(samples);
      input.excluded +=
          flight_.read_at_rate(summary_.rate, input.variable, block, input.conversion, input.values.data());
    }
    std::vector<double> times(samples);
    flight_.read_sample_times(block, summary_.rate, times.data());
    for (std::size_t i = 0; i < samples; ++i) {
      const double time = times[i] - summary_.start_time;
      if (loop_->is_discontinuity(time)) flush();
      State<double>& state = loop_->state();
      const std::size_t record = block.first + i / static_cast<std::size_t>(summary_.rate);
      for (const LoopInput& input : inputs_) {
        const bool is_left_out = !options_.keep_frozen && !input.frozen.empty() && input.frozen[record];
        state[input.quantity] = is_left_out ? missing<double>() : input.values[i];
      }
      results_->enter();
      filtered_->enter();
      loop_->run(time);
      take_results();
    }
  }

  Flight flight_;
  const ModelDefinition& given_;
  ModelDefinition file_;  // model adapted to this flight
  const ProcessOptions& options_;
  std::future<std::string> sha256_;  // input file; another thread computes it
  std::vector<Quantity> roles_;
  std::shared_ptr<const Chain> chain_;
  std::optional<Loop> loop_;
  std::optional<OutputUncertainty> uncertainty_;
  std::optional<SampleStatistics> statistics_;
  std::vector<LoopInput> inputs_;
  std::optional<DelayLine> results_;
  std::optional<DelayLine> filtered_;  // later still; and the quality bits, one of which is the filter's
  double sample_step_ = 1.0;           // s
  FrozenInputs frozen_;
  std::vector<bool> flaps_;                // records outside the law by extended flaps; empty: none
  bool did_not_fly_ = false;               // the dynamic pressure stays below that of flight
  std::map<Quantity, std::string> names_;  // names of inputs and results in the output
  ProcessSummary summary_;
};

}  // namespace
}  // namespace pcor::internal

namespace pcor {

std::string format_defect(const ProcessSummary& summary) {
  if (summary.min_defect == 0.0 && summary.max_defect == 0.0) return "delta-p zero";
  return fmt::format("delta-p {:.2f} hPa on average ({:.2f} to {:.2f}), {}", summary.mean_defect,
                     summary.min_defect, summary.max_defect,
                     is_missing(summary.defect_uncertainty)
                         ? "uncertainty not stated"
                         : fmt::format("standard uncertainty {:.2f} hPa", summary.defect_uncertainty));
}

ProcessSummary process_flight(const std::filesystem::path& input, const ModelDefinition& model,
                              const std::filesystem::path& output, const ProcessOptions& options) {
  return internal::Processing(input, model, options).run(output);
}

}  // namespace pcor
