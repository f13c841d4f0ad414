#pragma once

#include <pcor/residuals/residuals.hpp>

#include <cmath>
#include <cstddef>
#include <memory>
#include <random>
#include <string>
#include <vector>

/// Flights in memory with known delta-p, a reference pressure and correlated noise.
namespace made {

struct Plan {
  std::size_t samples = 3600;
  unsigned seed = 1;
  double noise = 0.3;         ///< hPa
  double memory = 0.7;        ///< correlation of the noise of consecutive samples
  double outliers = 0.0;      ///< share of the samples
  double outlier_size = 5.0;  ///< hPa
  /// True delta-p, hPa, as a function of the pressures, hPa, the ratio ADIFR/QCR, and the time, s.
  double (*defect)(double p, double q, double ratio, double time) = nullptr;
};

/// Equation 18 of Cooper (2012) for PSFD.
inline double equation_18(double p, double q, double ratio, double) {
  return p * (0.004127875 + 0.021279816 * ratio) + 0.030849643 * q;
}

/// Flight at 1 Hz with uncorrelated changes of height, speed and angle of attack.
inline pcor::FlightSamples flight(const Plan& plan) {
  pcor::FlightSamples samples;
  samples.name = "made-" + std::to_string(plan.seed);
  samples.aircraft = "N130AR";
  std::mt19937_64 engine(plan.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  std::vector<double> reference;
  std::vector<double> p;
  std::vector<double> q;
  std::vector<double> adifr;
  std::vector<double> qcr;
  double noise = normal(engine);
  for (std::size_t i = 0; i < plan.samples; ++i) {
    const auto t = static_cast<double>(i);
    p.push_back(700.0 + 150.0 * std::sin(t / 900.0 + plan.seed));
    q.push_back(65.0 + 20.0 * std::sin(t / 170.0));
    qcr.push_back(q.back());
    const double ratio = -0.2 + 0.12 * std::sin(t / 37.0) + 0.05 * std::sin(t / 400.0);
    adifr.push_back(ratio * qcr.back());
    const double hit = uniform(engine) < plan.outliers ? plan.outlier_size : 0.0;
    samples.time.push_back(1321560000.0 + t);
    reference.push_back(p.back() + plan.defect(p.back(), q.back(), ratio, t) + plan.noise * noise + hit);
    noise = plan.memory * noise + std::sqrt(1.0 - plan.memory * plan.memory) * normal(engine);
  }
  using pcor::Quantity;
  samples.model.roles = {Quantity::static_pressure, Quantity::dynamic_pressure,
                         Quantity::radome_dynamic_pressure, Quantity::attack_differential_pressure};
  samples.model.columns = {{Quantity::static_pressure, std::move(p)},
                           {Quantity::dynamic_pressure, std::move(q)},
                           {Quantity::radome_dynamic_pressure, std::move(qcr)},
                           {Quantity::attack_differential_pressure, std::move(adifr)}};
  samples.reference.columns = {{Quantity::corrected_static_pressure, std::move(reference)}};
  samples.motion.time = samples.time;
  return samples;
}

inline std::shared_ptr<const pcor::FlightSamples> shared(const Plan& plan) {
  return std::make_shared<const pcor::FlightSamples>(flight(plan));
}

/// Model of the given effects with neutral coefficients.
inline pcor::ModelDefinition model(const std::vector<std::string>& effects) {
  pcor::ModelDefinition file;
  file.model.name = "made";
  file.variables = {{pcor::Quantity::static_pressure, "PSFD"},
                    {pcor::Quantity::dynamic_pressure, "QCF"},
                    {pcor::Quantity::radome_dynamic_pressure, "QCR"},
                    {pcor::Quantity::attack_differential_pressure, "ADIFR"}};
  for (const std::string& id : effects) file.model.effects.push_back(pcor::neutral_effect(id));
  return file;
}

inline pcor::References pressure_reference() { return {pcor::pressure_reference("PS_A")}; }

/// Reference pressure of a flight from `flight`, hPa.
inline std::vector<double>& reference_pressure(pcor::FlightSamples& samples) {
  return samples.reference.columns.front().second;
}

}  // namespace made
