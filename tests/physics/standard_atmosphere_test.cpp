#include <gtest/gtest.h>
#include <pcor/physics/standard_atmosphere.hpp>

#include <cmath>
#include <limits>

using pcor::pressure_altitude;
using pcor::standard_pressure;
using pcor::standard_temperature;

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

}  // namespace

TEST(StandardAtmosphere, AgreesWithTheTableAtGeopotentialHeights) {
  // US Standard Atmosphere 1976, table II; half of the fifth digit is at most 5e-5.
  const struct {
    double height, temperature, pressure;
  } rows[] = {{-5000.0, 320.65, 1776.9}, {0.0, 288.15, 1013.25},    {5000.0, 255.65, 540.20},
              {11000.0, 216.65, 226.32}, {20000.0, 216.65, 54.749}, {32000.0, 228.65, 8.6802},
              {47000.0, 270.65, 1.1091}, {51000.0, 270.65, .66939}, {71000.0, 214.65, .039564}};
  for (const auto& row : rows) {
    EXPECT_NEAR(standard_temperature(row.height), row.temperature, 1e-9) << row.height;
    EXPECT_NEAR(standard_pressure(row.height) / row.pressure, 1.0, 5e-5) << row.height;
  }
}

TEST(StandardAtmosphere, AgreesWithTheTableAtGeometricHeights) {
  // US Standard Atmosphere 1976, table I; its geopotential height is r z/(r + z) with r = 6356.766 km.
  const struct {
    double height, temperature, pressure;
  } rows[] = {{-1000.0, 294.651, 1139.3}, {1000.0, 281.651, 898.76},  {2000.0, 275.154, 795.01},
              {5000.0, 255.676, 540.48},  {10000.0, 223.252, 265.00}, {20000.0, 216.650, 55.293},
              {30000.0, 226.509, 11.970}, {40000.0, 250.350, 2.8714}, {50000.0, 270.650, .79779},
              {60000.0, 247.021, .21958}, {70000.0, 219.585, .052209}};
  for (const auto& row : rows) {
    const double geopotential = 6356766.0 * row.height / (6356766.0 + row.height);
    EXPECT_NEAR(standard_temperature(geopotential), row.temperature, 6e-4) << row.height;
    EXPECT_NEAR(standard_pressure(geopotential) / row.pressure, 1.0, 5e-5) << row.height;
  }
}

TEST(StandardAtmosphere, IsContinuous) {
  // The pressures at the bases are given; the layers below must lead to them.
  for (std::size_t i = 1; i < pcor::standard_layers.size(); ++i) {
    const double base = pcor::standard_layers[i].base;
    EXPECT_NEAR(standard_pressure(base * (1.0 - 1e-15)) / standard_pressure(base), 1.0, 1e-12) << base;
    EXPECT_NEAR(standard_temperature(base * (1.0 - 1e-15)), standard_temperature(base), 1e-9) << base;
  }
}

TEST(StandardAtmosphere, IsHydrostatic) {
  // dp/dH = -(g0 M0/R*) p/T, by a central difference over 2 m: it errs by (1 m/scale height)^2/6, 3e-9.
  for (double height = -4500.0; height < 84000.0; height += 1000.0) {
    const double slope = (standard_pressure(height + 1.0) - standard_pressure(height - 1.0)) / 2.0;
    EXPECT_NEAR(-slope * standard_temperature(height) / standard_pressure(height), 0.0341631947, 1e-9)
        << height;
  }
}

TEST(StandardAtmosphere, PressureAltitudeInvertsThePressure) {
  // Rounding of ln p: 1e-15 of 8 km a few times over.
  for (double height = -5000.0; height <= 84800.0; height += 100.0)
    EXPECT_NEAR(pressure_altitude(standard_pressure(height)), height, 1e-7) << height;
}

TEST(StandardAtmosphere, PressureAltitudeAgreesWithFlightLevels) {
  // FL 100, 200 and 300: the pressures of ICAO Doc 7488, which is the same below 32 km.
  const struct {
    double feet, pressure;
  } rows[] = {{10000.0, 696.817}, {20000.0, 465.633}, {30000.0, 300.896}};
  // Half a thousandth of 1 hPa at 30 000 ft is 0.012 m.
  for (const auto& row : rows) EXPECT_NEAR(pressure_altitude(row.pressure), row.feet * 0.3048, 0.015);
}

TEST(StandardAtmosphere, HydrostaticConstantDiffersSlightlyFromThatOfPcor) {
  // M0/R* of 1976 against the molar mass with present carbon dioxide and the gas constant of 2018: 4e-5,
  // which is 0.3 m in 8 km. Heights of the standard need its own constants.
  EXPECT_NEAR(pcor::standard_hydrostatic_constant * pcor::constants::gas_constant_dry_air /
                  pcor::constants::standard_gravity,
              1.0, 6e-5);
  EXPECT_GT(std::abs(pcor::standard_hydrostatic_constant * pcor::constants::gas_constant_dry_air /
                         pcor::constants::standard_gravity -
                     1.0),
            1e-5);
}

TEST(StandardAtmosphere, IsMissingOutsideItsDomain) {
  for (const double height : {-5000.1, 84852.1, unknown}) {
    EXPECT_TRUE(std::isnan(standard_temperature(height))) << height;
    EXPECT_TRUE(std::isnan(standard_pressure(height))) << height;
  }
  for (const double pressure : {1777.0, 0.0037, 0.0, -1.0, unknown})
    EXPECT_TRUE(std::isnan(pressure_altitude(pressure))) << pressure;
  EXPECT_TRUE(std::isnan(pressure_altitude(std::numeric_limits<double>::infinity())));
}
