#include <pcor/checks/check.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <pcor/base/error.hpp>
#include "base/phrasing.hpp"
#include "checks/checks.hpp"
#include "checks/manoeuvre_segment.hpp"
#include "flight/value_problem.hpp"
#include "numerics/missing.hpp"
#include "parallel/flight_partition.hpp"
#include "residuals/serialization.hpp"
#include "roles/recorded_model.hpp"

namespace pcor {

using namespace internal;

template <class Archive>
void serialize(Archive& archive, TestStatistic& number) {
  archive(number.value, number.standard_error, number.tolerance, number.unit, number.what, number.verdict);
}

/// The members of `check_per_flight`.
template <class Archive>
void serialize(Archive& archive, CheckResult& check) {
  archive(check.name, check.was_run, check.reason, check.verdict, check.key, check.inconclusive_reason);
}

namespace {

PressurePair pair_of(const ModelDefinition& model) {
  return {model.variables.at(Quantity::static_pressure), model.variables.at(Quantity::dynamic_pressure)};
}

/// Reason why the pressures of a model cannot be used although their variables are in the flight; empty if
/// they can.
std::string without_values(const Flight& flight, const ModelDefinition& model) {
  const PressurePair pair = pair_of(model);
  for (const std::string& variable : {pair.static_pressure, pair.dynamic_pressure}) {
    if (!flight.has(variable)) return "";  // suggestions are part of the message
    if (std::string problem = value_problem(flight, variable); !problem.empty()) return problem;
  }
  return "";
}

/// Pressure pair of the model, and another pair of the flight.
struct Systems {
  std::optional<PressurePair> primary{};
  std::optional<PressurePair> other{};
};

Systems systems_of(const Flight& flight, const PressurePair& of_model) {
  Systems systems;
  std::vector<PressurePair> pairs = measured_pairs(flight);
  const std::vector<PressurePair>& processed = naming_of(flight).processed;
  const bool corrected = std::any_of(processed.begin(), processed.end(), [&](const PressurePair& pair) {
    return pair.static_pressure == of_model.static_pressure;
  });
  // A corrected pair and the pair of the avionics are two systems if there is no further pair.
  const bool beside_avionics = pairs.size() == 1 && pairs.front().static_pressure == avionics_static_pressure;
  if (!corrected || beside_avionics) {
    systems.primary = of_model;
  } else if (!pairs.empty()) {
    systems.primary = pairs.front();
  }
  // Two pairs with one pitot have no redundant total pressures.
  const auto other = std::find_if(pairs.begin(), pairs.end(), [&](const PressurePair& pair) {
    return systems.primary && pair.static_pressure != systems.primary->static_pressure &&
           pair.dynamic_pressure != systems.primary->dynamic_pressure;
  });
  if (other != pairs.end()) systems.other = *other;
  return systems;
}

MeasuredPair measured(std::string name, const FlightAir& air) {
  return {std::move(name), air.measured_static, air.measured_dynamic};
}

CheckedFlight checked(const FlightSet& flights, std::size_t number, const ModelDefinition& model,
                      const CheckOptions& options) {
  CheckedFlight result;
  result.air = read_flight_air(flights, number, model, options.mask);
  const PressurePair of_model = pair_of(model);
  const Systems systems = systems_of(flights[number], of_model);
  if (systems.primary) {
    result.measured.push_back(
        *systems.primary == of_model
            ? measured(of_model.name(), result.air)
            : measured(systems.primary->name(),
                       read_flight_air(flights, number, model_of(*systems.primary), options.mask)));
  }
  result.second_corrected = options.second && !options.second->model.effects.empty();
  std::optional<ModelDefinition> second = options.second;
  if (!second && systems.other) second = model_of(*systems.other);
  if (!second) return result;
  if (pair_of(*second) == of_model) {
    throw Error(
        Error::Code::usage,
        fmt::format("the model '{}' has the pressures {} of the model under test; give a second system with "
                    "other pressures",
                    second->model.name, of_model.name()));
  }
  result.second = read_flight_air(flights, number, *second, options.mask);
  result.second_name = pair_of(*second).name();
  if (!result.measured.empty()) result.measured.push_back(measured(result.second_name, *result.second));
  return result;
}

/// Result of one flight, shared between ranks.
struct FlightPart {
  std::string unusable{};  ///< reason; empty if the flight is usable
  std::string model{};     ///< name of the model
  std::optional<CheckedFlight> flight{};

  template <class Archive>
  void serialize(Archive& archive) {
    archive(unusable, model, flight);
  }
};

FlightPart part_of(const FlightSet& flights, std::size_t number, const std::optional<ModelDefinition>& model,
                   const CheckOptions& options) {
  const Flight& flight = flights[number];
  const std::optional<ModelDefinition> its_model = model ? model : recorded_model(flight);
  FlightPart part;
  part.unusable = its_model ? without_values(flight, *its_model)
                            : fmt::format(
                                  "{}: name its pressures in [variables] of a model, -m: there are no values "
                                  "under the usual names (PSXC and QCXC, PSFD and QCF)",
                                  flight.path().string());
  if (!part.unusable.empty()) return part;
  part.model = its_model->model.name;
  part.flight = checked(flights, number, *its_model, options);
  if (!model && its_model->variables.count(Quantity::recovery_temperature) > 0) {
    part.flight->air.notes.push_back(fmt::format(
        "no model is given: the recovery factor of {} is assumed to be {:g}, the published value of such "
        "thermometers; a model (-m) states another",
        its_model->variables.at(Quantity::recovery_temperature), its_model->model.recovery.coefficients[0]));
  }
  return part;
}

/// Notes results that are significant but negligible.
void add_note_on_small(CheckResult& result) {
  constexpr double significant = 3.0;  // standard errors
  const double deviations = std::abs(result.key.value) / result.key.standard_error;
  const bool is_small = result.was_run && std::abs(result.key.value) <= result.key.tolerance;
  if (!is_small || !(deviations > significant)) return;
  result.notes.push_back(
      fmt::format("the number is {:.0f} standard errors from zero: significant, but negligible", deviations));
}

/// Samples and intervals shared by all pictures.
Report pictures_of(const CheckedFlights& flights) {
  Report report;
  for (const CheckedFlight& flight : flights) {
    report.flight_starts.push_back(report.time.size());
    report.flight_names.push_back(flight.air.samples->name);
    const std::vector<double>& time = flight.air.time();
    report.time.insert(report.time.end(), time.begin(), time.end());
    for (const Interval& interval : flight.air.samples->intervals)
      report.intervals.push_back({std::string(info_of(interval.regime).name), interval.begin, interval.end});
  }
  return report;
}

}  // namespace

std::string_view to_string(CheckVerdict verdict) {
  constexpr std::array names{"consistent", "inconsistent", "inconclusive"};
  return names[static_cast<std::size_t>(verdict)];
}

double CheckResult::number(std::string_view of) const {
  const auto found =
      std::find_if(numbers.begin(), numbers.end(), [of](const auto& each) { return each.first == of; });
  return found == numbers.end() ? nan : found->second;
}

Checks check(const FlightSet& flights, const std::optional<ModelDefinition>& model,
             const CheckOptions& options) {
  if (flights.empty()) throw Error(Error::Code::usage, "give at least one flight to check");
  flights.require_each_once();
  if (options.second && options.second->variables.count(Quantity::static_pressure) == 0) {
    throw Error(Error::Code::model,
                fmt::format("model '{}': the model of a second system must name its pressures; add "
                            "static_pressure and dynamic_pressure to [variables]",
                            options.second->model.name));
  }
  flights.require_one_aircraft();
  std::size_t done = 0;
  auto parts = flights.partition().all_gather_flights<FlightPart>([&](std::size_t number) {
    FlightPart part = part_of(flights, number, model, options);
    if (options.progress) options.progress(++done, flights.partition().local_count());
    return part;
  });
  flights.require_unchanged();
  Checks checks;
  checks.has_model = model.has_value();
  CheckedFlights read;
  std::vector<std::string> unusable;
  std::vector<FlightNote> notes;
  for (FlightPart& part : parts) {
    if (!part.unusable.empty()) {
      unusable.push_back(part.unusable);
      continue;
    }
    read.push_back(std::move(*part.flight));
    checks.flights.push_back(read.back().air.samples->name);
    if (checks.model.empty()) checks.model = part.model;
    for (const Note& note : read.back().air.notes) notes.emplace_back(checks.flights.back(), note);
  }
  checks.notes = notes_of_flights(notes, flights.size());
  for (const std::string& why : unusable) checks.notes.push_back("Not used: " + why);
  for (const NamedCheck& each : all_checks) {
    checks.results.push_back(read.empty() ? not_run(fmt::format("{}", fmt::join(unusable, "; ")))
                                          : each.run(read));
    checks.results.back().name = each.name;
    if (each.expects_zero) add_note_on_small(checks.results.back());
  }
  checks.pictures = pictures_of(read);
  return checks;
}

std::vector<std::vector<CheckResult>> check_per_flight(const FlightSet& flights,
                                                       const std::optional<ModelDefinition>& model,
                                                       const CheckOptions& options) {
  CheckOptions quiet = options;
  quiet.progress = nullptr;
  return flights.partition().all_gather_flights<std::vector<CheckResult>>(
      [&](std::size_t number) { return check(flights.only(number), model, quiet).results; });
}

}  // namespace pcor
