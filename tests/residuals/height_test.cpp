#include <gmock/gmock.h>
#include <pcor/base/error.hpp>

#include <cmath>
#include <memory>
#include <vector>

#include "support/isothermal_air.hpp"

using pcor::Quantity;

namespace {

/// Climbs at 5 m/s.
pcor::FlightSamples climb() {
  std::vector<double> height;
  for (int i = 0; i < 1800; ++i) height.push_back(1000.0 + 5.0 * i);
  pcor::FlightSamples flight = made::air_flight(height, std::vector<double>(height.size(), 130.0));
  flight.reference.columns = {{Quantity::altitude, height}};
  return flight;
}

std::vector<double> height_residuals(const pcor::FlightSamples& flight, const pcor::ModelDefinition& model) {
  return made::residuals_of(flight, model, *pcor::height_reference(model));
}

/// p g/(R T), hPa/m.
double pressure_of_height(double pressure) {
  return pressure * pcor::constants::standard_gravity /
         (pcor::constants::gas_constant_dry_air * made::air_temperature);
}

}  // namespace

TEST(Height, ResidualOfTheHydrostaticEquationIsZero) {
  const std::vector<double> residual = height_residuals(climb(), made::air_model());
  for (std::size_t i = 30; i + 30 < residual.size(); ++i) ASSERT_NEAR(residual[i], 0.0, 1e-9) << i;
  EXPECT_TRUE(std::isnan(residual[29])) << "half a minute is needed on either side";
}

TEST(Height, DetectsThermometerBiasInEveryClimb) {
  // 300 m in a minute: the warm model takes them for 300 m (1 + 1/260).
  pcor::FlightSamples flight = climb();
  for (double& temperature : flight.model.columns[2].second) temperature += 1.0;
  const std::vector<double> residual = height_residuals(flight, made::air_model());
  const std::vector<double>& p = *flight.model.find(Quantity::static_pressure);
  for (const std::size_t i : {200U, 900U, 1500U}) {
    const double expected = pressure_of_height(p[i]) * 300.0 / (made::air_temperature + 1.0);
    EXPECT_NEAR(residual[i], expected, 1e-6) << i;
  }
}

TEST(Height, IsInsensitiveToAProportionalPressureDefect) {
  for (const double value : height_residuals(climb(), made::air_model({{"static-constant", 0.01}}))) {
    if (std::isnan(value)) continue;
    ASSERT_NEAR(value, 0.0, 1e-9);
  }
}

TEST(Height, StaticPressureOffsetGrowsWithHeight) {
  // Subtracting one hPa from every reading makes a climb larger, by p d(1/p) in a minute: rho g 300 m / p.
  const pcor::FlightSamples flight = climb();
  const std::vector<double> residual = height_residuals(flight, made::air_model({{"psfd-bias", 1.0}}));
  const std::vector<double>& p = *flight.model.find(Quantity::static_pressure);
  for (const std::size_t i : {200U, 900U, 1500U})
    EXPECT_NEAR(residual[i], pressure_of_height(p[i]) * 300.0 / p[i], 5e-4) << "second order; " << i;
}

TEST(Height, ResidualDerivativesAreCorrect) {
  const pcor::ModelDefinition model = made::air_model({{"psfd-bias", 0.3}});
  // Centred differences of a step of 1e-3 hPa are right to 1e-9 / 1e-3.
  EXPECT_LT(made::derivative_error(climb(), model, *pcor::height_reference(model), 1e-3), 1e-5);
}

// Otherwise a fit would shrink the residual by a coefficient to which the heights are insensitive.
TEST(Height, DerivativesExcludeHeightNoise) {
  auto flight = std::make_shared<pcor::FlightSamples>(climb());
  for (std::size_t i = 0; i < flight->time.size(); ++i)
    flight->reference.columns[0].second[i] += 3.0 * std::sin(0.7 * static_cast<double>(i));
  const pcor::ModelDefinition model = made::air_model({{"static-constant", 0.01}});
  const pcor::Residuals residuals(flight, model, *pcor::height_reference(model));
  const std::size_t sample = 900;
  double residual = 0.0;
  double derivative = 0.0;
  residuals.evaluate({sample}, residuals.parameters().data(), {0}, &residual, &derivative);
  EXPECT_GT(std::abs(residual), 0.01);
  EXPECT_NEAR(derivative, 0.0, 1e-9);
}

TEST(Height, GapsAndMissingValuesInterruptTheResidual) {
  pcor::FlightSamples flight = climb();
  flight.model.columns[2].second[900] = std::nan("");
  for (std::size_t i = 1200; i < flight.time.size(); ++i) flight.time[i] += 100.0;
  const std::vector<double> residual = height_residuals(flight, made::air_model());
  for (const std::size_t i : {870U, 900U, 930U, 1171U, 1229U}) EXPECT_TRUE(std::isnan(residual[i])) << i;
  for (const std::size_t i : {869U, 931U, 1169U, 1230U}) EXPECT_FALSE(std::isnan(residual[i])) << i;
}

TEST(Height, RequiresATemperature) {
  pcor::FlightSamples flight = climb();
  flight.model.columns.pop_back();
  flight.model.roles.pop_back();
  EXPECT_THROW(height_residuals(flight, made::air_model()), pcor::Error);
}
