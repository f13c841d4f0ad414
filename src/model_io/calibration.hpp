#pragma once

#include <vector>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {

/// The id of the effect that corrects the ambient temperature.
inline constexpr const char* calibration_id = "temp-calibration";

/// The correction at a temperature, K: a0 + a1 t + ..., t in degC; 0 without coefficients.
double correction_at(double temperature, const std::vector<double>& coefficients);

/// The model without its correction of the ambient temperature.
ModelDefinition without_calibration(ModelDefinition file);

/// Model whose temperature correction is replaced by up to three coefficients a0, a1, a2. The coefficients
/// are fixed in refits, since delta-p does not determine them.
ModelDefinition with_calibration(ModelDefinition file, const std::vector<double>& coefficients,
                                 const std::vector<double>& standard_errors,
                                 const std::vector<std::vector<double>>& covariance);

}  // namespace pcor::internal
