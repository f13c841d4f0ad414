#include <gtest/gtest.h>
#include <pcor/physics/hydrostatic.hpp>
#include <pcor/physics/standard_atmosphere.hpp>
#include "support/archetype.hpp"

#include <cmath>
#include <limits>

using archetype::Physics;
using pcor::hydrostatic_step;
using pcor::standard_pressure;
using pcor::standard_temperature;

namespace {

/// The gas constant of the US Standard Atmosphere 1976, R*/M0: not that of `constants.hpp`.
constexpr double standard_gas_constant = 8314.32 / 28.9644;

/// The height that the hydrostatic equation finds in the standard atmosphere, from 0 to `top`, climbing at
/// 5 m/s with one sample a second.
double climbed(double top, double gas_constant) {
  constexpr double step = 5.0;  // m
  double height = 0.0;
  for (double below = 0.0; below < top; below += step) {
    const double above = below + step;
    height += hydrostatic_step(standard_pressure(below), standard_pressure(above), gas_constant) * 0.5 *
              (standard_temperature(below) + standard_temperature(above));
  }
  return height;
}

}  // namespace

TEST(HydrostaticStep, StepsSumToTheStandardHeight) {
  // 0.1 m is required. The mean of both ends errs by (step/scale height)^2 of a step: 1e-5 m in 20 km.
  EXPECT_NEAR(climbed(20000.0, standard_gas_constant), 20000.0, 1e-3);
  EXPECT_NEAR(climbed(11000.0, standard_gas_constant), 11000.0, 1e-3);
}

TEST(HydrostaticStep, UsesTheGivenGasConstant) {
  // With the gas constant of today's air the standard's pressures give what the constants differ by.
  const double longer = pcor::constants::gas_constant_dry_air / standard_gas_constant;
  EXPECT_NEAR(climbed(20000.0, pcor::constants::gas_constant_dry_air), 20000.0 * longer, 1e-3);
  EXPECT_GT(std::abs(longer - 1.0) * 20000.0, 0.1);
}

TEST(HydrostaticStep, IsExactInIsothermalAir) {
  // The hypsometric equation for one step of any size.
  EXPECT_NEAR(hydrostatic_step(1000.0, 1000.0 / std::exp(1.0), 287.0) * 250.0, 287.0 * 250.0 / 9.80665, 1e-9);
  // Holton, chapter 1: a scale height of 7.4 km at 253 K.
  EXPECT_NEAR(hydrostatic_step(std::exp(1.0), 1.0, 287.0) * 253.0, 7400.0, 10.0);
}

TEST(HydrostaticStep, FirstOrderFormUnderestimatesTheHeight) {
  // R_a dp/(g p) with the pressure at the end of the step: over one scale height H = R T/g0 in N steps in ln
  // p it is wrong by H/(2N). 2000 steps: 1.8 m for T = 250 K.
  constexpr int steps = 2000;
  constexpr double temperature = 250.0, gas_constant = 287.0;
  const double scale_height = gas_constant * temperature / 9.80665;
  double first_order = 0.0;
  double exact = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double before = std::exp(-static_cast<double>(i) / steps);
    const double after = std::exp(-static_cast<double>(i + 1) / steps);
    first_order += -gas_constant * temperature / 9.80665 * (after - before) / after;
    exact += hydrostatic_step(before, after, gas_constant) * temperature;
  }
  EXPECT_NEAR(exact, scale_height, 1e-8);
  EXPECT_NEAR(std::abs(first_order - exact), scale_height / (2.0 * steps), 0.002);
  EXPECT_GT(std::abs(first_order - exact), 1.5);
}

TEST(HydrostaticStep, IsPositiveUpwardsAndAntisymmetric) {
  EXPECT_GT(hydrostatic_step(700.0, 699.0, 287.0), 0.0);
  // ln(1 - x) keeps the rounding of the ratio: 1e-16 times R_d/g0.
  EXPECT_NEAR(hydrostatic_step(700.0, 699.0, 287.0), -hydrostatic_step(699.0, 700.0, 287.0), 1e-14);
  EXPECT_EQ(hydrostatic_step(700.0, 700.0, 287.0), 0.0);
}

TEST(HydrostaticStep, IsIndependentOfThePressureUnit) {
  EXPECT_NEAR(hydrostatic_step(70000.0, 69900.0, 287.0), hydrostatic_step(700.0, 699.0, 287.0), 1e-14);
}

TEST(HydrostaticStep, ImpossiblePressureGivesNoFiniteValue) {
  EXPECT_FALSE(std::isfinite(hydrostatic_step(0.0, 699.0, 287.0)));
  EXPECT_FALSE(std::isfinite(hydrostatic_step(700.0, 0.0, 287.0)));
  EXPECT_TRUE(std::isnan(hydrostatic_step(700.0, -1.0, 287.0)));
  EXPECT_TRUE(std::isnan(hydrostatic_step(std::numeric_limits<double>::quiet_NaN(), 699.0, 287.0)));
}

TEST(HydrostaticStep, CompilesForAnotherScalarType) {
  EXPECT_EQ(hydrostatic_step(Physics(700.0), Physics(695.0), Physics(287.5)).value(),
            hydrostatic_step(700.0, 695.0, 287.5));
}
