#include <gmock/gmock.h>
#include <pcor/residuals/reference.hpp>

#include <cmath>
#include <vector>

#include "support/isothermal_air.hpp"

using pcor::ModelDefinition;
using pcor::Quantity;

namespace {

using Effects = std::vector<std::pair<std::string, double>>;

/// Two systems in one air; the second has a static defect and independent errors.
pcor::FlightSamples two_system_flight() {
  std::vector<double> height;
  std::vector<double> airspeed;
  for (int i = 0; i < 1800; ++i) {
    height.push_back(3000.0 + 2000.0 * std::sin(i / 300.0));
    airspeed.push_back(130.0 + 20.0 * std::sin(i / 70.0));
  }
  pcor::FlightSamples samples = made::air_flight(height, airspeed);
  samples.reference.roles = {Quantity::static_pressure, Quantity::dynamic_pressure};
  samples.reference.columns = {samples.model.columns[0], samples.model.columns[1]};
  for (double& p : samples.reference.columns[0].second) p -= 2.0;
  for (double& q : samples.reference.columns[1].second) q += 2.0;
  return samples;
}

ModelDefinition other(const Effects& effects = {}) {
  ModelDefinition file = made::air_model(effects);
  file.variables.erase(Quantity::ambient_temperature);
  return file;
}

std::vector<double> total_pressure_residuals(const Effects& of_model, const Effects& of_other) {
  return made::residuals_of(two_system_flight(), made::air_model(of_model),
                            *pcor::total_pressure_reference(other(of_other)));
}

}  // namespace

TEST(TotalPressure, IsIndependentOfStaticDefects) {
  for (const auto& residual :
       {total_pressure_residuals({}, {}),
        total_pressure_residuals({{"static-constant", 0.01}}, {{"static-qp", 0.05}})}) {
    for (const double value : residual) ASSERT_NEAR(value, 0.0, 1e-9);
  }
}

TEST(TotalPressure, DetectsTheOffsetOfEachTransducer) {
  // The effects take the zero off the reading.
  for (const std::string zero : {"psfd-bias", "qcf-zero"}) {
    for (const double value : total_pressure_residuals({{zero, 0.5}}, {}))
      ASSERT_NEAR(value, 0.5, 1e-9) << zero;
    for (const double value : total_pressure_residuals({}, {{zero, 0.5}}))
      ASSERT_NEAR(value, -0.5, 1e-9) << zero;
  }
}

TEST(TotalPressure, ResidualDerivativesAreCorrect) {
  // Linear: differences are exact to rounding, 1e-13 of 1000 hPa over the step.
  EXPECT_LT(made::derivative_error(two_system_flight(), made::air_model({{"qcf-gain", 0.01}}),
                                   *pcor::total_pressure_reference(other()), 1e-3),
            1e-6);
}

TEST(TotalPressure, ModelCanBeFittedAndReplaced) {
  const auto reference = pcor::total_pressure_reference(other({{"qcf-zero", 0.1}}));
  EXPECT_FALSE(reference->is_static_pressure());
  EXPECT_EQ(reference->model()->model.effects.size(), 1U);
  const auto exchanged = reference->with_model(other());
  EXPECT_TRUE(exchanged->model()->model.effects.empty());
  EXPECT_FALSE(exchanged->is_static_pressure());
}

TEST(TotalPressure, TwoVariableReferenceHasNoLaw) {
  const auto reference = pcor::read_reference("total:PSFRD+QCFR", made::air_model());
  EXPECT_EQ(reference->name(), "total:PSFRD+QCFR");
  EXPECT_THAT(reference->variables(), testing::UnorderedElementsAre("PSFRD", "QCFR"));
  EXPECT_TRUE(reference->model()->model.effects.empty());
}
