#include "calibration.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

namespace pcor {
namespace {

std::string name_of_coefficient(std::size_t number) {
  return std::string(calibration_id) + ".a" + std::to_string(number);
}

/// Leaves the rows and columns of the correction out of a covariance.
Covariance without_correction(const Covariance& covariance) {
  std::vector<std::size_t> kept;
  const std::string prefix = std::string(calibration_id) + ".";
  for (std::size_t i = 0; i < covariance.parameters.size(); ++i) {
    if (covariance.parameters[i].compare(0, prefix.size(), prefix) != 0) kept.push_back(i);
  }
  Covariance result;
  for (const std::size_t i : kept) {
    result.parameters.push_back(covariance.parameters[i]);
    std::vector<double>& row = result.matrix.emplace_back();
    for (const std::size_t j : kept) row.push_back(covariance.matrix[i][j]);
  }
  return result;
}

}  // namespace

double correction_at(double temperature, const std::vector<double>& coefficients) {
  double sum = 0.0;
  for (std::size_t k = coefficients.size(); k-- > 0;) sum = sum * temperature + coefficients[k];
  return sum;
}

ModelFile without_calibration(ModelFile file) {
  std::vector<ModelEffect>& effects = file.model.effects;
  for (std::size_t i = effects.size(); i-- > 0;) {
    if (effects[i].id != calibration_id || effects[i].is_formula()) continue;
    effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(i));
    if (i < file.fits.size()) file.fits.erase(file.fits.begin() + static_cast<std::ptrdiff_t>(i));
  }
  file.covariance = without_correction(file.covariance);
  return file;
}

ModelFile with_calibration(ModelFile file, const std::vector<double>& coefficients,
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

  // Pressure and temperature are fitted apart: their errors are not known to go together.
  Covariance& all = file.covariance;
  const std::size_t before = all.parameters.size();
  for (std::vector<double>& row : all.matrix) row.resize(before + coefficients.size(), 0.0);
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    all.parameters.push_back(name_of_coefficient(i));
    std::vector<double>& row = all.matrix.emplace_back(before, 0.0);
    row.insert(row.end(), covariance[i].begin(), covariance[i].end());
  }
  return file;
}

}  // namespace pcor
