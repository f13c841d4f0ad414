#include <gtest/gtest.h>
#include <pcor/physics/air_data.hpp>
#include <pcor/physics/recovery_factor.hpp>
#include "support/atmosphere.hpp"
#include "support/constants.hpp"

#include <array>
#include <cmath>

using atmosphere::dry;
using pcor::dry_air;
using pcor::dynamic_pressure_from_airspeed;
using pcor::dynamic_pressure_from_mach;
using pcor::mach_number;
using pcor::moist_air;
using pcor::MoistAir;
using pcor::pressure_ratio_of_airspeed;
using pcor::speed_of_sound;
using pcor::true_airspeed;
using pcor::test::missing;

TEST(AirData, PressureRatioAgreesWithNaca1135) {
  // NACA Report 1135, table I, p/pt. Half a unit of the last printed digit.
  struct Row {
    double mach, ratio, digit;
  };
  for (const Row& row :
       {Row{0.3, 0.9395, 1e-4}, Row{0.5, 0.8430, 1e-4}, Row{0.8, 0.6560, 1e-4}, Row{1.0, 0.5283, 1e-4}}) {
    const double q = dynamic_pressure_from_mach(1000.0, row.mach, dry);
    EXPECT_NEAR(1000.0 / (1000.0 + q), row.ratio, 0.5 * row.digit) << row.mach;
    // dM/d(p/pt) is 1.2 to 2.1 here.
    EXPECT_NEAR(mach_number(row.ratio, 1 - row.ratio, dry), row.mach, 2.2 * 0.5 * row.digit) << row.mach;
  }
}

TEST(AirData, DynamicHeatingAgreesWithNaca1135) {
  // NACA Report 1135, table I, T/Tt.
  for (const auto& [mach, ratio] : {std::pair{0.3, 0.9823}, {0.5, 0.9524}, {0.8, 0.8865}, {1.0, 0.8333}}) {
    const double heating = pcor::dynamic_heating(1.0, dynamic_pressure_from_mach(1.0, mach, dry), dry);
    EXPECT_NEAR(1 / (1 + heating), ratio, 0.5e-4) << mach;
  }
}

TEST(AirData, SpeedOfSoundAgreesWithTheStandardAtmosphere) {
  // ISO 2533: 340.294 m/s at 288.15 K, 295.070 m/s at 216.65 K, with R 287.05287; ours is 4.2e-5 higher, so
  // sound is 2.1e-5 faster: 0.0072 m/s.
  EXPECT_NEAR(speed_of_sound(288.15, dry), 340.294, 0.008);
  EXPECT_NEAR(speed_of_sound(216.65, dry), 295.070, 0.008);
}

TEST(AirData, AirspeedInTheStandardAtmosphere) {
  // Sound goes at 661.47 knots at sea level and 573.57 knots in the stratosphere (ISO 2533), so 250 knots are
  // Mach 0.3779 and 500 knots are Mach 0.8717.
  const double knot = 1852.0 / 3600.0;
  const double mach = 250 * knot / speed_of_sound(288.15, dry);
  EXPECT_NEAR(mach, 0.3779, 5e-5);
  EXPECT_NEAR(mach_number(1013.25, dynamic_pressure_from_airspeed(1013.25, 250 * knot, 288.15, dry), dry),
              mach, 1e-14);
  EXPECT_NEAR(true_airspeed(0.8717, 216.65, dry) / knot, 500.0, 0.05);
}

TEST(AirData, SlowAirIsIncompressible) {
  // q = rho v^2/2 (1 + M^2/4 + M^4/40 + ...): Bernoulli with the compressibility of NACA 1135 eq. 32. Below
  // M 0.25 the next term, M^6/1600, is under 2e-7.
  for (double v = 1.0; v <= 80.0; v *= 1.5) {
    const double p = 900.0, T = 280.0;
    const double density = 100 * p / (dry.gas_constant * T);
    const double m2 = v * v / (dry.heat_capacity_ratio * dry.gas_constant * T);
    const double bernoulli = 0.01 * 0.5 * density * v * v;
    EXPECT_NEAR(dynamic_pressure_from_airspeed(p, v, T, dry) / bernoulli, 1 + m2 / 4 + m2 * m2 / 40,
                2e-7 + 1e-14 / m2)
        << v;
  }
}

TEST(AirData, MachNumberAndDynamicPressureAreInverses) {
  // The Mach number is stated to 1e-14 at q/p 0.1; its error grows as 1e-15 p/q.
  for (const double h : {0.0, 0.02, 0.05}) {
    const MoistAir<double> air = moist_air(h);
    for (double mach = 0.01; mach < 1.0; mach += 0.01) {
      const double q = dynamic_pressure_from_mach(500.0, mach, air);
      EXPECT_NEAR(mach_number(500.0, q, air) / mach, 1.0, 2e-15 * (1 + 500.0 / q)) << mach;
    }
  }
}

TEST(AirData, SmallestPressuresKeepTheStatedAccuracy) {
  // q/p = 1e-5: gamma M^2/2 = q/p (1 - ...), with M^2/4 = 3.6e-6 of compressibility subtracted.
  const double x = 1e-5;
  const double m2 = 2 / 1.4 * x;  // leading order
  const double mach = std::sqrt(m2 / (1 + m2 / 4));
  EXPECT_NEAR(mach_number(1.0, x, dry) / mach, 1.0, 1e-10);
}

TEST(AirData, DynamicPressureFromAirspeedAndMachNumberAgree) {
  // Eq. 8 knows the airspeed and temperature, eq. 6 the Mach number: energy and momentum are one flow.
  for (const auto& [p, v] : atmosphere::envelopes()) {
    for (const double h : {0.0, 0.02}) {
      const MoistAir<double> air = moist_air(h);
      const double T = atmosphere::temperature_at_pressure(p);
      const double q = dynamic_pressure_from_airspeed(p, v, T, air);
      EXPECT_NEAR(dynamic_pressure_from_mach(p, v / speed_of_sound(T, air), air) / q, 1.0, 1e-13);
      EXPECT_NEAR(true_airspeed(mach_number(p, q, air), T, air) / v, 1.0, 1e-13);
      EXPECT_NEAR(q / p, pressure_ratio_of_airspeed(v, T, air), 1e-15);
    }
  }
}

TEST(AirData, EnergyAndEntropyAreConserved) {
  // From the free stream to rest: c_p T + v^2/2 is constant, and so is T p^(-R/c_p).
  for (const auto& [p, v] : atmosphere::envelopes()) {
    const MoistAir<double> air = moist_air(0.01);
    const double T = atmosphere::temperature_at_pressure(p);
    const double q = dynamic_pressure_from_airspeed(p, v, T, air);
    const double at_rest = T * (1 + pcor::dynamic_heating(p, q, air));
    EXPECT_NEAR((air.specific_heat_pressure * T + v * v / 2) / (air.specific_heat_pressure * at_rest), 1.0,
                1e-14);
    EXPECT_NEAR(at_rest / T, std::pow((p + q) / p, air.gas_constant / air.specific_heat_pressure), 1e-14);
  }
}

TEST(AirData, HeatingRelatesMachTemperatureAndAirspeed) {
  // To a few units of the last place of each factor.
  for (const double e_over_p : {0.0, 0.01, 0.05}) {
    const MoistAir<double> air = moist_air(e_over_p);
    for (const auto& [p, q, T] :
         {std::array{1000.0, 30.0, 295.0}, {700.0, 68.0, 275.0}, {190.0, 98.0, 215.0}}) {
      const double heating = pcor::dynamic_heating(p, q, air);
      const double mach = mach_number(p, q, air);
      EXPECT_NEAR(0.5 * mach * mach * (air.heat_capacity_ratio - 1), heating, 1e-14);
      EXPECT_NEAR(pcor::true_airspeed_from_heating(heating, T, air), true_airspeed(mach, T, air), 1e-12);
      const double recovered = pcor::recovery_temperature(T, mach, 0.97, air);
      EXPECT_NEAR(pcor::ambient_temperature_from_heating(recovered, heating, 0.97), T, 1e-12);
      EXPECT_NEAR(pcor::mach_number_from_heating(heating, air), mach, 1e-15);
    }
  }
  EXPECT_TRUE(std::isnan(pcor::mach_number_from_heating(-0.01, dry)));
  EXPECT_TRUE(std::isnan(pcor::true_airspeed_from_heating(-0.01, 280.0, dry)));
  EXPECT_TRUE(std::isnan(pcor::dynamic_heating(0.0, 10.0, dry)));
}

TEST(AirData, MachNumberDependsOnThePressureRatioOnly) {
  EXPECT_DOUBLE_EQ(mach_number(1000.0, 100.0, dry), mach_number(250.0, 25.0, dry));
}

TEST(AirData, MachNumberRisesWithTheDynamicPressure) {
  EXPECT_EQ(mach_number(700.0, 0.0, dry), 0.0);
  for (double q = 0; q < 300; q += 1)
    EXPECT_LT(mach_number(700.0, q, dry), mach_number(700.0, q + 1, dry)) << q;
}

TEST(AirData, ImpossiblePressuresGiveNan) {
  EXPECT_TRUE(std::isnan(mach_number(700.0, -1.0, dry)));
  EXPECT_TRUE(std::isnan(mach_number(0.0, 10.0, dry)));
  EXPECT_TRUE(std::isnan(mach_number(0.0, 0.0, dry)));
  EXPECT_TRUE(std::isnan(mach_number(-700.0, -60.0, dry)));
  EXPECT_TRUE(std::isnan(mach_number(-700.0, 60.0, dry)));
}

TEST(AirData, ImpossibleTemperaturesGiveNan) {
  EXPECT_TRUE(std::isnan(pressure_ratio_of_airspeed(100.0, 0.0, dry)));
  EXPECT_TRUE(std::isnan(pressure_ratio_of_airspeed(100.0, -280.0, dry)));
  EXPECT_TRUE(std::isnan(speed_of_sound(-1.0, dry)));
  EXPECT_EQ(speed_of_sound(0.0, dry), 0.0);
}

TEST(AirData, MissingInputsGiveNan) {
  EXPECT_TRUE(std::isnan(mach_number(missing, 60.0, dry)));
  EXPECT_TRUE(std::isnan(mach_number(700.0, missing, dry)));
  EXPECT_TRUE(std::isnan(mach_number(700.0, 60.0, moist_air(missing))));
  EXPECT_TRUE(std::isnan(dynamic_pressure_from_mach(700.0, missing, dry)));
  EXPECT_TRUE(std::isnan(pressure_ratio_of_airspeed(missing, 280.0, dry)));
  EXPECT_TRUE(std::isnan(pressure_ratio_of_airspeed(100.0, missing, dry)));
  EXPECT_TRUE(std::isnan(true_airspeed(missing, 280.0, dry)));
}
