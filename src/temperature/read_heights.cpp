#include "temperature/read_heights.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "campaign/flight_air.hpp"
#include "model_io/archived_model.hpp"
#include "model_io/calibration.hpp"
#include "roles/recorded_model.hpp"
#include "temperature/archived_steps.hpp"
#include "temperature/dry_air.hpp"
#include "temperature/law_doubt.hpp"

namespace pcor::internal {
namespace {

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
