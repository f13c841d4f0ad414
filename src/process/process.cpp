#include <pcor/process/process.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
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
#include "base/phrasing.hpp"
#include "flight/flight_file.hpp"
#include "model_io/archived_model.hpp"
#include "model_io/output_table.hpp"
#include "model_io/sensor_doubt.hpp"
#include "numerics/missing.hpp"
#include "process/copied_variables.hpp"
#include "process/delay_line.hpp"
#include "process/origin.hpp"
#include "residuals/masks.hpp"
#include "residuals/samples.hpp"
#include "residuals/time_spans.hpp"
#include "roles/fast_series.hpp"
#include "roles/find_frozen.hpp"
#include "roles/model_inputs.hpp"
#include "roles/recorded_series.hpp"
#include "roles/resolution.hpp"

namespace pcor::internal {
namespace {

/// Dynamic pressure, hPa, at the flying speed of an aircraft at sea level in the standard atmosphere. The
/// lift depends on the dynamic pressure, at any height.
double flying_dynamic_pressure(const std::string& aircraft) {
  const double speed = RegimeCriteria::of(aircraft).value_or(RegimeCriteria{}).flying_speed;
  return dynamic_pressure_from_airspeed(standard_pressure(0.0), speed, standard_temperature(0.0),
                                        dry_air<double>());
}

/// Bits of samples that have no delta-p.
constexpr auto prevent_delta_p = {Quality::static_pressure_missing,
                                  Quality::dynamic_pressure_missing,
                                  Quality::impossible_static_pressure,
                                  Quality::impossible_dynamic_pressure,
                                  Quality::effect_input_missing,
                                  Quality::defect_exceeds_dynamic_pressure,
                                  Quality::no_airflow};

/// A variable of the file that the loop reads.
struct Input : ModelInput {
  std::vector<double> values{};  // values of one block
  RejectedCounts excluded{};     // total of all inputs
  std::vector<bool> frozen{};    // records in which the sensor is frozen; empty: none
};

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
    summary_.first_time = flight_.time().first;
    summary_.last_time = flight_.time().last;
    summary_.min_defect = infinity;
    summary_.max_defect = -infinity;

    choose_roles();
    for (Note& each : flight_.file().notes()) summary_.notes.push_back(std::move(each));
    for (Note& each : notes_on_law(flight_, file_)) summary_.notes.push_back(std::move(each));
    note_archive();
    for (ModelInput& input : model_inputs(flight_, file_, *chain_, roles_, summary_.notes))
      inputs_.push_back({std::move(input)});
    for (const Input& input : inputs_) names_.emplace(input.quantity, input.variable);
    find_frozen_sensors();
    find_flaps();
    choose_rate();
    note_uncertainty();
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
      if (options_.progress) options_.progress(block.first + block.count, flight_.records());
    }
    summary_.samples = summary_.records * static_cast<std::size_t>(summary_.rate);
    note_uncorrected();
    writer.finish();
    if (summary_.in_flight > 0) {
      summary_.mean_defect /= static_cast<double>(summary_.in_flight);
      note_defect_uncertainty();
    } else {
      summary_.mean_defect = summary_.min_defect = summary_.max_defect = missing<double>();
    }
    for (const Input& input : inputs_) note_excluded(input, input.excluded, summary_.notes);
    note_impossible_temperature();
    note_domain();
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

  void choose_chain() { chain_ = std::make_shared<const Chain>(chain_of(file_.model, roles_)); }

  /// Detects sensors that are constant in flight for much longer than their noise permits.
  void find_frozen_sensors() {
    const auto read = [this](const Input& input) {
      return read_values(flight_, input.variable, input.conversion).values;
    };
    std::vector<bool> flying;
    for (const Input& input : inputs_) {
      if (input.quantity != Quantity::dynamic_pressure) continue;
      const std::vector<double> values = read(input);
      flying = in_flight(values, summary_.flying_dynamic_pressure);
      note_no_flight(input.variable, values);
    }
    std::vector<double> time;
    for (Input& input : inputs_) {
      const std::vector<double> values = read(input);
      note_coarse(input.quantity, input.variable, values, summary_.notes);
      const std::vector<Segment> frozen =
          find_frozen(flight_, input.variable, input.quantity, values, flying);
      if (frozen.empty()) continue;
      if (time.empty()) time = record_times(flight_);
      frozen_texts_.push_back(frozen_text(input.variable, input.quantity, values, time, frozen));
      summary_.notes.push_back(warning_note(frozen_texts_.back()));
      input.frozen.resize(values.size());
      frozen_.resize(values.size());
      for (const Segment& span : frozen) {
        for (std::size_t i = span.first; i < span.first + span.count; ++i)
          input.frozen[i] = frozen_[i] = true;
      }
    }
    if (!frozen_.empty()) {
      note(options_.keep_frozen
               ? "readings of frozen sensors are corrected, too; PCORFLAG marks them"
               : "readings of frozen sensors are treated as missing; --keep-frozen uses them");
    }
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

  /// Marks records with extended flaps unless an effect describes them: laws are usually fitted with flaps
  /// retracted.
  void find_flaps() {
    if (changes_no_pressure(file_, options_)) return;
    std::optional<std::vector<bool>> extended;
    std::string variable;
    try {
      variable = read_role(flight_, file_, Quantity::flaps).variable;
      const std::vector<ModelEffect>& effects = file_.model.effects;
      if (std::any_of(effects.begin(), effects.end(), [&](const ModelEffect& effect) {
            return !is_neutral(effect) && reads_flaps(effect, variable);
          }))
        return;
      extended = flaps_extended(flight_, file_);
    } catch (const Error& error) {  // a variable that no result needs is damaged
      summary_.notes.push_back(
          warning_note(fmt::format("records with extended flaps have no quality bit: {}", error.what())));
      return;
    }
    if (!extended) {
      note(
          "records with extended flaps have no quality bit: flaps are not recorded and the lift does not "
          "determine them");
    } else if (std::find(extended->begin(), extended->end(), true) != extended->end()) {
      flaps_ = std::move(*extended);
      const std::string times = add_outside("flaps extended", flaps_);
      summary_.notes.push_back(warning_note(fmt::format(
          "do not use {}{} of {} records (bit outside_domain): flaps extended, not in the model; {}{}; these "
          "records have no uncertainty",
          options_.correct_with == CorrectWith::lams ? to_string("PCOR") + " or results by the model in "
                                                     : "",
          std::count(flaps_.begin(), flaps_.end(), true), flaps_.size(), times,
          variable.empty() ? ", inferred from the lift" : "")));
    }
  }

  /// Adds the spans of the marked records to the summary, and returns their times as text.
  std::string add_outside(const std::string& reason, const std::vector<bool>& records,
                          std::size_t max_gap = 0) {
    const std::vector<double> time = record_times(flight_);
    const std::vector<Segment> segments = marked_segments(records, max_gap);
    for (const Segment& segment : segments) {
      const double last = time[segment.first + segment.count - 1];
      summary_.outside.push_back({reason, time[segment.first], last + flight_.time().step});
    }
    return times_of(segments, time);
  }

  /// Warns of fewer than 1 % corrected samples, with the most frequent reason. @throws Error if a
  /// flight that flew has no corrected sample; the output is then not written
  void note_uncorrected() {
    constexpr std::size_t few = 100;
    if (few * summary_.corrected >= summary_.samples) return;
    std::string text =
        fmt::format("{} of {} samples could be corrected", summary_.corrected, summary_.samples);
    std::size_t most = 0;
    for (std::size_t i = 0; i < quality_info.size(); ++i) {
      const bool prevents = std::find(prevent_delta_p.begin(), prevent_delta_p.end(), quality_info[i].bit) !=
                            prevent_delta_p.end();
      if (prevents && summary_.flagged[i] > summary_.flagged[most]) most = i;
    }
    // The reason of a missing flow angle is more specific.
    for (std::size_t i = 0; i < quality_info.size(); ++i) {
      if (quality_info[i].bit == Quality::impossible_radome_pressure &&
          quality_info[most].bit == Quality::effect_input_missing &&
          10 * summary_.flagged[i] > 9 * summary_.flagged[most])
        most = i;
    }
    if (const std::size_t count = summary_.flagged[most]; count > 0) {
      text += fmt::format("; most frequent reason: {}, {} ({} sample{})", quality_info[most].name,
                          quality_info[most].brief, count, count == 1 ? "" : "s");
    }
    if (summary_.corrected > 0 || did_not_fly_) {
      summary_.notes.push_back(warning_note(text));
    } else {
      flight_.file().refuse(
          Error::Code::samples, ": {}; {}", text,
          frozen_texts_.empty()
              ? "compare the [variables] and [units] of the model with the roles that 'pcor inspect' finds"
              : fmt::format("{}; --keep-frozen uses these readings", fmt::join(frozen_texts_, "; ")));
    }
  }

  /// Warns of a thermometer whose values give no possible temperature in most samples, as in a wrong unit.
  void note_impossible_temperature() {
    if (2 * impossible_temperatures_ <= summary_.corrected) return;
    const Quantity role = chain_->recorded(Quantity::recovery_temperature) ? Quantity::recovery_temperature
                                                                           : Quantity::ambient_temperature;
    summary_.notes.push_back(warning_note(
        fmt::format("set the unit of {} in [units] of the model, or name another variable: {} of {} "
                    "corrected samples have "
                    "no possible temperature; {} is {:.0f} K in these samples on average",
                    info_of(role).name, impossible_temperatures_, summary_.corrected, file_.variable_of(role),
                    sum_of_impossible_ / static_cast<double>(impossible_temperatures_))));
  }

  /// Notes the samples in flight outside the domain of the law, known after the run.
  void note_domain() {
    for (std::size_t i = 0; i < std::min(flaps_.size(), outside_.size()); ++i)
      outside_[i] = outside_[i] && !flaps_[i];
    const auto count = std::count(outside_.begin(), outside_.end(), true);
    if (count == 0) return;
    // Values that cross a limit many times in a minute give one span.
    const auto records_per_minute = static_cast<std::size_t>(60.0 / flight_.time().step);
    note(
        "delta-p is extrapolated in {}{} of {} records (bit outside_domain), in flight outside the domain of "
        "the law; these records have no uncertainty: {}",
        flaps_.empty() ? "" : "another ", count, outside_.size(),
        add_outside("outside the domain", outside_, records_per_minute));
  }

  void choose_rate() {
    for (const Quantity pressure : {Quantity::static_pressure, Quantity::dynamic_pressure}) {
      summary_.rate = std::max(summary_.rate, flight_.variable(file_.variable_of(pressure)).rate);
    }
    std::string why;
    const double rate = summary_.rate / flight_.time().step;
    uncertainty_ = uncertainty();
    const ShortestPeriods periods = choose_periods();
    loop_ = Loop::build(chain_, rate, &why, options_.correct_with, uncertainty_, periods);
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
                                      [of = quantity](const Input& each) { return each.quantity == of; });
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

  /// Stated uncertainty of the model, according to the options; missing parts are noted. @throws Error if a
  /// requested part is not stated.
  ModelUncertainty uncertainty() {
    const UncertaintyPart part = options_.uncertainty;
    if (part == UncertaintyPart::none) return {};
    ModelUncertainty stated = uncertainty_of(file_);
    if (part == UncertaintyPart::systematic) {
      stated = stated_uncertainty(file_).has_systematic() ? stated.systematic_part() : ModelUncertainty{};
    }
    if (part == UncertaintyPart::random) stated = stated.random_part();
    if (stated.has_systematic() || stated.has_random()) return stated;
    if (part == UncertaintyPart::total_if_stated) return {};
    const char* const what = part == UncertaintyPart::systematic
                                 ? "no standard error or covariance of a parameter"
                             : part == UncertaintyPart::random ? "no uncertainty of a sample in [uncertainty]"
                                                               : "no noise, misfit, stderr or covariance";
    fail_model(
        fmt::format("it states {} (the calibration of a sensor alone does not suffice); run 'pcor refit' for "
                    "the covariance, set the noise of the sensors in [uncertainty], or omit --uncertainty",
                    what));
  }

  /// True if an uncertainty is stated of a coefficient at one of the locations, or of one of the roles.
  bool states(std::initializer_list<EffectLocation> locations, std::initializer_list<Quantity> roles) const {
    std::size_t count = chain_->parameters().size();
    for (const ModelEffect& each : uncertainty_.calibration) count += each.parameters.size();
    for (std::size_t effect = 0; !uncertainty_.covariance.empty() && effect < chain_->effect_count();
         ++effect) {
      if (std::find(locations.begin(), locations.end(), chain_->location_of(effect)) == locations.end())
        continue;
      const std::size_t first = chain_->first_parameter_of(effect);
      for (std::size_t i = first; i < first + chain_->parameter_count_of(effect); ++i) {
        if (uncertainty_.covariance[i * count + i] > 0.0) return true;
      }
    }
    return std::any_of(roles.begin(), roles.end(),
                       [this](Quantity role) { return uncertainty_.random[index(role)] > 0.0; });
  }

  /// Warns if delta-p is less certain than the errors that a correction removes.
  void note_defect_uncertainty() {
    if (uncertain_samples_ == 0) return;
    constexpr double max_uncertainty = 1.0;  // hPa, as in a fit by GPS
    summary_.defect_uncertainty = sum_of_uncertainties_ / static_cast<double>(uncertain_samples_);
    if (summary_.defect_uncertainty < max_uncertainty) return;
    summary_.notes.push_back(
        warning_note(fmt::format("delta-p is not determined: its standard uncertainty is {:.2f} hPa on "
                                 "average; refit the model with a "
                                 "laser, a second static system, or GPS wind in circles or reverse headings",
                                 summary_.defect_uncertainty)));
  }

  void note_uncertainty() {
    if (!uncertainty_.has_systematic() && !uncertainty_.has_random()) return;
    if (options_.correct_with == CorrectWith::lams) {
      note("LAMS-corrected samples have an uncertainty of PCOR only: the model covariance does not apply");
    }
    using Q = Quantity;
    if (!states_defect_error())
      note(
          "refit the model or set static_defect in [uncertainty]: pressures have no uncertainty, the others "
          "exclude the error of delta-p");
    Names unstated;
    const auto require = [&](std::initializer_list<EffectLocation> locations, Quantity role) {
      if (!states(locations, {role})) unstated.emplace_back(info_of(role).name);
    };
    require({EffectLocation::static_transducer, EffectLocation::static_line}, Q::static_pressure);
    require({EffectLocation::dynamic_transducer, EffectLocation::static_line, EffectLocation::total_line,
             EffectLocation::pitot},
            Q::dynamic_pressure);
    // The systematic error of a thermometer has a usual size.
    if (chain_->has_temperature() && options_.uncertainty != UncertaintyPart::systematic)
      require({}, file_.variables.count(Q::recovery_temperature) > 0 ? Q::recovery_temperature
                                                                     : Q::ambient_temperature);
    if (!unstated.empty())
      note("set {} in [uncertainty]: the uncertainties exclude errors of these sensors", join_list(unstated));
    for (const SensorDoubt& doubt : doubts_of(file_, thermometer_calibration)) {
      if (uncertainty_.calibration.empty()) break;
      const std::vector<std::string>& known = file_.covariance.parameters;
      if (!doubt.is_usual || std::find(known.begin(), known.end(), doubt.name()) != known.end()) continue;
      note("set \"{}\" in [uncertainty] of the model: the uncertainties assume 0 +- {:g}, the usual size",
           doubt.name(), doubt.size);
    }
  }

  /// Notes that the archive corrected the pressures, or that the model changes no pressure.
  void note_archive() {
    const std::string& static_pressure = file_.variables.at(Quantity::static_pressure);
    const std::string& dynamic_pressure = file_.variables.at(Quantity::dynamic_pressure);
    const std::vector<PressurePair>& processed = family_of(file_, flight_).processed;
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

  FileDescription describe() const {
    FileDescription description;
    description.history = options_.history;
    name_coordinates(flight_, file_, description);
    description.attributes = origin_attributes(flight_.path(), given_, options_);
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
    for (const Input& input : inputs_) names.push_back(input.variable);
    if (options_.hydrostatic) {
      for (const std::string& name : flown_variables(flight_, file_)) names.push_back(name);
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
                               {"comment", uncertainty_comment()}};
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
    return loop_->writes(row.uncertainty_of) && (!is_pressure || states_defect_error());
  }

  /// Whether an error of delta-p is stated, or uncertainties without it were requested.
  bool states_defect_error() const {
    return options_.uncertainty == UncertaintyPart::random || uncertainty_.static_defect > 0.0 ||
           uncertainty_.static_defect_ratio > 0.0 || states({EffectLocation::static_defect}, {});
  }

  std::string uncertainty_comment() const {
    const bool systematic = uncertainty_.has_systematic();
    const bool random = uncertainty_.has_random();
    return fmt::format("one standard deviation: {}",
                       systematic && random ? "the systematic part, which is the same error in neighbouring "
                                              "samples, and the random part, which is not"
                       : systematic ? "the systematic part alone, the same error in neighbouring samples"
                                    : "the random part alone, of a single sample");
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

  void note_sample() {
    const State<double>& state = loop_->state();
    const double defect = state[Quantity::corrected_static_pressure] - state[Quantity::port_static_pressure];
    if (!is_missing(defect) && !is_missing(state[Quantity::corrected_dynamic_pressure])) {
      ++summary_.corrected;
      if (state[Quantity::dynamic_pressure] >= summary_.flying_dynamic_pressure) {
        ++summary_.in_flight;
        summary_.mean_defect += defect;  // the sum, until the end
        summary_.min_defect = std::min(summary_.min_defect, defect);
        summary_.max_defect = std::max(summary_.max_defect, defect);
        const double uncertainty = state[Quantity::static_defect_uncertainty];
        if (options_.correct_with == CorrectWith::model && states_defect_error() &&
            !is_missing(uncertainty)) {
          ++uncertain_samples_;
          sum_of_uncertainties_ += uncertainty;
        }
      }
    }
    QualityFlags quality = loop_->quality();
    const double thermometer =
        state[chain_->recorded(Quantity::recovery_temperature) ? Quantity::recovery_temperature
                                                               : Quantity::ambient_temperature];
    if (!is_missing(defect) && !is_missing(thermometer) && quality.has(Quality::temperature_missing)) {
      ++impossible_temperatures_;
      sum_of_impossible_ += thermometer;
    }
    const std::size_t record = noted_++ / static_cast<std::size_t>(summary_.rate);
    if (chain_->is_outside_domain(state) &&
        state[Quantity::dynamic_pressure] >= summary_.flying_dynamic_pressure) {
      outside_.resize(flight_.records());
      outside_[record] = true;
    }
    quality.set(!frozen_.empty() && frozen_[record], Quality::sensor_frozen);
    quality.set(!flaps_.empty() && flaps_[record], Quality::outside_domain);
    double bits = 0.0;
    if (quality.bits() != 0) {
      for (std::size_t i = 0; i < quality_info.size(); ++i) {
        const Quality bit = quality_info[i].bit;
        // Bit of an earlier sample.
        if (!quality.has(bit) || bit == Quality::filter_window_incomplete) continue;
        ++summary_.flagged[i];
        bits += static_cast<double>(bit);
      }
    }
    filtered_->enter_flags(bits);
  }

  /// Takes the results of the last run, which may belong to an earlier sample.
  void take_results() {
    const std::size_t record = noted_ / static_cast<std::size_t>(summary_.rate);
    if (record < flaps_.size() && flaps_[record]) {  // the stated uncertainty does not apply
      for (const UncertainResult& each : uncertain_results)
        loop_->state()[each.uncertainty] = missing<double>();
    }
    if (results_->leave(*loop_)) note_sample();
    if (!filtered_->leave(*loop_) || !loop_->quality().has(Quality::filter_window_incomplete)) return;
    filtered_->add_flag(static_cast<double>(Quality::filter_window_incomplete));
    for (std::size_t i = 0; i < quality_info.size(); ++i)
      summary_.flagged[i] += quality_info[i].bit == Quality::filter_window_incomplete ? 1 : 0;
  }

  /// Before a gap and at the end: runs the loop with missing values until its last sample has left it.
  void flush() {
    const double last = loop_->last_time();
    for (std::size_t i = 1; filtered_->inside() > 0; ++i) {
      for (const Input& input : inputs_) loop_->state()[input.quantity] = missing<double>();
      loop_->run(last + static_cast<double>(i) * sample_step_);
      take_results();
    }
    loop_->reset();
    results_->reset();
    filtered_->reset();
  }

  void process_block(RecordBlock block) {
    const std::size_t samples = block.count * static_cast<std::size_t>(summary_.rate);
    for (Input& input : inputs_) {
      input.values.resize(samples);
      input.excluded +=
          flight_.read_at_rate(summary_.rate, input.variable, block, input.conversion, input.values.data());
    }
    std::vector<double> times(samples);
    flight_.read_sample_times(block, summary_.rate, times.data());
    for (std::size_t i = 0; i < samples; ++i) {
      const double time = times[i] - summary_.first_time;
      if (loop_->starts_anew(time)) flush();
      State<double>& state = loop_->state();
      const std::size_t record = block.first + i / static_cast<std::size_t>(summary_.rate);
      for (const Input& input : inputs_) {
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
  std::vector<Quantity> roles_;
  std::shared_ptr<const Chain> chain_;
  std::optional<Loop> loop_;
  ModelUncertainty uncertainty_;  // uncertainty of the model and its inputs
  std::vector<Input> inputs_;
  std::optional<DelayLine> results_;
  std::optional<DelayLine> filtered_;      // later still; and the quality bits, one of which is the filter's
  double sample_step_ = 1.0;               // s
  std::vector<std::string> frozen_texts_;  // one for each frozen sensor
  std::size_t impossible_temperatures_ = 0;  // corrected samples whose thermometer gives no temperature
  double sum_of_impossible_ = 0.0;           // of the thermometer in these samples, K
  std::vector<bool> frozen_;                 // records in which any sensor is frozen; empty: none
  std::vector<bool> flaps_;                  // records outside the law by extended flaps; empty: none
  std::vector<bool> outside_;                // records in flight outside the domain of the law; empty: none
  std::size_t uncertain_samples_ = 0;        // samples in flight with an uncertainty of delta-p
  double sum_of_uncertainties_ = 0.0;        // sum of the uncertainties of delta-p, hPa
  bool did_not_fly_ = false;                 // the dynamic pressure stays below that of flight
  std::size_t noted_ = 0;                    // samples of which results are available
  std::map<Quantity, std::string> names_;    // names of inputs and results in the output
  ProcessSummary summary_;
};

}  // namespace
}  // namespace pcor::internal

namespace pcor {

std::string format_defect(const ProcessSummary& summary) {
  if (summary.min_defect == 0.0 && summary.max_defect == 0.0)
    return "delta-p zero: the model does not change the pressures";
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
