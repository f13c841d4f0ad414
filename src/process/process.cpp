#include <pcor/process/process.hpp>

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include <pcor/flight/flight_writer.hpp>
#include <pcor/realtime/height_step.hpp>
#include <pcor/realtime/loop.hpp>
#include <pcor/words/error.hpp>
#include <pcor/words/utc.hpp>
#include "laws/archived_model.hpp"
#include "roles/model_inputs.hpp"
#include "roles/usual_variables.hpp"

namespace pcor {

using namespace internal;

namespace {

/// A variable of the file that the loop reads.
struct Input : ModelInput {
  std::vector<double> values;  // of one block
};

/// A derived variable: where it is in the loop's state, and what the file says of it.
struct Output {
  OutputVariable variable;
  Quantity quantity = Quantity::count;
  double offset = 0.0;  // added to go from the library's unit to the file's
  std::size_t number = 0;
  bool delayed = false;        // by the filter of the loop
  std::vector<double> values;  // of one block; of a delayed one, those that are not written yet
};

constexpr double kelvin_to_celsius = -constants::ice_point;

/// The place of a bit among `quality_facts`.
constexpr std::size_t flagged_place(Quality bit) {
  std::size_t place = 0;
  while (quality_facts[place].bit != bit) ++place;
  return place;
}

/// One flight on its way through the loop.
class Processing {
 public:
  Processing(const std::filesystem::path& input, const ModelFile& file, const ProcessOptions& options)
      : flight_(input, options.time_stamp), file_(file), options_(options) {}

  ProcessSummary run(const std::filesystem::path& output);

 private:
  using Names = std::vector<std::string>;

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(flight_.path().string() + ": " + what);
  }
  [[noreturn]] void fail_model(const std::string& what) const {
    throw Error(fmt::format("model '{}': {}", file_.model.name, what));
  }

  template <class... Values>
  void note(fmt::format_string<const Values&...> format, const Values&... values) {
    summary_.notes.push_back(fmt::format(format, values...));
  }

  std::string variable_of(Quantity role) const {
    const auto found = file_.variables.find(role);
    return found == file_.variables.end() ? std::string() : found->second;
  }

  std::string name_of(const std::string& standard) const {
    return file_.output_name(standard) + options_.suffix;
  }

  Names variables_for(const Chain& chain, const std::vector<Quantity>& quantities) const;
  Names variables_of_law() const;
  void choose_roles();
  void choose_inputs();
  void choose_rate();
  void choose_outputs();
  void define(FlightWriter& writer);
  void copy_inputs(FlightWriter& writer, const FileDescription& description);
  std::string first_recorded(const std::vector<std::string>& names) const;
  FileDescription describe() const;
  void process_block(RecordBlock block, std::vector<double>& times);
  void note_sample(std::size_t place);
  void note_filtered();
  void flush();
  void write_finished(FlightWriter& writer);
  std::string temperature_calibration();

  void add_output(const std::string& standard, Quantity quantity, const std::string& units,
                  const std::string& long_name, const std::string& standard_name, const std::string& category,
                  std::vector<std::string> dependencies, double offset = 0.0);

  Flight flight_;
  const ModelFile& file_;
  const ProcessOptions& options_;
  std::vector<Quantity> roles_;
  std::shared_ptr<const Chain> chain_;
  std::optional<Loop> loop_;
  std::vector<Input> inputs_;
  std::vector<Output> outputs_;
  std::size_t flag_number_ = 0;
  Quantity height_step_ = Quantity::count;
  std::vector<double> flags_;  // of the samples that are not written yet
  double sample_step_ = 1.0;   // s
  std::size_t delay_ = 0;      // of the filter, samples
  std::size_t runs_ = 0;       // of the loop since the last gap
  std::size_t finished_ = 0;   // samples that left the filter and are not written yet
  std::size_t written_records_ = 0;
  ProcessSummary summary_;
};

/// The roles that the flight can serve. LAMS may be off: its variable may be absent.
void Processing::choose_roles() {
  for (const auto& [role, variable] : file_.variables) {
    if (role == Quantity::lams_airspeed && !flight_.has(variable)) {
      if (options_.correct_with == CorrectWith::lams) {
        fail(fmt::format(
            "{} (lams_airspeed) is not in this file, so it cannot be corrected with LAMS; leave out "
            "--correct-with lams",
            variable));
      }
      note("{} is not in this file: the flight is processed without LAMS", variable);
      continue;
    }
    roles_.push_back(role);
  }
  BindingError why;
  std::optional<Chain> chain = Chain::build(file_.model, roles_, &why);
  if (!chain) fail_model(why.message());
  chain_ = std::make_shared<const Chain>(std::move(*chain));
}

void Processing::choose_inputs() {
  for (ModelInput& input : model_inputs(flight_, file_, *chain_, roles_, summary_.notes)) {
    inputs_.push_back({std::move(input), {}});
  }
}

void Processing::choose_rate() {
  for (const Quantity pressure : {Quantity::static_pressure, Quantity::dynamic_pressure}) {
    summary_.rate = std::max(summary_.rate, flight_.variable(variable_of(pressure)).rate);
  }
  std::string why;
  const double rate = summary_.rate / flight_.time().step;
  loop_ = Loop::build(chain_, rate, &why, options_.correct_with);
  if (!loop_) fail_model(why);
  if (chain_->has_lams()) delay_ = LowPass::delay(rate);
  sample_step_ = 1.0 / rate;
  if (!options_.hydrostatic) return;
  const std::optional<Quantity> step = loop_->add_variable("HYDSTEP");
  if (!step) {
    fail_model(
        fmt::format("its formulas name {} variables, which leaves no room for HYDSTEP; leave out "
                    "--hydrostatic",
                    extra_capacity));
  }
  height_step_ = *step;
  loop_->add(std::make_unique<HeightStep>(height_step_));
  if (!loop_->order(&why)) fail_model(why);
}

void Processing::add_output(const std::string& standard, Quantity quantity, const std::string& units,
                            const std::string& long_name, const std::string& standard_name,
                            const std::string& category, std::vector<std::string> dependencies,
                            double offset) {
  Output output;
  output.variable.name = name_of(standard);
  output.variable.rate = summary_.rate;
  output.variable.units = units;
  output.variable.long_name = long_name;
  output.variable.standard_name = standard_name;
  output.variable.category = category;
  output.variable.dependencies = std::move(dependencies);
  output.variable.ancillary_variables = {name_of("PCORFLAG")};
  output.quantity = quantity;
  output.offset = offset;
  outputs_.push_back(std::move(output));
}

/// The variables that the loop reads for any of the quantities.
Processing::Names Processing::variables_for(const Chain& chain,
                                            const std::vector<Quantity>& quantities) const {
  Names names;
  for (const Input& input : inputs_) {
    const bool wanted = std::find(quantities.begin(), quantities.end(), input.quantity) != quantities.end();
    if (wanted && (chain.needs(input.quantity) || chain.recorded(input.quantity)))
      names.push_back(input.variable);
  }
  return names;
}

/// The variables that the law reads: those that the chain would need without LAMS.
Processing::Names Processing::variables_of_law() const {
  std::vector<Quantity> without_lams = roles_;
  without_lams.erase(std::remove(without_lams.begin(), without_lams.end(), Quantity::lams_airspeed),
                     without_lams.end());
  const std::optional<Chain> law = Chain::build(file_.model, without_lams, nullptr);
  Names names;
  for (const Input& input : inputs_) {
    if (law && law->needs(input.quantity)) names.push_back(input.variable);
  }
  return names;
}

void Processing::choose_outputs() {
  const auto join = [](std::initializer_list<Names> lists) {
    Names all;
    for (const Names& list : lists) {
      for (const std::string& name : list) {
        if (std::find(all.begin(), all.end(), name) == all.end()) all.push_back(name);
      }
    }
    return all;
  };
  const Names p{variable_of(Quantity::static_pressure)};
  const Names q{variable_of(Quantity::dynamic_pressure)};
  const bool derives_temperature = chain_->derives_temperature();
  const Names thermometer{
      variable_of(derives_temperature ? Quantity::recovery_temperature : Quantity::ambient_temperature)};
  const bool writes_temperature = derives_temperature || chain_->calibrates_recorded_temperature();
  const Names temperature = writes_temperature ? Names{name_of("ATX")} : thermometer;
  const Names humidity =
      file_.model.moist
          ? variables_for(*chain_, {Quantity::vapor_pressure, Quantity::dew_point, Quantity::frost_point})
          : Names{};
  const Names beam =
      variables_for(*chain_, {Quantity::lams_airspeed, Quantity::attack, Quantity::sideslip,
                              Quantity::attack_differential_pressure,
                              Quantity::sideslip_differential_pressure, Quantity::radome_dynamic_pressure});
  Names corrections{name_of("PCOR")};
  if (options_.correct_with == CorrectWith::lams) corrections.push_back(name_of("PCOR_LAMS"));
  const Names pressures{name_of("PSXC"), name_of("QCXC")};
  const Names mach{name_of("MACHX")};

  add_output("PCOR", Quantity::static_defect, "hPa", "Static defect (delta-p) of the model", "",
             "Aircraft State", join({variables_of_law()}));
  if (chain_->has_lams()) {
    add_output("PCOR_LAMS", Quantity::lams_static_defect, "hPa", "Static defect (delta-p) from LAMS", "",
               "Aircraft State", join({p, q, beam, thermometer, humidity}));
  }
  add_output("PSXC", Quantity::corrected_static_pressure, "hPa", "Corrected Static Pressure", "air_pressure",
             "Atmos. State", join({p, corrections}));
  add_output("QCXC", Quantity::corrected_dynamic_pressure, "hPa", "Corrected Dynamic Pressure", "",
             "Aircraft State", join({q, corrections}));
  add_output("MACHX", Quantity::corrected_mach, "1", "Aircraft Mach Number", "", "Aircraft State",
             join({pressures, humidity}));
  if (writes_temperature) {
    add_output("ATX", Quantity::ambient_temperature, "degC", "Ambient Temperature", "air_temperature",
               "Atmos. State", derives_temperature ? join({thermometer, mach, humidity}) : thermometer,
               kelvin_to_celsius);
  }
  if (chain_->has_temperature()) {
    add_output("TASX", Quantity::corrected_airspeed, "m/s", "Aircraft True Airspeed",
               "platform_speed_wrt_air", "Aircraft State", join({mach, temperature, humidity}));
  }
  if (chain_->has_lams()) {
    add_output("ATLAMS", Quantity::lams_temperature, "degC", "Ambient Temperature from LAMS",
               "air_temperature", "Atmos. State", join({beam, mach, humidity}), kelvin_to_celsius);
    add_output("ATLAMSF", Quantity::filtered_lams_temperature, "degC",
               "Ambient Temperature from LAMS, without periods under 3 s", "air_temperature", "Atmos. State",
               {name_of("ATLAMS")}, kelvin_to_celsius);
    outputs_.back().delayed = true;
    add_output("QCLAMS", Quantity::lams_dynamic_pressure, "hPa", "Dynamic Pressure from LAMS", "",
               "Aircraft State", join({beam, {name_of("PSXC")}, temperature, humidity}));
  }
  if (options_.hydrostatic) {
    add_output("HYDSTEP", height_step_, "m/K", "Hydrostatic height step per kelvin, -R_a dp/(g p)", "",
               "Atmos. State", join({{name_of("PSXC")}, humidity}));
    outputs_.back().variable.attributes = {{"temperature_calibration", temperature_calibration()},
                                           {"model", archived_model(file_, options_.correct_with)}};
  }
}

/// The coefficients a0, a1 and a2 of the calibration that ATX has in it, zero where there is none.
std::string Processing::temperature_calibration() {
  std::vector<double> coefficients(3, 0.0);
  for (const ModelEffect& effect : file_.model.effects) {
    if (effect.id == effects::TempCalibration::facts().id) {
      coefficients = effect.parameters;
    } else if (effect.is_formula() && effect.where == Where::ambient_temperature) {
      note("the attribute temperature_calibration of HYDSTEP is without the effect {}, a formula", effect.id);
    }
  }
  return fmt::format("{}", fmt::join(coefficients, " "));
}

/// The first of the variables that the flight has as a series; empty where it has none.
std::string Processing::first_recorded(const std::vector<std::string>& names) const {
  const auto found = std::find_if(names.begin(), names.end(), [this](const std::string& name) {
    return !name.empty() && flight_.has(name) && flight_.variable(name).is_series;
  });
  return found == names.end() ? std::string() : *found;
}

FileDescription Processing::describe() const {
  FileDescription description;
  description.history = options_.history;
  const auto coordinate = [this](const char* attribute, const std::string& given,
                                 std::vector<std::string> usual) {
    usual.insert(usual.begin(), {flight_.attribute(attribute), given});
    return first_recorded(usual);
  };
  description.latitude =
      coordinate("latitude_coordinate", variable_of(Quantity::latitude), usual_variables(Quantity::latitude));
  description.longitude = coordinate("longitude_coordinate", "", usual_series("longitude").names);
  description.altitude = coordinate("zaxis_coordinate", variable_of(Quantity::altitude), usual_heights());
  description.attributes = {
      {"pcor_model", file_.model.name},
      {"pcor_model_source", file_.law.source},
      {"pcor_model_aircraft", file_.model.aircraft},
      {"pcor_time_stamp",
       flight_.time_stamp() == TimeStamp::begin ? "begin of the record" : "middle of the record"}};
  return description;
}

void Processing::copy_inputs(FlightWriter& writer, const FileDescription& description) {
  const auto copy = [&writer](const std::string& name) {
    if (!name.empty() && !writer.has(name)) writer.copy(name);
  };
  if (options_.copy_all) {
    for (const std::string& name : flight_.variables()) {
      if (writer.can_copy(name)) {
        copy(name);
      } else if (name != flight_.time_variable()) {
        note("{} is of a kind that cannot be copied, and left out", name);
      }
    }
    return;
  }
  for (const std::string& name : {description.latitude, description.longitude, description.altitude})
    copy(name);
  for (const Input& input : inputs_) copy(input.variable);
  if (!options_.hydrostatic) return;
  for (const Quantity role : flown_quantities) {
    std::vector<std::string> names = role == Quantity::altitude ? usual_heights() : usual_variables(role);
    names.insert(names.begin(), variable_of(role));
    copy(first_recorded(names));
  }
  copy(first_recorded(usual_series("ground_speed_east").names));
  copy(first_recorded(usual_series("ground_speed_north").names));
}

void Processing::define(FlightWriter& writer) {
  OutputVariable flags;
  flags.name = name_of("PCORFLAG");
  flags.rate = summary_.rate;
  flags.long_name = "Quality bits of the pressure correction";
  flags.standard_name = "status_flag";
  flags.category = "Housekeeping";
  for (const QualityFacts& facts : quality_facts) {
    flags.flags.push_back({static_cast<int>(facts.bit), std::string(facts.name)});
  }
  for (const Output& output : outputs_) flags.dependencies.push_back(output.variable.name);

  const auto define_one = [this, &writer](const OutputVariable& variable) {
    if (writer.has(variable.name)) {
      fail(fmt::format(
          "it has a variable {} already; give --suffix to name the derived variables apart from the input's, "
          "e.g. --suffix _NEW",
          variable.name));
    }
    summary_.outputs.push_back(variable.name);
    return writer.define(variable);
  };
  for (Output& output : outputs_) output.number = define_one(output.variable);
  flag_number_ = define_one(flags);
}

void Processing::note_sample(std::size_t place) {
  const State<double>& state = loop_->state();
  const double defect = state[Quantity::corrected_static_pressure] - state[Quantity::port_static_pressure];
  if (!is_missing(defect) && !is_missing(state[Quantity::corrected_dynamic_pressure])) {
    ++summary_.corrected;
    summary_.mean_defect += defect;  // the sum, until the end
    summary_.least_defect = std::min(summary_.least_defect, defect);
    summary_.greatest_defect = std::max(summary_.greatest_defect, defect);
  }
  const QualityFlags quality = loop_->quality();
  double bits = 0.0;
  if (quality.bits() != 0) {
    for (std::size_t i = 0; i < quality_facts.size(); ++i) {
      const Quality bit = quality_facts[i].bit;
      if (!quality.has(bit) || bit == Quality::filter_window_incomplete) continue;  // that of another sample
      ++summary_.flagged[i];
      bits += static_cast<double>(bit);
    }
  }
  flags_.push_back(bits);
  for (Output& output : outputs_) {
    if (!output.delayed) output.values[place] = state[output.quantity] + output.offset;
  }
}

/// Takes what left the filter in the last run of the loop: the value, and the bit, of an earlier sample.
void Processing::note_filtered() {
  if (++runs_ <= delay_) return;
  for (Output& output : outputs_) {
    if (output.delayed) output.values.push_back(loop_->state()[output.quantity] + output.offset);
  }
  if (loop_->quality().has(Quality::filter_window_incomplete)) {
    flags_[finished_] += static_cast<double>(Quality::filter_window_incomplete);
    ++summary_.flagged[flagged_place(Quality::filter_window_incomplete)];
  }
  ++finished_;
}

/// Before a gap and at the end: the loop goes on without values until its last sample has left the filter.
void Processing::flush() {
  for (const Input& input : inputs_) loop_->state()[input.quantity] = missing<double>();
  const double last = loop_->state()[Quantity::time];
  for (std::size_t i = 1; i <= delay_; ++i) {
    loop_->run(last + static_cast<double>(i) * sample_step_);
    note_filtered();
  }
  loop_->reset();
  runs_ = 0;
}

/// Writes the whole records of what has left the filter.
void Processing::write_finished(FlightWriter& writer) {
  const auto rate = static_cast<std::size_t>(summary_.rate);
  const RecordBlock block{written_records_, finished_ / rate};
  const auto samples = static_cast<std::ptrdiff_t>(block.count * rate);
  const auto write = [&](std::size_t number, std::vector<double>& values) {
    writer.write(number, block, values.data());
    values.erase(values.begin(), values.begin() + samples);
  };
  for (Output& output : outputs_) {
    if (output.delayed) write(output.number, output.values);
  }
  write(flag_number_, flags_);
  finished_ -= static_cast<std::size_t>(samples);
  written_records_ += block.count;
}

void Processing::process_block(RecordBlock block, std::vector<double>& times) {
  const std::size_t samples = block.count * static_cast<std::size_t>(summary_.rate);
  for (Input& input : inputs_) {
    input.values.resize(samples);
    flight_.read_at_rate(summary_.rate, input.variable, block, input.conversion, input.values.data());
  }
  for (Output& output : outputs_) {
    if (!output.delayed) output.values.resize(samples);
  }
  times.resize(samples);
  flight_.read_sample_times(block, summary_.rate, times.data());
  for (std::size_t i = 0; i < samples; ++i) {
    const double time = times[i] - summary_.first_time;
    if (runs_ > 0 && loop_->starts_anew(time)) flush();
    State<double>& state = loop_->state();
    for (const Input& input : inputs_) state[input.quantity] = input.values[i];
    loop_->run(time);
    note_sample(i);
    note_filtered();
  }
}

ProcessSummary Processing::run(const std::filesystem::path& output) {
  summary_.aircraft = flight_.aircraft();
  summary_.project = flight_.project();
  summary_.flight = flight_.flight_number();
  summary_.records = flight_.records();
  summary_.gaps = flight_.time().gap_count;
  summary_.first_time = flight_.time().first;
  summary_.last_time = flight_.time().last;
  summary_.least_defect = std::numeric_limits<double>::infinity();
  summary_.greatest_defect = -std::numeric_limits<double>::infinity();

  choose_roles();
  for (std::string& each : notes_on_law(flight_, file_)) summary_.notes.push_back(std::move(each));
  choose_inputs();
  choose_rate();
  choose_outputs();
  const FileDescription description = describe();
  FlightWriter writer(output, flight_, description);
  copy_inputs(writer, description);
  define(writer);

  std::vector<double> times;
  for (const RecordBlock block : blocks_of(flight_.records())) {
    process_block(block, times);
    for (const Output& derived : outputs_) {
      if (!derived.delayed) writer.write(derived.number, block, derived.values.data());
    }
    if (block.first + block.count == flight_.records()) flush();
    write_finished(writer);
    if (options_.progress) options_.progress(block.first + block.count, flight_.records());
  }
  writer.finish();

  summary_.samples = summary_.records * static_cast<std::size_t>(summary_.rate);
  if (summary_.corrected > 0) {
    summary_.mean_defect /= static_cast<double>(summary_.corrected);
  } else {
    summary_.mean_defect = summary_.least_defect = summary_.greatest_defect = missing<double>();
    summary_.notes.push_back("no sample could be corrected: see the quality bits");
  }
  return summary_;
}

}  // namespace

ProcessSummary process_flight(const std::filesystem::path& input, const ModelFile& model,
                              const std::filesystem::path& output, const ProcessOptions& options) {
  return Processing(input, model, options).run(output);
}

}  // namespace pcor
