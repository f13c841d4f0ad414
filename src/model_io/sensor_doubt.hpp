#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {

/// A sensor that is not calibrated exactly: a coefficient that would correct it, and its standard
/// uncertainty.
struct SensorDoubt {
  std::string effect;
  std::size_t parameter = 0;
  double size = 0.0;     ///< in the unit of the coefficient
  bool is_usual = true;  ///< the model states no other

  /// Like "lams-scale.scale".
  std::string name() const;
};

/// Effects whose coefficients describe the calibration of a sensor.
inline const std::vector<std::string_view> laser_calibration{"lams-scale", "lams-elevation", "lams-azimuth"};
inline const std::vector<std::string_view> thermometer_calibration{"temp-offset", "recovery-factor"};
inline const std::vector<std::string_view> pressure_calibration{"psfd-bias", "psfd-gain", "psfd-drift",
                                                                "qcf-zero"};

/// Whether the coefficient, like "temp-offset.offset", has a doubt by default (`ParameterInfo::doubt`).
bool has_doubt(std::string_view coefficient);

/// The doubts of these effects: the usual ones, or those that `[uncertainty]` of the model states. An effect
/// that the model has is what the model states of that sensor; there is no doubt by default beside it. A
/// calibration of the thermometer (temp-calibration) stands for its offset.
std::vector<SensorDoubt> doubts_of(const ModelDefinition& model,
                                   const std::vector<std::string_view>& effects);

/// The model with those effects of these doubts that it lacks, fixed at their neutral values, with the doubts
/// as standard errors. A covariance of the model that names their coefficients belongs to them.
ModelDefinition with_doubts(ModelDefinition model, const std::vector<SensorDoubt>& doubts);

}  // namespace pcor::internal
