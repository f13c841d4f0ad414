#include <gtest/gtest.h>
#include <pcor/physics/constants.hpp>

#include <cmath>

namespace c = pcor::constants;

// The derived values are quoted to the digits of their sources; half a unit of the last digit is allowed.

TEST(Constants, UniversalGasConstantIsThatOfTheExactSi) {
  // CODATA 2018: R = N_A k, both exact since 2019; 8 digits are tabulated.
  EXPECT_NEAR(c::universal_gas_constant, 6.02214076e26 * 1.380649e-23, 2e-7);
}

TEST(Constants, GasConstantOfDryAir) {
  // ISO 2533 gives 287.05287 with R* of 1973; the molar mass 28.9637 here is 2.4e-5 lower, R* 1.7e-5 higher.
  EXPECT_NEAR(c::gas_constant_dry_air, 287.05287, 0.013);
  EXPECT_NEAR(c::gas_constant_dry_air, 287.0649, 5e-5);
}

TEST(Constants, GasConstantOfWaterVapour) {
  // IAPWS-95: 461.51805 J/(kg K) with the gas constant of 1986.
  EXPECT_NEAR(c::gas_constant_water_vapor, 461.51805, 0.006);
}

TEST(Constants, RatioOfTheMolarMasses) {
  // NCAR's Ranadu prints 0.62199, cut from 0.621996.
  EXPECT_NEAR(c::molar_mass_ratio, 0.62199, 1e-5);
  EXPECT_NEAR(c::molar_mass_ratio, c::gas_constant_dry_air / c::gas_constant_water_vapor, 1e-15);
}

TEST(Constants, SpecificHeatsOfDryAirEqualADiatomicGas) {
  // Real air at 300 K: c_p = 1005.7 J/(kg K) and gamma = 1.4017 (NIST); vibration and real gas add 0.1 %.
  EXPECT_NEAR(c::specific_heat_pressure_dry_air, 1005.7, 1.1);
  EXPECT_NEAR(c::specific_heat_pressure_dry_air / c::specific_heat_volume_dry_air, 1.4, 1e-15);
  EXPECT_NEAR(c::specific_heat_pressure_dry_air - c::specific_heat_volume_dry_air, c::gas_constant_dry_air,
              1e-12);
}

TEST(Constants, AFullTurnIsTwoPi) { EXPECT_DOUBLE_EQ(360 * c::radians_per_degree, 8 * std::atan(1.0)); }

TEST(Constants, WaterFreezesTenMillikelvinBelowItsTriplePoint) {
  EXPECT_DOUBLE_EQ(c::ice_point, 273.16 - 0.01);
}
