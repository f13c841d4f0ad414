#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {

/// Calibration uncertainty of a sensor: a coefficient that would correct it, and its standard uncertainty.
struct SensorUncertainty {
  std::string effect;
  std::size_t parameter = 0;
  double size = 0.0;     ///< standard uncertainty in the unit of the coefficient
  bool is_usual = true;  ///< default value; the model does not state one

  /// Name like "lams-scale.scale".
  std::string name() const;
};

/// Effects whose coefficients describe the calibration of a sensor.
inline const std::vector<std::string_view> laser_calibration{"lams-scale", "lams-elevation", "lams-azimuth"};
inline const std::vector<std::string_view> thermometer_calibration{"temp-offset", "recovery-factor"};
inline const std::vector<std::string_view> static_calibration{"psfd-bias", "psfd-gain", "psfd-drift"};
inline const std::vector<std::string_view> dynamic_calibration{"qcf-zero"};

/// Whether the coefficient, like "temp-offset.offset", has a default uncertainty
/// (`ParameterInfo::calibration_uncertainty`).
bool has_default_uncertainty(std::string_view coefficient);

/// Whether a coefficient corrects the same error of a sensor as another one that has a default uncertainty:
/// the same coefficient, or the constant of temp-calibration, which corrects the offset of the thermometer.
bool corrects_error_of(std::string_view coefficient, std::string_view other);

/// Uncertainties of these effects: the defaults, or the values in `[uncertainty]` of the model. If a
/// coefficient of the model corrects the error (`corrects_error_of`), its stated uncertainty applies and no
/// default is added.
std::vector<SensorUncertainty> uncertainties_of(const ModelDefinition& model,
                                                const std::vector<std::string_view>& effects);

/// Model extended by the missing effects of these uncertainties, fixed at their neutral values, with the
/// uncertainties as standard errors. A covariance of the model that names their coefficients applies to them.
ModelDefinition with_uncertain_sensors(ModelDefinition model,
                                       const std::vector<SensorUncertainty>& uncertainties);

/// Uncertainty that the file states, without default values of sensors (`uncertainty_of` adds these): the
/// covariance is of the parameters of the model only.
ModelUncertainty stated_uncertainty(const ModelDefinition& file);

}  // namespace pcor::internal
