#pragma once

#include <pcor/physics/air_data.hpp>
#include <pcor/physics/constants.hpp>
#include <pcor/residuals/residuals.hpp>

#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// Flights in memory through isothermal air, with exact sensors. Residuals against heights and speeds have
/// simple closed forms.
namespace made {

inline constexpr double air_temperature = 260.0;  // K

/// Model of the pair PSFD/QCF with ambient temperature and effects of the catalogue: id, first parameter.
inline pcor::ModelDefinition air_model(const std::vector<std::pair<std::string, double>>& effects = {}) {
  pcor::ModelDefinition file;
  file.model.name = "made";
  file.variables = {{pcor::Quantity::static_pressure, "PSFD"},
                    {pcor::Quantity::dynamic_pressure, "QCF"},
                    {pcor::Quantity::ambient_temperature, "ATX"}};
  for (const auto& [id, value] : effects) {
    file.model.effects.push_back(pcor::neutral_effect(id));
    file.model.effects.back().parameters.front() = value;
  }
  return file;
}

/// Flight at 1 Hz whose pressures are computed from heights and airspeeds.
/// @param height geopotential, m @param airspeed m/s
inline pcor::FlightSamples air_flight(const std::vector<double>& height,
                                      const std::vector<double>& airspeed) {
  using pcor::Quantity;
  constexpr double scale_height =
      pcor::constants::gas_constant_dry_air * air_temperature / pcor::constants::standard_gravity;
  pcor::FlightSamples samples;
  samples.name = "made";
  std::vector<double> p;
  std::vector<double> q;
  for (std::size_t i = 0; i < height.size(); ++i) {
    p.push_back(1000.0 * std::exp(-height[i] / scale_height));
    const double mach =
        airspeed[i] / std::sqrt(1.4 * pcor::constants::gas_constant_dry_air * air_temperature);
    q.push_back(p.back() * (std::pow(1.0 + 0.2 * mach * mach, 3.5) - 1.0));
    samples.time.push_back(1321560000.0 + static_cast<double>(i));
  }
  samples.model.roles = {Quantity::static_pressure, Quantity::dynamic_pressure,
                         Quantity::ambient_temperature};
  samples.model.columns = {
      {Quantity::static_pressure, std::move(p)},
      {Quantity::dynamic_pressure, std::move(q)},
      {Quantity::ambient_temperature, std::vector<double>(height.size(), air_temperature)}};
  samples.motion.time = samples.time;
  samples.motion.airspeed = airspeed;
  return samples;
}

/// Residuals of a flight, with the parameters of the model.
inline std::vector<double> residuals_of(const pcor::FlightSamples& flight, const pcor::ModelDefinition& model,
                                        const pcor::Reference& reference) {
  const pcor::Residuals residuals(std::make_shared<const pcor::FlightSamples>(flight), model, reference);
  return residuals.values(residuals.parameters().data());
}

/// Largest difference between the derivatives with respect to the first parameter and finite differences,
/// divided by the largest finite difference. Evaluates every tenth sample, so it also tests the evaluation of
/// a subset.
inline double derivative_error(const pcor::FlightSamples& flight, const pcor::ModelDefinition& model,
                               const pcor::Reference& reference, double step) {
  const pcor::Residuals residuals(std::make_shared<const pcor::FlightSamples>(flight), model, reference);
  std::vector<std::size_t> indices;
  for (std::size_t i = 500; i + 500 < residuals.size(); i += 10) indices.push_back(i);
  std::vector<double> parameters = residuals.parameters();
  std::vector<double> values(indices.size());
  std::vector<double> derivatives(indices.size());
  residuals.evaluate(indices, parameters.data(), {0}, values.data(), derivatives.data());
  parameters[0] += step;
  const std::vector<double> above = residuals.values(parameters.data());
  parameters[0] -= 2.0 * step;
  const std::vector<double> below = residuals.values(parameters.data());
  double error = 0.0;
  double largest = 0.0;
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const double difference = (above[indices[k]] - below[indices[k]]) / (2.0 * step);
    error = std::max(error, std::abs(derivatives[k] - difference));
    largest = std::max(largest, std::abs(difference));
  }
  return error / largest;
}

}  // namespace made
