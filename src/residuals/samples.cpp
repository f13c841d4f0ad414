#include "residuals/samples.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

#include <pcor/base/note.hpp>
#include <pcor/base/utc.hpp>
#include <pcor/physics/air_data.hpp>
#include <pcor/physics/standard_atmosphere.hpp>
#include <pcor/realtime/chain.hpp>
#include <pcor/residuals/reference.hpp>
#include "flight/flight_file.hpp"
#include "numerics/missing.hpp"
#include "residuals/parameter_dependent_columns.hpp"
#include "residuals/time_spans.hpp"
#include "roles/fast_series.hpp"
#include "roles/find_frozen.hpp"
#include "roles/model_inputs.hpp"
#include "roles/recorded_series.hpp"
#include "roles/resolution.hpp"

namespace pcor {

using namespace internal;

namespace {

/// True airspeed from the measured pressures, m/s: within 2 %, for regimes and masks.
std::vector<double> measured_airspeed(const ModelSamples& samples) {
  const std::vector<double>& p = *samples.find(Quantity::static_pressure);
  const std::vector<double>& q = *samples.find(Quantity::dynamic_pressure);
  const std::vector<double>* recovery = samples.find(Quantity::recovery_temperature);
  const std::vector<double>* ambient = samples.find(Quantity::ambient_temperature);
  std::vector<double> airspeed(p.size(), nan);
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!(p[i] > 0.0) || std::isnan(q[i])) continue;
    const double mach = q[i] > 0.0 ? mach_number(p[i], q[i], dry_air<double>()) : 0.0;
    double temperature = nan;
    if (ambient != nullptr) temperature = (*ambient)[i];
    if (std::isnan(temperature) && recovery != nullptr)
      temperature = (*recovery)[i] / (1.0 + 0.2 * mach * mach);
    if (std::isnan(temperature)) temperature = standard_temperature(pressure_altitude(p[i]));
    airspeed[i] = true_airspeed(mach, temperature, dry_air<double>());
  }
  return airspeed;
}

FlightMotion read_motion(const Flight& flight, const ModelDefinition& model, FlightSamples& samples) {
  std::vector<std::string> by_usual_names;
  const auto take = [&](const std::string_view role, RecordedSeries series) {
    if (!series.variable.empty()) by_usual_names.push_back(fmt::format("{} = {}", role, series.variable));
    return std::move(series.values);
  };
  const auto read = [&](Quantity role) {
    RecordedSeries series = read_role(flight, model, role);
    if (model.variables.count(role) != 0) return std::move(series.values);
    return take(info_of(role).name, std::move(series));
  };
  FlightMotion motion;
  motion.time = samples.time;
  motion.airspeed = measured_airspeed(samples.model);
  motion.altitude = read(Quantity::altitude);
  if (motion.altitude.empty())
    motion.altitude = take("altitude", read_usual(flight, naming_of(model, flight), "other_altitude"));
  motion.vertical_speed = read(Quantity::vertical_speed);
  motion.roll = read(Quantity::roll);
  motion.pitch = read(Quantity::pitch);
  motion.heading = read(Quantity::heading);
  motion.attack = read(Quantity::attack);
  motion.sideslip = read(Quantity::sideslip);
  motion.ground_speed = read(Quantity::ground_speed);
  motion.ground_track = read(Quantity::ground_track);
  motion.liquid_water = read(Quantity::liquid_water);
  if (!by_usual_names.empty()) {
    samples.notes.emplace_back(
        Severity::detail,
        fmt::format("regimes use variables with standard names that the model does not name: {}",
                    fmt::join(by_usual_names, ", ")));
  }
  for (const auto& [series, loss] :
       {std::pair(&motion.altitude,
                  "no height is recorded: climbs and descents, levels and bands of altitude are not found"),
        std::pair(&motion.roll, "no roll is recorded: turns, circles and reverse headings are not found"),
        std::pair(&motion.pitch,
                  "no pitch is recorded: pitch manoeuvres are found by the angle of attack alone"),
        std::pair(&motion.heading,
                  "no heading is recorded: circles and reverse headings are found by the ground track "
                  "alone")}) {
    if (series->empty()) samples.notes.emplace_back(loss);
  }
  return motion;
}

/// Reads recorded flaps, otherwise infers them from the lift, with records down to the usual minimum
/// airspeed: the first records of an approach show the flaps of the later ones.
void read_flaps(const Flight& flight, const ModelDefinition& model, double min_airspeed,
                FlightSamples& samples) {
  RecordedSeries recorded = read_role(flight, model, Quantity::flaps);
  samples.flaps = std::move(recorded.values);
  samples.flaps_variable = std::move(recorded.variable);
  if (!samples.flaps.empty()) return;
  // ADIFR/QCR, otherwise the angle of attack, deg; empty if neither is recorded.
  std::vector<double> attack = read_role(flight, model, Quantity::attack_differential_pressure).values;
  const std::vector<double> qcr = read_role(flight, model, Quantity::radome_dynamic_pressure).values;
  if (attack.empty() || qcr.empty())
    attack = samples.motion.attack;
  else
    std::transform(attack.begin(), attack.end(), qcr.begin(), attack.begin(), std::divides<>());
  const double min_inferred = std::min(min_airspeed, MaskOptions().min_airspeed);
  const std::optional<FlapsByLift> lift =
      attack.empty() ? std::nullopt : find_flaps_by_lift(samples, attack, min_inferred);
  if (!lift) {
    samples.notes.emplace_back(
        "exclude approaches with --min-airspeed or --intervals: the flap position is not recorded and could "
        "not be inferred");
    return;
  }
  for (const bool is_out : lift->out) samples.flaps.push_back(is_out ? 100.0 : 0.0);
  const auto out = std::count(lift->out.begin(), lift->out.end(), true);
  if (out == 0) {
    samples.notes.push_back(
        fmt::format("flaps not recorded; inferred as retracted during the whole flight (scatter of the angle "
                    "of attack {:.1f} %)",
                    100.0 * lift->deviation));
    return;
  }
  std::size_t slow = 0;
  for (std::size_t i = 0; i < lift->out.size(); ++i)
    slow += lift->out[i] && samples.motion.airspeed[i] < min_airspeed ? 1 : 0;
  std::string note = fmt::format(
      "{} samples have extended flaps, inferred from the lift, and are used only with --max-flaps 100: {}{}; "
      "flaps are not recorded; the angle of attack is {:.0f} % below its value with flaps "
      "retracted, scatter {:.1f} %",
      out, times_of(marked_runs(lift->out), samples.time),
      slow == 0 ? "" : fmt::format("; {} of them are below {:g} m/s", slow, min_airspeed),
      100.0 * lift->deficit, 100.0 * lift->deviation);
  const bool is_considerable = static_cast<double>(out) / static_cast<double>(lift->out.size()) > 0.1;
  samples.notes.push_back(is_considerable ? warning_note(note) : std::move(note));
}

/// Reads recorded inputs at some rate.
ModelSamples read_inputs(const Flight& flight, const std::vector<ModelInput>& inputs, int rate,
                         Notes& notes) {
  ModelSamples samples;
  for (const ModelInput& input : inputs) {
    ReadValues read = read_values(flight, input.variable, input.conversion, rate);
    note_excluded(input, read.excluded, notes);
    samples.columns.emplace_back(input.quantity, std::move(read.values));
    samples.variables.emplace_back(input.quantity, input.variable);
    if (is_role(input.quantity)) samples.roles.push_back(input.quantity);
  }
  return samples;
}

/// Airspeed along the beam, at the highest rate of a recorded pressure. Other derived inputs, rates of change
/// and the time, are computed over the whole record.
FastSeries read_along_beam(const Flight& flight, const ModelDefinition& model,
                           const std::vector<ModelInput>& inputs, const ModelSamples& records) {
  int rate = 1;
  for (const ModelInput& input : inputs) {
    if (input.quantity == Quantity::static_pressure || input.quantity == Quantity::dynamic_pressure)
      rate = std::max(rate, flight.variable(input.variable).rate);
  }
  if (rate == 1) return {airspeed_along_beam(model, records), 1};
  Notes said_already;
  ModelSamples fast = read_inputs(flight, inputs, rate, said_already);
  const auto in_record = static_cast<std::size_t>(rate);
  for (const auto& [quantity, values] : records.columns) {
    if (fast.find(quantity) != nullptr) continue;
    std::vector<double>& held = fast.columns.emplace_back(quantity, std::vector<double>()).second;
    fast.roles.push_back(quantity);
    for (const double value : values) held.insert(held.end(), in_record, value);
  }
  return {airspeed_along_beam(model, fast), in_record};
}

}  // namespace

const std::vector<double>* ModelSamples::find(Quantity quantity) const {
  const auto found = std::find_if(columns.begin(), columns.end(),
                                  [quantity](const auto& column) { return column.first == quantity; });
  return found == columns.end() ? nullptr : &found->second;
}

std::vector<double>* ModelSamples::find(Quantity quantity) {
  return const_cast<std::vector<double>*>(std::as_const(*this).find(quantity));
}

ModelSamples internal::read_model_columns(const Flight& flight, const ModelDefinition& model, bool with_laser,
                                          const std::vector<double>& time, Notes& notes) {
  const std::vector<Quantity> roles = roles_of(model, with_laser);
  const Chain chain = chain_of(model.model, roles);
  const std::vector<ModelInput> inputs = model_inputs(flight, model, chain, roles, notes);
  ModelSamples samples = read_inputs(flight, inputs, 1, notes);
  for (const auto& [quantity, variable] : samples.variables) {
    if (const auto* const values = samples.find(quantity)) note_coarse(quantity, variable, *values, notes);
  }
  const auto add = [&samples](Quantity quantity, std::vector<double> values) {
    samples.columns.emplace_back(quantity, std::move(values));
    samples.roles.push_back(quantity);
  };
  if (chain.derives(Quantity::time)) {
    std::vector<double> since_first = time;
    for (double& each : since_first) each -= time.front();
    add(Quantity::time, std::move(since_first));
  }
  const double step = flight.time().step;
  int fastest = 1;
  for (const ModelInput& input : inputs) fastest = std::max(fastest, flight.variable(input.variable).rate);
  if (fastest > 1) {
    notes.push_back(fmt::format(
        "means over {:g} s are compared; the flight is recorded with up to {:g} samples per second", step,
        fastest / step));
  }
  const auto rate = [&](FastSeries& series) {
    series.min_period = signal_band_of(series, time, step).min_period;
    return rate_of(series, time, step, series.min_period);
  };
  for (const auto& [quantity, its_rate] : rates) {
    if (!chain.derives(its_rate)) continue;
    const auto input = std::find_if(inputs.begin(), inputs.end(),
                                    [of = quantity](const ModelInput& each) { return each.quantity == of; });
    FastSeries recorded = read_fast(flight, *input, flight.variable(input->variable).rate);
    add(its_rate, rate(recorded));
  }
  if (chain.derives(Quantity::wetness)) {
    add(Quantity::wetness,
        history_input(Quantity::wetness, samples, time, step, chain.time_of(Quantity::wetness)));
  }
  if (chain.derives(Quantity::airspeed_rate)) {
    // Corrected pressures are used: in a pitch manoeuvre delta-p changes faster than the dynamic pressure.
    samples.along_beam = read_along_beam(flight, model, inputs, samples);
    add(Quantity::airspeed_rate, rate(samples.along_beam));
  }
  find_parameter_dependent_columns(model.model, chain.parameters().data(), time, step, samples);
  return samples;
}

void internal::mark_frozen(const Flight& flight, FlightSamples& samples, ModelSamples FlightSamples::*part,
                           double min_airspeed) {
  const std::vector<bool> flying = in_flight(samples.motion.airspeed, min_airspeed);
  ModelSamples& read = samples.*part;
  for (const auto& [quantity, variable] : read.variables) {
    const std::vector<double>& values = *read.find(quantity);
    const std::vector<Segment> frozen = find_frozen(flight, variable, quantity, values, flying);
    for (const Segment& span : frozen) read.frozen.push_back({quantity, span.first, span.count});
    if (!frozen.empty())
      samples.notes.push_back(warning_note(frozen_text(variable, quantity, values, samples.time, frozen)));
  }
}

std::optional<std::vector<bool>> internal::flaps_extended(const Flight& flight,
                                                          const ModelDefinition& model) {
  FlightSamples samples;
  samples.aircraft = flight.aircraft();
  samples.step = flight.time().step;
  samples.time = record_times(flight);
  const auto read = [&](Quantity role) { return read_role(flight, model, role).values; };
  samples.flaps = read(Quantity::flaps);
  if (samples.flaps.empty()) {
    for (const Quantity role : {Quantity::static_pressure, Quantity::dynamic_pressure,
                                Quantity::recovery_temperature, Quantity::ambient_temperature}) {
      std::vector<double> values = read(role);
      const bool is_pressure = role == Quantity::static_pressure || role == Quantity::dynamic_pressure;
      if (values.empty() && is_pressure) values.assign(samples.time.size(), nan);  // no plausible value
      if (!values.empty()) samples.model.columns.emplace_back(role, std::move(values));
    }
    samples.motion.airspeed = measured_airspeed(samples.model);
    samples.motion.vertical_speed = read(Quantity::vertical_speed);
    samples.motion.roll = read(Quantity::roll);
    samples.motion.attack = read(Quantity::attack);
    read_flaps(flight, model, MaskOptions().min_airspeed, samples);
  }
  if (samples.flaps.empty()) return std::nullopt;
  std::vector<bool> extended;
  for (const double percent : samples.flaps) extended.push_back(percent > flaps_in);
  return extended;
}

FlightSamples read_samples(const Flight& flight, const ModelDefinition& model, const Reference& reference,
                           const MaskOptions& options) {
  FlightSamples samples;
  samples.name = flight.path().filename().string();
  samples.aircraft = flight.aircraft();
  samples.step = flight.time().step;
  samples.time = record_times(flight);
  samples.notes = flight.file().notes();
  for (Note& note : notes_on_law(flight, model)) samples.notes.push_back(std::move(note));
  note_other_units(flight, model, samples.notes);
  samples.model = read_model_columns(flight, model, reference.reads_laser(), samples.time, samples.notes);
  samples.reference = reference.read(flight, samples.time, samples.notes);
  samples.latitude = read_role(flight, model, Quantity::latitude).values;
  samples.longitude = read_longitude(flight, model).values;
  samples.motion = read_motion(flight, model, samples);
  for (Note& note : contradicting_signs(samples, options.min_airspeed))
    samples.notes.push_back(std::move(note));
  read_flaps(flight, model, options.min_airspeed, samples);
  for (const auto part : {&FlightSamples::model, &FlightSamples::reference})
    mark_frozen(flight, samples, part, options.min_airspeed);
  const std::optional<RegimeCriteria> criteria = RegimeCriteria::of(samples.aircraft);
  if (!criteria) {
    samples.notes.push_back(fmt::format(
        "check the regimes (--intervals corrects them): unknown aircraft {}, so the criteria of the "
        "C-130 are used; speed runs of a jet are faster",
        samples.aircraft.empty() ? "(no name)" : "'" + samples.aircraft + "'"));
  }
  samples.intervals = find_regimes(samples.motion, criteria.value_or(RegimeCriteria::c130()));
  if (options.intervals && options.intervals->is_for(flight.path())) {
    std::vector<OutsideInterval> outside =
        intervals_outside(*options.intervals, samples.time.front(), samples.time.back());
    if (!outside.empty()) {
      // A file for several flights may have dated intervals for each: the note names a time of day first.
      std::stable_partition(outside.begin(), outside.end(), std::mem_fn(&OutsideInterval::is_time_of_day));
      const std::string of_which =
          outside.size() == 1 ? " changes nothing: it is"
                              : fmt::format(" and {} more change nothing: they are", outside.size() - 1);
      std::string note = fmt::format("{}{} outside the flight, {} to {}", outside.front().text, of_which,
                                     utc_text(samples.time.front()), utc_text(samples.time.back()));
      const bool is_for_this = outside.front().is_time_of_day || !options.intervals->flight.empty();
      samples.notes.push_back(is_for_this ? warning_note(std::move(note)) : Note(std::move(note)));
    }
    samples.intervals =
        apply(*options.intervals, std::move(samples.intervals), samples.time.front(), samples.time.back());
  } else if (options.intervals) {
    samples.notes.push_back(fmt::format("the file of intervals is for {} only", options.intervals->flight));
  }
  return samples;
}

}  // namespace pcor
