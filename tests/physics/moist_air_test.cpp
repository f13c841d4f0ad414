#include <gtest/gtest.h>
#include <pcor/physics/moist_air.hpp>

#include <cmath>
#include <limits>

namespace c = pcor::constants;
using pcor::moist_air;
using pcor::MoistAir;

namespace {

// e/p up to 0.1: three times what the tropical boundary layer holds.
constexpr double driest = 0.0, wettest = 0.1, step = 0.001;

// The same air as a mixture by mass: Dalton's law gives the densities, Gibbs' law the specific heats.
struct Mixture {
  explicit Mixture(double e_over_p) {
    constexpr double pressure = 1000.0, temperature = 280.0;  // they cancel
    const double vapor = e_over_p * pressure / (c::gas_constant_water_vapor * temperature);
    const double dry = (1 - e_over_p) * pressure / (c::gas_constant_dry_air * temperature);
    const double x = vapor / (vapor + dry);
    R = (1 - x) * c::gas_constant_dry_air + x * c::gas_constant_water_vapor;
    cv = (1 - x) * 2.5 * c::gas_constant_dry_air + x * 3.0 * c::gas_constant_water_vapor;
    cp = (1 - x) * 3.5 * c::gas_constant_dry_air + x * 4.0 * c::gas_constant_water_vapor;
  }
  double R, cv, cp;
};

}  // namespace

TEST(MoistAir, SpecificHeatsDifferByTheGasConstant) {
  // Mayer's relation is exact, so only the rounding of some ten operations on c_p = 3.5 R remains.
  for (double h = driest; h <= wettest; h += step) {
    const MoistAir<double> air = moist_air(h);
    EXPECT_NEAR((air.specific_heat_pressure - air.specific_heat_volume) / air.gas_constant, 1.0, 2e-15) << h;
  }
}

TEST(MoistAir, EqualsTheMixtureByMass) {
  // A few roundings on each side.
  for (double h = driest; h <= wettest; h += step) {
    const MoistAir<double> air = moist_air(h);
    const Mixture mixture(h);
    EXPECT_NEAR(air.gas_constant / mixture.R, 1.0, 1e-15) << h;
    EXPECT_NEAR(air.specific_heat_volume / mixture.cv, 1.0, 1e-15) << h;
    EXPECT_NEAR(air.specific_heat_pressure / mixture.cp, 1.0, 1e-15) << h;
  }
}

TEST(MoistAir, RatiosAgreeWithTheSpecificHeats) {
  for (double h = driest; h <= wettest; h += step) {
    const MoistAir<double> air = moist_air(h);
    EXPECT_NEAR(air.heat_capacity_ratio, air.specific_heat_pressure / air.specific_heat_volume, 1e-15) << h;
    EXPECT_NEAR(air.specific_heat_pressure / air.gas_constant * air.poisson_exponent, 1.0, 1e-15) << h;
  }
}

TEST(MoistAir, WithoutVapourIsDry) {
  const MoistAir<double> air = pcor::dry_air<double>();
  EXPECT_EQ(air.gas_constant, c::gas_constant_dry_air);
  EXPECT_EQ(air.specific_heat_volume, c::specific_heat_volume_dry_air);
  EXPECT_EQ(air.specific_heat_pressure, c::specific_heat_pressure_dry_air);
  EXPECT_EQ(air.heat_capacity_ratio, 1.4);
  EXPECT_EQ(air.poisson_exponent, 2.0 / 7.0);
}

TEST(MoistAir, PureVapourHasSixDegreesOfFreedom) {
  const MoistAir<double> steam = moist_air(1.0);
  EXPECT_NEAR(steam.gas_constant / c::gas_constant_water_vapor, 1.0, 1e-15);
  EXPECT_NEAR(steam.specific_heat_volume / c::gas_constant_water_vapor, 3.0, 1e-14);
  EXPECT_NEAR(steam.specific_heat_pressure / c::gas_constant_water_vapor, 4.0, 1e-14);
  EXPECT_NEAR(steam.heat_capacity_ratio, 4.0 / 3.0, 1e-15);
}

TEST(MoistAir, VapourLowersGammaAndRaisesTheGasConstant) {
  for (double h = driest; h < wettest; h += step) {
    const MoistAir<double> drier = moist_air(h), moister = moist_air(h + step);
    EXPECT_LT(moister.heat_capacity_ratio, drier.heat_capacity_ratio) << h;
    EXPECT_LT(moister.poisson_exponent, drier.poisson_exponent) << h;
    EXPECT_GT(moister.gas_constant, drier.gas_constant) << h;
    EXPECT_GT(moister.specific_heat_pressure, drier.specific_heat_pressure) << h;
  }
}

TEST(MoistAir, GasConstantAgreesWithVirtualTemperature) {
  // The meteorologist's R_a/R_d = (1 + r/eps)/(1 + r), with the mixing ratio r; rounding only.
  for (double h = driest; h <= wettest; h += step) {
    const double r = c::molar_mass_ratio * h / (1 - h);
    EXPECT_NEAR(moist_air(h).gas_constant / c::gas_constant_dry_air, (1 + r / c::molar_mass_ratio) / (1 + r),
                1e-15);
  }
}

TEST(MoistAir, MissingHumidityGivesNanConstants) {
  const MoistAir<double> air = moist_air(std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(std::isnan(air.gas_constant));
  EXPECT_TRUE(std::isnan(air.specific_heat_volume));
  EXPECT_TRUE(std::isnan(air.specific_heat_pressure));
  EXPECT_TRUE(std::isnan(air.heat_capacity_ratio));
  EXPECT_TRUE(std::isnan(air.poisson_exponent));
}
