#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <pcor/base/error.hpp>
#include <pcor/campaign/flight_set.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/temperature/temperature.hpp>
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

/// Reads the heights and the air of a flight without the temperature correction of the model.
/// @param number of the flight
FlightHeightRecord read_heights(const FlightSet& flights, std::size_t number, const ModelDefinition& model,
                                const TemperatureOptions& options);

}  // namespace pcor::internal
