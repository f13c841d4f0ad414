#include "temperature/read_heights.hpp"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <pcor/physics/constants.hpp>
#include "campaign/flight_air.hpp"
#include "model_io/archived_model.hpp"
#include "model_io/calibration.hpp"
#include "roles/recorded_model.hpp"
#include "temperature/dry_air.hpp"
#include "temperature/law_doubt.hpp"

namespace pcor::internal {
namespace {

constexpr const char* steps_variable = "HYDSTEP";
constexpr const char* calibration_attribute = "temperature_calibration";
constexpr const char* model_attribute = "model";

using Coefficients = std::array<double, 3>;

[[noreturn]] void refuse_without(const Flight& flight, const char* what, const char* attribute) {
  throw Error(
      Error::Code::variable,
      fmt::format(
          "{}: {} does not state {} (attribute {}); write the file again with pcor process --hydrostatic",
          flight.path().string(), steps_variable, what, attribute));
}

std::string attribute_of(const Flight& flight, const std::string& requested) {
  for (const auto& [name, text] : flight.variable(steps_variable).attributes) {
    if (name == requested) return text;
  }
  return "";
}

Coefficients calibration_in(const Flight& flight) {
  Coefficients a{};
  std::istringstream text(attribute_of(flight, calibration_attribute));
  if (!(text >> a[0] >> a[1] >> a[2]))
    refuse_without(flight, "the temperature correction in ATX", calibration_attribute);
  return a;
}

void require_same_model(const Flight& flight, const ModelDefinition& model) {
  const std::string archived = attribute_of(flight, model_attribute);
  if (archived.empty()) refuse_without(flight, "its model", model_attribute);
  const std::string difference = archived_difference(archived, archived_model(model, CorrectWith::model));
  if (difference.empty()) return;
  throw Error(
      Error::Code::model,
      fmt::format(
          "{}: its pressures are not those of the model '{}' ({}); process the flight again with this model "
          "and "
          "--hydrostatic, give the model that it was processed with, or omit --archived for raw flights",
          flight.path().string(), model.model.name, difference));
}

/// The temperature, K, that the correction took to `corrected`, K: Newton's method from a step that is exact
/// for a constant.
double uncorrected(double corrected, const Coefficients& a) {
  const double target = corrected - constants::ice_point;
  double t = target - a[0];
  for (int step = 0; step < 6; ++step)
    t -= (t + a[0] + a[1] * t + a[2] * t * t - target) / (1.0 + a[1] + 2.0 * a[2] * t);
  return t + constants::ice_point;
}

/// -(R_a/g0) ln(p_i/p_(i-1)) from the mean of the record before to that of every record, as `pcor process
/// --hydrostatic` wrote it, m/K; NaN if missing. Takes the correction of the temperature that the file's
/// ATX has already off the temperature of `air`.
/// @throws Error if the file was not written so, or with a model whose pressures are others than those of
/// `model`; the correction of the temperature may be another.
std::vector<double> archived_steps(const Flight& flight, const ModelDefinition& model, FlightAir& air) {
  if (!flight.has(steps_variable)) {
    throw Error(
        Error::Code::variable,
        fmt::format("{}: there is no {}; write it with pcor process --hydrostatic, or omit --archived",
                    flight.path().string(), steps_variable));
  }
  require_same_model(flight, model);
  const UnitConversion conversion = flight.conversion(steps_variable, "m/K");
  const auto rate = static_cast<std::size_t>(flight.variable(steps_variable).rate);
  std::vector<double> steps(air.size(), 0.0);
  std::vector<double> values;
  for (const RecordBlock block : blocks_of(flight.records())) {
    values.resize(block.count * rate);
    flight.read(steps_variable, block, conversion, values.data());
    for (std::size_t i = 0; i < values.size(); ++i) {
      // From the mean over a record to that over the next: a step within a record is in its later samples
      // only, and the rest of it comes with the next record.
      const std::size_t record = block.first + i / rate;
      const double later = static_cast<double>(i % rate) / static_cast<double>(rate);
      steps[record] += values[i] * (1.0 - later);
      if (later > 0.0 && record + 1 < steps.size()) steps[record + 1] += values[i] * later;
    }
  }
  const Coefficients calibration = calibration_in(flight);
  for (double& temperature : air.temperature) temperature = uncorrected(temperature, calibration);
  return steps;
}

HeightRecord record_of(const FlightSet& flights, std::size_t number, const ModelDefinition& model,
                       const TemperatureOptions& options) {
  ModelDefinition stated = without_calibration(model);
  HeightRecordOptions record_options;
  record_options.min_climb_rate = options.min_climb_rate;
  record_options.has_radome = model.variables.count(Quantity::attack_differential_pressure) > 0;
  record_options.recovers = model.variables.count(Quantity::recovery_temperature) > 0;
  FlightAir air;
  std::vector<double> steps;
  if (options.archived) {
    const Flight& flight = flights[number];
    std::optional<ModelDefinition> recorded = recorded_model(flight);
    if (!recorded || recorded->variables.count(Quantity::ambient_temperature) == 0) {
      throw Error(
          Error::Code::variable,
          fmt::format(
              "{}: --archived needs PSXC, QCXC and ATX as pcor process writes them; omit it for raw flights",
              flight.path().string()));
    }
    for (const Quantity role : flown_quantities) {
      if (model.variables.count(role) > 0) recorded->variables[role] = model.variables.at(role);
      if (model.units.count(role) > 0) recorded->units[role] = model.units.at(role);
    }
    air = read_flight_air(flights, number, *recorded, options.mask);
    steps = archived_steps(flight, model, air);
  } else {
    air = read_flight_air(flights, number, stated, options.mask);
  }
  HeightRecord record = height_record(air, steps, record_options);
  if (options.archived) {  // Inputs of the model are not archived: only its remaining error is known.
    stated.covariance = {};
    stated.fits.clear();
  }
  record.law_variance = stated_law_variance(stated, air);
  return record;
}

}  // namespace

FlightHeightRecord read_heights(const FlightSet& flights, std::size_t number, const ModelDefinition& model,
                                const TemperatureOptions& options) {
  FlightHeightRecord part;
  try {
    part.record = record_of(flights, number, model, options);
    part.dry = trouble_with_dry_air(*part.record, model, flights[number]);
    if (!part.dry.empty() && !options.dry_air)
      throw Error(Error::Code::variable, part.dry + "; --force continues with dry air");
    if (options.skip_returning && part.record->returns) {
      part.record.reset();
      part.excluded = "it ends at its start point (--skip-returning)";
    }
  } catch (const Error& error) {
    part.record.reset();
    part.excluded = error.what();
    part.code = error.code();
  }
  return part;
}

}  // namespace pcor::internal
