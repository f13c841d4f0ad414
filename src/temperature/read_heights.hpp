#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <pcor/base/error.hpp>
#include <pcor/campaign/flight_set.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/temperature/temperature.hpp>
#include "campaign/flight_air.hpp"
#include "temperature/height_record.hpp"

namespace pcor::internal {

/// Heights of a flight, or the reason why it is not used.
struct FlightHeightRecord {
  std::string excluded{};                   ///< reason for exclusion; empty if used
  Error::Code code = Error::Code::samples;  ///< code of the error that excluded it
  std::string dry{};                        ///< reason against dry air; empty if there is no objection
  std::optional<HeightRecord> record{};

  template <class Archive>
  void serialize(Archive& archive) {
    archive(excluded, code, dry, record);
  }
};

/// Reason against assuming dry air for a flight: it reaches below 5 km, where neglected vapour resembles a
/// thermometer that reads too low by up to a few K. Names a humidity variable for the model, if there is one.
/// Empty if the integral includes the vapour, or the flight stays above.
std::string dry_air_problem(const HeightRecord& record, const ModelDefinition& model, const Flight& flight);

/// Variance of delta-p stated by a model, hPa2, averaged over the samples in the air: from the covariance of
/// its coefficients, and its remaining error. nullopt if the model states neither.
std::optional<double> stated_law_variance(const ModelDefinition& model, const FlightAir& air);

/// Reads the heights and the air of a flight without the temperature correction of the model.
/// @param number of the flight
FlightHeightRecord read_heights(const FlightSet& flights, std::size_t number, const ModelDefinition& model,
                                const TemperatureOptions& options);

}  // namespace pcor::internal
