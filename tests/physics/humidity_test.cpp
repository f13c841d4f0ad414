#include <gtest/gtest.h>
#include <pcor/physics/humidity.hpp>
#include "support/constants.hpp"

#include <cmath>

namespace c = pcor::constants;
using pcor::enhancement_factor;
using pcor::saturation_vapor_pressure;
using pcor::vapor_pressure_from_dew_point;
using pcor::vapor_pressure_over_ice;
using pcor::vapor_pressure_over_water;
using pcor::test::missing;

namespace {

constexpr double triple_point = 273.16;  // K

// Latent heat, J/kg, that the Clausius-Clapeyron equation finds in a vapour pressure: L = R_w T^2 dln(e)/dT.
template <class VaporPressure>
double latent_heat(const VaporPressure& e, double T) {
  constexpr double h = 0.01;  // K; the third derivative of ln e leaves an error of 1e-9 relative
  return c::gas_constant_water_vapor * T * T * (std::log(e(T + h)) - std::log(e(T - h))) / (2 * h);
}

}  // namespace

TEST(VaporPressure, AgreesWithTheTableOfMurphyAndKoop) {
  // Murphy and Koop (2005), the values for checking code, Pa. Half a unit of the last printed digit.
  struct Row {
    double temperature, ice, water, ice_digit, water_digit;
  };
  for (const Row& row :
       {Row{150.0, 6.106e-6, 1.562e-5, 1e-9, 1e-8}, Row{180.0, 0.0053975, 0.011239, 1e-7, 1e-6},
        Row{210.0, 0.70202, 1.2335, 1e-5, 1e-4}, Row{240.0, 27.272, 37.667, 1e-3, 1e-3},
        Row{273.15, 611.154, 611.213, 1e-3, 1e-3}, Row{273.16, 611.657, 611.657, 1e-3, 1e-3}}) {
    EXPECT_NEAR(100 * vapor_pressure_over_ice(row.temperature), row.ice, 0.5 * row.ice_digit)
        << row.temperature;
    EXPECT_NEAR(100 * vapor_pressure_over_water(row.temperature), row.water, 0.5 * row.water_digit)
        << row.temperature;
  }
  EXPECT_NEAR(100 * vapor_pressure_over_water(300.0), 3536.8, 0.05);
}

TEST(VaporPressure, AgreesWithSteamTablesForWarmWater) {
  // IAPWS-95 at 20 and 50 deg C. The source states 0.05 %.
  EXPECT_NEAR(vapor_pressure_over_water(293.15), 23.393, 0.0005 * 23.4);
  EXPECT_NEAR(vapor_pressure_over_water(323.15), 123.52, 0.0005 * 123.5);
}

TEST(VaporPressure, SlopeFollowsTheLatentHeatOfVaporisation) {
  // IAPWS-95 at 0.01, 20 and 40 deg C. The ideal gas in Clausius-Clapeyron makes 0.1 to 0.3 %.
  EXPECT_NEAR(latent_heat(vapor_pressure_over_water<double>, 273.16), 2.5009e6, 0.003 * 2.5e6);
  EXPECT_NEAR(latent_heat(vapor_pressure_over_water<double>, 293.15), 2.4535e6, 0.003 * 2.5e6);
  EXPECT_NEAR(latent_heat(vapor_pressure_over_water<double>, 313.15), 2.4060e6, 0.004 * 2.5e6);
}

TEST(VaporPressure, SlopeFollowsTheLatentHeatOfSublimation) {
  // Murphy and Koop (2005) eq. 5, J/mol, from calorimetry; they state that their fit loses 0.025 %.
  for (double T = 150; T <= 273; T += 3) {
    const double calorimetric =
        46782.5 + 35.8925 * T - 0.07414 * T * T + 541.5 * std::exp(-(T / 123.75) * (T / 123.75));
    const double clapeyron = latent_heat(vapor_pressure_over_ice<double>, T) * c::molar_mass_water / 1000;
    EXPECT_NEAR(clapeyron, calorimetric, 0.001 * calorimetric) << T;
  }
}

TEST(VaporPressure, IsEqualOverIceAndWaterAtTheTriplePoint) {
  EXPECT_NEAR(vapor_pressure_over_ice(triple_point) / vapor_pressure_over_water(triple_point), 1.0, 1e-7);
}

TEST(VaporPressure, IsLowerOverIceThanOverSupercooledWater) {
  for (double T = 124; T < triple_point; T += 0.5)
    EXPECT_LT(vapor_pressure_over_ice(T), vapor_pressure_over_water(T)) << T;
}

TEST(VaporPressure, RisesWithTemperature) {
  for (double T = 124; T < 331; T += 0.5) {
    EXPECT_LT(vapor_pressure_over_water(T), vapor_pressure_over_water(T + 0.5)) << T;
    EXPECT_LT(saturation_vapor_pressure(T), saturation_vapor_pressure(T + 0.5)) << T;
  }
}

TEST(VaporPressure, MirrorSaturationChangesFromIceToWaterAtIcePoint) {
  // A compiler may compute one of the two in advance, with other rounding.
  EXPECT_NEAR(saturation_vapor_pressure(273.14), vapor_pressure_over_ice(273.14), 1e-12);
  EXPECT_NEAR(saturation_vapor_pressure(273.15), vapor_pressure_over_water(273.15), 1e-12);
  // 0.01 K below the triple point the phases differ by 1e-4: that is the whole step.
  EXPECT_NEAR(vapor_pressure_over_ice(c::ice_point) / vapor_pressure_over_water(c::ice_point), 1.0, 1.1e-4);
}

TEST(VaporPressure, MissingOrNegativeTemperatureGivesNan) {
  for (const double T : {missing, -10.0}) {
    EXPECT_TRUE(std::isnan(vapor_pressure_over_water(T))) << T;
    EXPECT_TRUE(std::isnan(vapor_pressure_over_ice(T))) << T;
    EXPECT_TRUE(std::isnan(saturation_vapor_pressure(T))) << T;
  }
  EXPECT_TRUE(std::isnan(vapor_pressure_over_water(0.0)));
  EXPECT_EQ(vapor_pressure_over_ice(0.0), 0.0) << "nothing evaporates from ice at 0 K";
}

TEST(VaporPressure, LowerBoundIsBelowSaturation) {
  // The quick bound must never pass over saturated air, from the coldest to the warmest of the domain.
  for (double T = 100; T <= 400; T += 0.1)
    EXPECT_LE(pcor::vapor_pressure_below_saturation(T), vapor_pressure_over_water(T)) << T;
  // Nor be so low that it is of no use: the printed digits.
  for (double T = 190; T <= 325; T += 0.1) {
    const double part = pcor::vapor_pressure_below_saturation(T) / vapor_pressure_over_water(T);
    EXPECT_GT(part, 0.9969) << T;
    EXPECT_LT(part, 0.99993) << T;
  }
  EXPECT_EQ(pcor::vapor_pressure_below_saturation(50.0), 0.0);
  EXPECT_TRUE(std::isnan(pcor::vapor_pressure_below_saturation(missing)));
}

TEST(EnhancementFactor, IsFourPerMilleAtTheSurface) {
  // Smithsonian tables, and Buck (1981): 1.0040 at 1000 hPa and 0 deg C, 1.0045 at 25 deg C; they differ
  // among themselves by 3e-4.
  EXPECT_NEAR(enhancement_factor(273.15, 1000.0), 1.0040, 4e-4);
  EXPECT_NEAR(enhancement_factor(298.15, 1000.0), 1.0045, 4e-4);
}

TEST(EnhancementFactor, IsOneAtZeroPressure) {
  EXPECT_EQ(enhancement_factor(250.0, 0.0), 1.0);
  EXPECT_NEAR(enhancement_factor(250.0, 600.0) - 1, 2 * (enhancement_factor(250.0, 300.0) - 1), 1e-15);
}

TEST(DewPoint, EqualsTheTemperatureOfSaturatedAir) {
  const double T = 285.0, p = 900.0;
  EXPECT_DOUBLE_EQ(vapor_pressure_from_dew_point(T, p),
                   vapor_pressure_over_water(T) * enhancement_factor(T, p));
  EXPECT_LT(vapor_pressure_from_dew_point(T - 1, p), vapor_pressure_from_dew_point(T, p));
  EXPECT_TRUE(std::isnan(vapor_pressure_from_dew_point(missing, p)));
  EXPECT_TRUE(std::isnan(vapor_pressure_from_dew_point(T, missing)));
}
