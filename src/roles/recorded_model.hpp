#pragma once

#include <optional>
#include <string>
#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/laws/model_file.hpp>

namespace pcor::internal {

/// The variables of a pair of pressures.
struct PressurePair {
  std::string static_pressure;
  std::string dynamic_pressure;

  /// "PSFD/QCF".
  std::string name() const { return static_pressure + "/" + dynamic_pressure; }
};

/// Whether a flight has values of a pressure, by name and unit.
bool has_pressure(const Flight& flight, const std::string& variable);

/// The pairs as measured that the flight has, of those that NCAR's aircraft have: PSFD/QCF, PSFRD/QCFR,
/// PSF/QCF, PS_A/QC_A, in this order.
std::vector<PressurePair> measured_pairs(const Flight& flight);

/// The model that stands in where none is given: the pressures that the flight's own processing corrected
/// (PSXC, QCXC), else its reference (PSX, QCX), else the first of the pairs as measured, with its ambient
/// temperature (ATX), else a recovery temperature with a recovery factor of 0.95. Nothing is added to them.
/// Absent where the flight has no pair with values.
std::optional<ModelFile> recorded_model(const Flight& flight);

/// A model of a pair as it is measured: nothing is added.
ModelFile model_of(const PressurePair& pair);

}  // namespace pcor::internal
