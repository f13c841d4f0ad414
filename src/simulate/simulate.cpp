#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <pcor/base/error.hpp>
#include <pcor/base/utc.hpp>
#include <pcor/flight/flight_writer.hpp>
#include <pcor/physics/constants.hpp>
#include <pcor/simulate/simulate.hpp>
#include <string_view>
#include <tuple>
#include <utility>

#include "simulate/air.hpp"
#include "simulate/aircraft.hpp"
#include "simulate/effects.hpp"
#include "simulate/flight_plan.hpp"
#include "simulate/sensors.hpp"

namespace pcor {

using namespace internal;

namespace {

using namespace simulate;

constexpr int slow = 1;  // samples a second

/// A variable of the file with its values.
struct RecordedVariable {
  OutputVariable variable;
  std::vector<double> values;
};

/// Collects the variables of the file.
class Recording {
 public:
  Recording(const Scenario& scenario, const Truth& truth)
      : scenario_(scenario),
        truth_(truth),
        aircraft_(info_of(scenario.aircraft)),
        faults_(faults_of(scenario, truth)) {
    record_pressures();
    record_air();
    record_avionics();
    record_motion();
    write_truth();
  }

  std::vector<RecordedVariable>& columns() { return columns_; }

 private:
  std::vector<double>& record(std::string_view name, std::string_view units, std::string_view what,
                              Series series, int rate) {
    put(name, units, what, recorded(scenario_, faults_, std::string(name), std::move(series), rate), rate);
    return columns_.back().values;
  }

  void put(std::string_view name, std::string_view units, std::string_view what, std::vector<double> values,
           int rate) {
    OutputVariable variable;
    variable.name = name;
    variable.rate = rate;
    variable.units = units;
    variable.long_name = what;
    variable.data_quality = "Simulated";
    if (name.rfind("TRUE_", 0) == 0) variable.category = truth_category;
    columns_.push_back({std::move(variable), std::move(values)});
  }

  void record_pressures() {
    const int rate = scenario_.rate;
    for (std::size_t i = 0; i < scenario_.systems.size(); ++i) {
      const Scenario::System& system = scenario_.systems[i];
      PairReading pair = read_pair(system, faults_.systems[i], truth_, aircraft_);
      record(system.static_pressure, "hPa", "raw static pressure", std::move(pair.static_pressure), rate);
      record(system.dynamic_pressure, "hPa", "raw dynamic pressure", std::move(pair.dynamic_pressure), rate);
      put("TRUE_PCOR_" + system.static_pressure, "hPa",
          "static defect of " + system.static_pressure + ", to be added to it", means(pair.defect, rate),
          rate);
      if (i == 0) record_radome(pair.defect);
    }
  }

  // The angles that processing finds are those of the recorded pressures.
  void record_radome(const Series& defect) {
    const int rate = scenario_.rate;
    RadomeReading radome = read_radome(faults_, truth_, aircraft_, defect);
    const std::vector<double> q =
        record("QCR", "hPa", "raw dynamic pressure, radome", std::move(radome.dynamic_pressure), rate);
    const std::vector<double> up =
        record("ADIFR", "hPa", "vertical differential pressure, radome", std::move(radome.attack), rate);
    const std::vector<double> side =
        record("BDIFR", "hPa", "horizontal differential pressure, radome", std::move(radome.sideslip), rate);
    const std::vector<double> mach = means(truth_.mach, rate);
    std::vector<double> attack(q.size());
    std::vector<double> sideslip(q.size());
    constexpr double min_flow = 1.0;  // hPa; minimum for valid port readings
    for (std::size_t i = 0; i < q.size(); ++i) {
      const bool flow = q[i] > min_flow;
      attack[i] = flow ? aircraft_.attack.angle(up[i] / q[i], mach[i]) : Scenario::by_default;
      sideslip[i] = flow ? aircraft_.sideslip.angle(side[i] / q[i], mach[i]) : Scenario::by_default;
    }
    put("ATTACK", "degree", "angle of attack, radome", std::move(attack), rate);
    put("SSLIP", "degree", "sideslip, radome, wind from starboard positive", std::move(sideslip), rate);
  }

  void record_air() {
    const int rate = scenario_.rate;
    Thermometer first = aircraft_.thermometer;
    if (!std::isnan(scenario_.recovery_factor)) first.recovery = {scenario_.recovery_factor, 0.0, 0.0, 0.0};
    for (const Thermometer& thermometer : {first, aircraft_.second_thermometer}) {
      record(thermometer.name, "degC", "recovery temperature",
             celsius(read_thermometer(thermometer, faults_, truth_)), rate);
    }
    Series vapor = truth_.vapor_pressure;
    for (double& value : vapor) value *= 1.0 + faults_.humidity_gain;
    Series dew(vapor.size());
    std::transform(vapor.begin(), vapor.end(), dew.begin(), dew_point);
    if (faults_.dew_point != 0.0) {
      for (double& value : dew) value += faults_.dew_point;
      std::transform(dew.begin(), dew.end(), vapor.begin(), saturation_pressure);
    }
    const std::vector<double> recorded =
        record("EDPC", "hPa", "ambient water vapour pressure", std::move(vapor), slow);
    put("EWX", "hPa", "ambient water vapour pressure, reference", recorded, slow);
    record("DPXC", "degC", "dew point", celsius(std::move(dew)), slow);
    record("VLAMS", "m/s", "airspeed along the laser beam", read_lams(scenario_, faults_, truth_, aircraft_),
           rate);
  }

  void record_avionics() {
    const auto filtered = [this](Series series) {
      return delayed(with_response(std::move(series), scenario_.avionics.response), scenario_.avionics.delay);
    };
    record("PS_A", "hPa", "avionics static pressure", filtered(truth_.pressure), slow);
    record("QC_A", "hPa", "avionics dynamic pressure", filtered(true_dynamic_pressure()), slow);
    Series mach = scenario_.avionics.has_law ? mach_of_law(scenario_, truth_, aircraft_) : truth_.mach;
    record("MACH_A", "1", "avionics Mach number", filtered(std::move(mach)), scenario_.rate);
  }

  void record_motion() {
    for (const TruthInfo& info : truth_info) {
      if (info.recorded.empty()) continue;
      std::vector<double>& values = record(info.recorded, info.unit, info.description, in_unit_of_file(info),
                                           info.fast ? scenario_.rate : slow);
      if (!info.angle) continue;
      for (double& degrees : values) degrees -= 360.0 * std::floor(degrees / 360.0);
    }
  }

  void write_truth() {
    for (const TruthInfo& info : truth_info) {
      if (info.name.empty()) continue;
      const int rate = info.fast ? scenario_.rate : slow;
      put(info.name, info.unit, "truth: " + std::string(info.description), means(in_unit_of_file(info), rate),
          rate);
    }
    put("TRUE_QC", "hPa", "truth: dynamic pressure", means(true_dynamic_pressure(), scenario_.rate),
        scenario_.rate);
  }

  Series true_dynamic_pressure() const {
    Series dynamic = truth_.total_pressure;
    for (std::size_t i = 0; i < dynamic.size(); ++i) dynamic[i] -= truth_.pressure[i];
    return dynamic;
  }

  /// The truth in the unit of the file.
  Series in_unit_of_file(const TruthInfo& info) const {
    return info.unit == "degC" ? celsius(truth_.*info.series) : truth_.*info.series;
  }

  static Series celsius(Series kelvin) {
    for (double& value : kelvin) value -= constants::ice_point;
    return kelvin;
  }

  const Scenario& scenario_;
  const Truth& truth_;
  const AircraftInfo& aircraft_;
  Faults faults_;
  std::vector<RecordedVariable> columns_;
};

/// The records that are in the file: all but those of gaps without a variable.
std::vector<std::size_t> kept_records(const Scenario& scenario, std::size_t records) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < records; ++i) {
    const auto time = static_cast<double>(i);
    const bool lost = std::any_of(scenario.gaps.begin(), scenario.gaps.end(), [time](const auto& gap) {
      return gap.variable.empty() && time >= gap.start && time < gap.start + gap.duration;
    });
    if (!lost) kept.push_back(i);
  }
  if (kept.empty())
    throw Error(Error::Code::definition, scenario.file + ": the gaps leave no record; make them shorter");
  return kept;
}

std::vector<double> values_at(const std::vector<double>& values, const std::vector<std::size_t>& records,
                              std::size_t rate) {
  std::vector<double> selected;
  selected.reserve(records.size() * rate);
  for (const std::size_t record : records) {
    for (std::size_t k = 0; k < rate; ++k) selected.push_back(values[record * rate + k]);
  }
  return selected;
}

SimulatedLeg describe(const LegSteps& steps, const Truth& truth, double start) {
  SimulatedLeg leg;
  leg.kind = leg_info[static_cast<std::size_t>(steps.kind)].name;
  leg.start_time = start + time_step * static_cast<double>(steps.first);
  leg.end_time = start + time_step * static_cast<double>(steps.last);
  const auto extremes = [&](const Series& series) {
    const auto [least, greatest] =
        std::minmax_element(series.data() + steps.first, series.data() + steps.last);
    return std::pair{*least, *greatest};
  };
  std::tie(leg.min_speed, leg.max_speed) = extremes(truth.airspeed);
  std::tie(leg.min_attack, leg.max_attack) = extremes(truth.attack);
  for (std::size_t i = steps.first; i < steps.last; ++i) {
    leg.altitude += truth.altitude[i];
    leg.pressure += truth.pressure[i];
  }
  leg.altitude /= static_cast<double>(steps.last - steps.first);
  leg.pressure /= static_cast<double>(steps.last - steps.first);
  return leg;
}

FileDescription description_of(const Scenario& scenario, const SimulationSummary& summary,
                               const std::string& history) {
  FileDescription description;
  description.title = "Simulated flight: " + scenario.name;
  description.history = history.empty() ? "simulated by pcor" : history;
  description.latitude = "GGLAT";
  description.longitude = "GGLON";
  description.altitude = "GGALT";
  std::string legs;
  for (const SimulatedLeg& leg : summary.legs) {
    legs += fmt::format("{}{} {}-{}", legs.empty() ? "" : "; ", leg.kind,
                        utc_text(leg.start_time, "%H:%M:%S"), utc_text(leg.end_time, "%H:%M:%S"));
  }
  const AircraftInfo& aircraft = info_of(scenario.aircraft);
  description.attributes = {{"source", "simulation"},
                            {"platform", std::string(aircraft.registration)},
                            {"project", "SIMULATION"},
                            {"FlightNumber", scenario.name},
                            {"simulation_seed", std::to_string(scenario.seed)},
                            {"simulation_legs", legs}};
  if (!summary.effects.empty())
    description.attributes.emplace_back("simulation_effects",
                                        fmt::format("{}", fmt::join(summary.effects, " ")));
  return description;
}

}  // namespace

SimulationSummary simulate_flight(const Scenario& scenario, const std::filesystem::path& output,
                                  const SimulateOptions& options) {
  const SimulatedPlan plan = fly(scenario);
  Recording recording(scenario, plan.truth);
  std::vector<RecordedVariable>& columns = recording.columns();

  const std::vector<std::size_t> kept =
      kept_records(scenario, plan.truth.size() / static_cast<std::size_t>(internal_rate));
  SimulationSummary summary;
  summary.output = output.string();
  const AircraftInfo& aircraft = info_of(scenario.aircraft);
  summary.name = scenario.name;
  summary.aircraft = fmt::format("{} {}", aircraft.type, aircraft.registration);
  summary.seed = scenario.seed;
  summary.records = kept.size();
  summary.rate = scenario.rate;
  summary.start_time = scenario.start + static_cast<double>(kept.front());
  summary.end_time = scenario.start + static_cast<double>(kept.back());
  for (const LegSteps& leg : plan.legs) summary.legs.push_back(describe(leg, plan.truth, scenario.start));
  for (const Scenario::Effect& effect : scenario.effects) summary.effects.push_back(effect.id);

  FlightWriter writer(output, NewFlight{summary.start_time},
                      description_of(scenario, summary, options.history));
  for (const RecordedVariable& column : columns) {
    writer.define(column.variable);
    const bool truth = column.variable.category == truth_category;
    (truth ? summary.truth : summary.variables).push_back(column.variable.name);
  }
  std::vector<double> times;
  for (const std::size_t record : kept) times.push_back(scenario.start + static_cast<double>(record));
  const RecordBlock all{0, kept.size()};
  writer.write_time_stamps(all, times.data());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::vector<double> values =
        values_at(columns[i].values, kept, static_cast<std::size_t>(columns[i].variable.rate));
    writer.write(i, all, values.data());
    if (options.progress) options.progress(i + 1, columns.size());
  }
  writer.finish();
  return summary;
}

}  // namespace pcor
