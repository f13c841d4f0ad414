#include "diagnose/tested_variables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <pcor/physics/constants.hpp>
#include <pcor/words/error.hpp>
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

constexpr double full_turn = 360.0;  // deg

using Values = std::shared_ptr<const std::vector<double>>;

/// The series of each flight as those of its own, without a copy of what the flights hold.
template <class Member>
std::vector<Values> held_by(const std::vector<FlightColumns>& flights, const Member& member) {
  std::vector<Values> result;
  for (const FlightColumns& flight : flights) result.emplace_back(Values(), &member(flight));
  return result;
}

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

/// Whether a simulated flight holds the variable as the truth beside what was recorded.
bool is_truth(const VariableInfo& variable) {
  return std::any_of(variable.attributes.begin(), variable.attributes.end(), [](const auto& attribute) {
    return attribute.first == "Category" && attribute.second == truth_category;
  });
}

/// The place of the file of which a flight is a part.
std::size_t file_of(const FlightColumns& flight, const std::vector<Flight>& files) {
  const std::vector<double>& time = flight.samples->time;
  for (std::size_t k = 0; k < files.size(); ++k) {
    const TimeAxis& axis = files[k].time();
    if (files[k].records() == time.size() && std::abs(time.front() - axis.first) <= axis.step) return k;
  }
  throw Error(fmt::format("{} is not one of the flights that were read", flight.samples->name));
}

double turn_of(const VariableInfo& info) {
  if (info.modulus_range) return (*info.modulus_range)[1] - (*info.modulus_range)[0];
  return info.units.compare(0, 3, "deg") == 0 && info.units != "deg_C" && info.units != "degC" ? full_turn
                                                                                               : 0.0;
}

/// An angle that takes less than half of all directions is as good as any other number.
bool takes_all_directions(const std::vector<Values>& series, double turn) {
  double least = turn;
  double most = -turn;
  for (const Values& values : series) {
    for (const double value : *values) {
      if (!std::isfinite(value)) continue;
      least = std::min(least, value);
      most = std::max(most, value);
    }
  }
  return most - least > 0.5 * turn && most - least <= turn;
}

/// Records from one value to the next where a variable has one every so many records only; 1 elsewhere.
std::size_t spacing_of(const std::vector<double>& values) {
  std::size_t first = values.size();
  std::size_t last = 0;
  std::size_t count = 0;
  std::size_t widest = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    if (count > 0) widest = std::max(widest, i - last);
    first = std::min(first, i);
    last = i;
    ++count;
  }
  if (count < 2) return 1;
  const double mean = static_cast<double>(last - first) / static_cast<double>(count - 1);
  // Evenly spaced, with one value missing here and there; else these are gaps.
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

TestedVariable read_variable(const std::vector<Flight>& files, const std::vector<std::size_t>& file_of_flight,
                             const std::string& name) {
  const VariableInfo& info = files.front().variable(name);
  TestedVariable variable;
  variable.name = name;
  variable.unit = info.units;
  variable.description = info.long_name;
  variable.in_file = true;
  variable.may_be_cause = true;
  if (info.rate > 1) variable.sampling = fmt::format("means of {} samples a record", info.rate);
  const double turn = turn_of(info);
  std::vector<Values> of_files;
  for (const Flight& file : files) {
    std::vector<double> values(file.records());
    for (const RecordBlock block : blocks_of(file.records()))
      file.read_at_rate(1, name, block, UnitConversion(), values.data() + block.first);
    if (const std::size_t spacing = spacing_of(values); spacing > 1) {
      fill_between(values, turn > 0.0);
      variable.sampling = fmt::format("one value in {} records, {} in between", spacing,
                                      turn > 0.0 ? "held" : "interpolated");
    }
    of_files.push_back(std::make_shared<const std::vector<double>>(std::move(values)));
  }
  if (turn > 0.0 && takes_all_directions(of_files, turn)) variable.turn = turn;
  for (const std::size_t file : file_of_flight) variable.values.push_back(of_files[file]);
  return variable;
}

/// The climb that the aircraft flies or could fly for its acceleration, m/s: vertical speed + V/g dV/dt. It
/// is thrust less drag over weight, times V, and so goes with what the engines do.
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

}  // namespace

std::vector<const double*> TestedVariable::pointers() const {
  std::vector<const double*> result;
  for (const Values& each : values) result.push_back(each->data());
  return result;
}

std::vector<TestedVariable> flown_variables(const std::vector<FlightColumns>& flights) {
  std::vector<TestedVariable> result;
  for (const auto& each : flights.front().quantities) {
    const Quantity quantity = each.first;
    TestedVariable& variable = result.emplace_back();
    variable.name = std::string(facts_of(quantity).name);
    variable.unit = std::string(facts_of(quantity).unit);
    variable.fine = quantity == Quantity::corrected_mach;
    variable.values = held_by(flights, [quantity](const FlightColumns& flight) -> const std::vector<double>& {
      return flight.quantity(quantity);
    });
  }
  TestedVariable& pressure = result.emplace_back();
  pressure.name = "corrected_static_pressure";
  pressure.unit = "hPa";
  pressure.fine = true;
  pressure.values = held_by(flights, [](const FlightColumns& flight) -> const std::vector<double>& {
    return flight.corrected_pressure;
  });
  result.push_back(product("attack times Mach number", flights, Quantity::attack, Quantity::corrected_mach));
  result.push_back(specific_excess_power(flights));
  result.push_back(
      product("sideslip times Mach number", flights, Quantity::sideslip, Quantity::corrected_mach));
  return result;
}

std::vector<TestedVariable> recorded_variables(const std::vector<Flight>& files,
                                               const std::vector<FlightColumns>& flights,
                                               const std::set<std::string>& without) {
  std::vector<std::size_t> file_of_flight;
  for (const FlightColumns& flight : flights) file_of_flight.push_back(file_of(flight, files));
  std::vector<TestedVariable> result;
  for (const std::string& name : files.front().variables()) {
    const bool everywhere = std::all_of(files.begin(), files.end(), [&name](const Flight& file) {
      return file.has(name) && file.variable(name).is_series;
    });
    if (everywhere && without.count(name) == 0 && !is_truth(files.front().variable(name)))
      result.push_back(read_variable(files, file_of_flight, name));
  }
  return result;
}

}  // namespace pcor::internal
