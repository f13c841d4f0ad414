#include "diagnose/tested_variables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <pcor/physics/constants.hpp>
#include <pcor/units/units.hpp>
#include "base/phrasing.hpp"
#include "numerics/missing.hpp"
#include "parallel/flight_partition.hpp"

namespace pcor::internal {
namespace {

constexpr double full_turn = 360.0;  // deg

using Values = std::shared_ptr<const std::vector<double>>;

TestedVariable product(std::string name, const std::vector<FlightColumns>& flights, Quantity a, Quantity b) {
  TestedVariable variable;
  variable.name = std::move(name);
  for (const FlightColumns& flight : flights) {
    std::vector<double> values = flight.quantity(a);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] *= flight.quantity(b)[i];
    variable.values.push_back(std::make_shared<const std::vector<double>>(std::move(values)));
  }
  return variable;
}

/// Whether the variable is a simulation's true value in addition to the records.
bool is_truth(const VariableInfo& variable) { return variable.attribute("Category") == truth_category; }

double turn_of(const VariableInfo& info) {
  if (info.modulus_range) return (*info.modulus_range)[1] - (*info.modulus_range)[0];
  // Numbers without dimension are also convertible, with another scale.
  const bool is_degree = is_convertible(info.units, "degree") &&
                         UnitConversion::between(info.units, "degree", {}).scale() == 1.0;
  return is_degree ? full_turn : 0.0;
}

/// Number of records between values if a variable has a lower rate; otherwise 1.
std::size_t spacing_of(const std::vector<double>& values) {
  std::vector<std::size_t> records;  // records with a value
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) records.push_back(i);
  }
  if (records.size() < 2) return 1;
  std::size_t widest = 0;
  for (std::size_t k = 1; k < records.size(); ++k) widest = std::max(widest, records[k] - records[k - 1]);
  const double mean =
      static_cast<double>(records.back() - records.front()) / static_cast<double>(records.size() - 1);
  // Equidistant values with a few missing ones; otherwise these are gaps.
  return mean > 1.5 && static_cast<double>(widest) <= 3.0 * mean ? static_cast<std::size_t>(std::lround(mean))
                                                                 : 1;
}

void fill_between(std::vector<double>& values, bool hold) {
  std::size_t before = values.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    for (std::size_t k = before + 1; before < values.size() && k < i; ++k) {
      const double part = static_cast<double>(k - before) / static_cast<double>(i - before);
      values[k] = hold ? values[before] : values[before] + part * (values[i] - values[before]);
    }
    before = i;
  }
}

/// Description of a variable in a file, without its values.
struct Seen {
  double minimum = std::numeric_limits<double>::infinity();
  double maximum = -std::numeric_limits<double>::infinity();
  std::size_t spacing = 1;  // records from one value to the next

  template <class Archive>
  void serialize(Archive& archive) {
    archive(minimum, maximum, spacing);
  }
};

/// Variables of a file without their values. The turn is that of any angle.
std::vector<TestedVariable> described_by(const Flight& file, const std::set<std::string>& without) {
  std::vector<TestedVariable> result;
  for (const std::string& name : file.variables()) {
    const VariableInfo& info = file.variable(name);
    if (!info.is_series || without.count(name) != 0 || is_truth(info)) continue;
    TestedVariable& variable = result.emplace_back();
    variable.name = name;
    variable.unit = info.units;
    variable.description = info.long_name;
    variable.turn = turn_of(info);
    if (info.rate > 1) variable.sampling = fmt::format("means of {} samples a record", info.rate);
  }
  return result;
}

/// Reads a variable, one value a record.
Values read_variable(const Flight& file, const TestedVariable& variable, Seen& seen) {
  std::vector<double> values(file.records());
  file.read_at_rate(1, variable.name, UnitConversion(), values.data());
  seen.spacing = spacing_of(values);
  if (seen.spacing > 1) fill_between(values, variable.turn > 0.0);
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    seen.minimum = std::min(seen.minimum, value);
    seen.maximum = std::max(seen.maximum, value);
  }
  return std::make_shared<const std::vector<double>>(std::move(values));
}

/// Climb rate equivalent to climb plus acceleration, m/s: vertical speed + V/g dV/dt. It is thrust less drag
/// over weight, times V, and therefore varies with engine power.
TestedVariable specific_excess_power(const std::vector<FlightColumns>& flights) {
  TestedVariable variable;
  variable.name = "specific excess power";
  variable.unit = "m/s";
  variable.description = "vertical speed and acceleration together, as the power of the engines makes them";
  variable.may_be_cause = true;
  for (const FlightColumns& flight : flights) {
    const FlightMotion& motion = flight.samples->motion;
    const std::vector<double>* const rate = flight.samples->model.find(Quantity::airspeed_rate);
    auto values = std::make_shared<std::vector<double>>(flight.given.size(), nan);
    for (std::size_t i = 0; i < values->size() && rate != nullptr && !motion.vertical_speed.empty(); ++i)
      (*values)[i] = motion.vertical_speed[i] + motion.airspeed[i] / constants::standard_gravity * (*rate)[i];
    variable.values.push_back(std::move(values));
  }
  return variable;
}

using InputsOfVariables = std::map<std::string, std::vector<std::string>>;  // keyed by computed variable

/// The names and all their inputs, recursively. Some files contain circular dependencies.
std::set<std::string> with_inputs(const InputsOfVariables& inputs, std::set<std::string> names) {
  std::vector<std::string> open(names.begin(), names.end());
  while (!open.empty()) {
    const auto found = inputs.find(open.back());
    open.pop_back();
    if (found == inputs.end()) continue;
    for (const std::string& input : found->second) {
      if (names.insert(input).second) open.push_back(input);
    }
  }
  return names;
}

}  // namespace

std::set<std::string> computed_from(const Flight& flight, const std::set<std::string>& sensors) {
  InputsOfVariables inputs;
  for (const std::string& name : flight.variables()) {
    std::vector<std::string> words = split_words(flight.variable(name).attribute("Dependencies"));
    if (!words.empty()) words.erase(words.begin());  // number of inputs
    inputs[name] = std::move(words);
  }
  const std::set<std::string> measured = with_inputs(inputs, sensors);
  std::set<std::string> computed;
  for (const std::string& name : flight.variables()) {
    if (measured.count(name) > 0) continue;
    const std::set<std::string> all = with_inputs(inputs, {name});
    if (std::any_of(all.begin(), all.end(),
                    [&](const std::string& input) { return measured.count(input) > 0; }))
      computed.insert(name);
  }
  return computed;
}

std::vector<TestedVariable> quantity_variables(const std::vector<FlightColumns>& flights) {
  std::vector<TestedVariable> result;
  for (const auto& [quantity, column] : flights.front().quantities) {
    TestedVariable& variable = result.emplace_back();
    variable.name = std::string(info_of(quantity).name);
    variable.unit = std::string(info_of(quantity).unit);
    variable.fine = quantity == Quantity::corrected_mach;
    for (const FlightColumns& flight : flights)
      variable.values.emplace_back(Values(),
                                   &flight.quantity(quantity));  // points to the column of the flight
  }
  TestedVariable& pressure = result.emplace_back();
  pressure.name = "corrected_static_pressure";
  pressure.unit = "hPa";
  pressure.fine = true;
  for (const FlightColumns& flight : flights)
    pressure.values.emplace_back(Values(), &flight.corrected_pressure);
  result.push_back(product("attack times Mach number", flights, Quantity::attack, Quantity::corrected_mach));
  result.push_back(specific_excess_power(flights));
  result.push_back(
      product("sideslip times Mach number", flights, Quantity::sideslip, Quantity::corrected_mach));
  return result;
}

std::vector<TestedVariable> recorded_variables(const FlightSet& files,
                                               const std::vector<FlightColumns>& flights,
                                               const std::set<std::string>& without) {
  const std::vector<TestedVariable> of_first =
      files.partition()
          .all_gather_flights<std::vector<TestedVariable>>([&](std::size_t number) {
            return number == 0 ? described_by(files[0], without) : std::vector<TestedVariable>();
          })
          .front();
  const auto has = files.partition().all_gather_flights<std::vector<bool>>([&](std::size_t number) {
    const Flight& file = files[number];
    std::vector<bool> all;
    for (const TestedVariable& each : of_first)
      all.push_back(file.has(each.name) && file.variable(each.name).is_series);
    return all;
  });
  std::vector<TestedVariable> result;
  for (std::size_t k = 0; k < of_first.size(); ++k) {
    if (std::all_of(has.begin(), has.end(), [k](const std::vector<bool>& of_file) { return of_file[k]; }))
      result.push_back(of_first[k]);
  }
  std::vector<std::vector<Values>> values(result.size(), std::vector<Values>(files.size()));
  const auto seen = files.partition().all_gather_flights<std::vector<Seen>>([&](std::size_t number) {
    const Flight& file = files[number];
    std::vector<Seen> of_file(result.size());
    for (std::size_t k = 0; k < result.size(); ++k)
      values[k][number] = read_variable(file, result[k], of_file[k]);
    return of_file;
  });
  for (std::size_t k = 0; k < result.size(); ++k) {
    TestedVariable& variable = result[k];
    variable.in_file = true;
    variable.may_be_cause = true;
    double minimum = variable.turn;
    double maximum = -variable.turn;
    for (const std::vector<Seen>& of_file : seen) {
      minimum = std::min(minimum, of_file[k].minimum);
      maximum = std::max(maximum, of_file[k].maximum);
      if (of_file[k].spacing > 1)
        variable.sampling = fmt::format("one value in {} records, {} in between", of_file[k].spacing,
                                        variable.turn > 0.0 ? "held" : "interpolated");
    }
    // An angle within less than half of all directions is treated as an ordinary number.
    const double range = maximum - minimum;
    if (!(range > 0.5 * variable.turn && range <= variable.turn)) variable.turn = 0.0;
    for (const FlightColumns& flight : flights) {
      const Values& of_flight = values[k][flight.file];
      variable.values.push_back(of_flight ? of_flight : std::make_shared<const std::vector<double>>());
    }
  }
  return result;
}

}  // namespace pcor::internal
