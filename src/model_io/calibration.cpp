#include "model_io/calibration.hpp"

#include <cstddef>
#include <string>
#include <utility>

#include "model_io/covariance_blocks.hpp"

namespace pcor::internal {
namespace {

/// Beginning of the names of its coefficients.
const std::string calibration_prefix = std::string(calibration_id) + ".";

}  // namespace

double correction_at(double temperature, const std::vector<double>& coefficients) {
  double sum = 0.0;
  for (std::size_t k = coefficients.size(); k-- > 0;) sum = sum * temperature + coefficients[k];
  return sum;
}

ModelDefinition without_calibration(ModelDefinition file) {
  std::vector<ModelEffect>& effects = file.model.effects;
  for (std::size_t i = effects.size(); i-- > 0;) {
    if (effects[i].id != calibration_id || effects[i].is_formula()) continue;
    effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(i));
    if (i < file.fits.size()) file.fits.erase(file.fits.begin() + static_cast<std::ptrdiff_t>(i));
  }
  file.covariance = part_of(file.covariance,
                            [](const std::string& name) { return name.rfind(calibration_prefix, 0) != 0; });
  return file;
}

ModelDefinition with_calibration(ModelDefinition file, const std::vector<double>& coefficients,
                                 const std::vector<double>& standard_errors,
                                 const std::vector<std::vector<double>>& covariance) {
  file = without_calibration(std::move(file));
  ModelEffect effect = neutral_effect(calibration_id);
  EffectFit fit(effect.parameters.size());
  for (std::size_t i = 0; i < fit.size(); ++i) {
    fit[i].fixed = true;
    if (i >= coefficients.size()) continue;
    effect.parameters[i] = coefficients[i];
    fit[i].standard_error = standard_errors[i];
  }
  file.fits.resize(file.model.effects.size());
  file.model.effects.push_back(std::move(effect));
  file.fits.push_back(std::move(fit));

  // Pressure and temperature are fitted separately: the correlation of their errors is unknown and set to
  // zero.
  Covariance correction;
  correction.matrix = covariance;
  for (std::size_t i = 0; i < coefficients.size(); ++i)
    correction.parameters.push_back(calibration_prefix + "a" + std::to_string(i));
  add_independent(file.covariance, correction);
  return file;
}

}  // namespace pcor::internal
