#include <gtest/gtest.h>
#include <pcor/physics/humidity.hpp>
#include <pcor/physics/lams.hpp>
#include "support/atmosphere.hpp"

#include <cmath>
#include <string_view>

// Response of delta-p from LAMS to errors of its inputs: the table of the cost of each effect, and its two
// source formulas.

using atmosphere::dry;
using atmosphere::temperature_at_pressure;
using pcor::beam_cosine;
using pcor::moist_air;
using pcor::MoistAir;
using pcor::pressure_ratio_of_airspeed;
using pcor::static_defect_from_pressure_ratio;

namespace {

constexpr double recovery = 0.97;

// A measured state without defect, and the table's row for it.
struct Row {
  std::string_view name;
  double p, v;
  double mach, q;
  double airspeed, airspeed_with_thermometer;  // hPa for 1 m/s: temperature fixed, thermometer fixed
  double temperature;                          // hPa/K
  double recovery_factor;                      // hPa for 0.01
  double of_dynamic, of_static;                // 1: for an error of the pressures
  double loss, scale, cosine, dryness;         // hPa: 1 % of q, 0.1 % of v, cos 3 deg, dry constants at 70 %

  double T() const { return temperature_at_pressure(p); }
  double total() const { return p * (1 + pressure_ratio_of_airspeed(v, T(), dry)); }

  double defect(double airspeed_used, double T_used) const {
    return static_defect_from_pressure_ratio(p, total() - p,
                                             pressure_ratio_of_airspeed(airspeed_used, T_used, dry));
  }
  double defect_with_thermometer(double airspeed_used, double factor) const {
    const double thermometer = T() + recovery * v * v / (2 * dry.specific_heat_pressure);
    return defect(airspeed_used,
                  thermometer - factor * airspeed_used * airspeed_used / (2 * dry.specific_heat_pressure));
  }
};

// ISO 2533 temperatures. Printed digits; three digits of `q`.
const Row table[] = {
    {"C-130 low", 900, 110, .327, 69.1, -1.20, -1.22, .234, -.014, .929, -.071, -.64, -.132, .18, -.215},
    {"C-130 mid", 700, 120, .365, 67.6, -1.06, -1.09, .237, -.017, .912, -.088, -.62, -.127, .17, -.104},
    {"C-130 high", 500, 145, .456, 76.5, -0.96, -1.00, .277, -.029, .867, -.133, -.66, -.140, .19, -.041},
    {"GV low", 850, 160, .478, 144, -1.63, -1.70, .467, -.059, .855, -.145, -1.23, -.260, .36, -.363},
    {"GV mid", 500, 200, .629, 152, -1.28, -1.38, .509, -.101, .766, -.234, -1.17, -.256, .35, -.076},
    {"GV high", 250, 230, .772, 121, -0.81, -0.90, .422, -.111, .674, -.326, -.82, -.186, .26, -.005},
    {"GV top", 160, 240, .813, 87.2, -0.55, -0.62, .302, -.087, .647, -.353, -.56, -.131, .18, -.003},
};

// Half a unit of the last printed digit, and a little for how the last digit was rounded.
constexpr double two_digits = 0.0056, three_digits = 0.00056;

template <class Function>
double slope(const Function& f, double x, double h) {
  return (f(x + h) - f(x - h)) / (2 * h);
}

}  // namespace

TEST(Sensitivity, FormulasEqualTheDerivativesOfTheRetrieval) {
  // S_v = -gamma M^2 p/((1+x) v) and S_T = gamma M^2 p/(2 (1+x) T). The central difference errs by h^2
  // f'''/6: 1e-8 relative with the steps of 1e-4 relative, and 1e-12/h of rounding.
  for (const auto& [p, v] : atmosphere::envelopes()) {
    const Row row{"", p, v, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    const double T = row.T();
    const double m2 = v * v / (dry.heat_capacity_ratio * dry.gas_constant * T);
    const double x = 0.2 * m2;
    const double of_airspeed = -1.4 * m2 * p / ((1 + x) * v);
    const double of_temperature = 1.4 * m2 * p / (2 * (1 + x) * T);
    EXPECT_NEAR(slope([&](double used) { return row.defect(used, T); }, v, 1e-4 * v) / of_airspeed, 1.0,
                1e-7);
    EXPECT_NEAR(slope([&](double used) { return row.defect(row.v, used); }, T, 1e-4 * T) / of_temperature,
                1.0, 1e-7);
  }
}

TEST(Sensitivity, StatesAgreeWithTheTable) {
  for (const Row& row : table) {
    SCOPED_TRACE(row.name);
    const double mach = row.v / pcor::speed_of_sound(row.T(), dry);
    const double q = row.total() - row.p;
    EXPECT_NEAR(mach, row.mach, three_digits);
    EXPECT_NEAR(q, row.q, row.q < 100 ? 0.056 : 0.56);
    EXPECT_NEAR(row.p / row.total(), row.of_dynamic, three_digits);
    EXPECT_NEAR(-q / row.total(), row.of_static, three_digits);
  }
}

TEST(Sensitivity, ToTheAirspeed) {
  for (const Row& row : table) {
    SCOPED_TRACE(row.name);
    const double fixed = slope([&](double used) { return row.defect(used, row.T()); }, row.v, 0.01);
    const double thermometer =
        slope([&](double used) { return row.defect_with_thermometer(used, recovery); }, row.v, 0.01);
    EXPECT_NEAR(fixed, row.airspeed, two_digits);
    EXPECT_NEAR(thermometer, row.airspeed_with_thermometer, two_digits);
    EXPECT_NEAR(row.defect(1.001 * row.v, row.T()), row.scale, three_digits);
  }
}

TEST(Sensitivity, ToTheTemperature) {
  for (const Row& row : table) {
    SCOPED_TRACE(row.name);
    EXPECT_NEAR(slope([&](double used) { return row.defect(row.v, used); }, row.T(), 0.01), row.temperature,
                three_digits);
    EXPECT_NEAR(row.defect_with_thermometer(row.v, recovery + 0.01), row.recovery_factor, three_digits);
  }
}

TEST(Sensitivity, ToThePitotsLoss) {
  // The table computed k1 q/100 from its own rounded columns, which moves -0.814 to -0.82.
  for (const Row& row : table) {
    SCOPED_TRACE(row.name);
    const double loss = 0.01 * (row.total() - row.p);
    const double chi = pressure_ratio_of_airspeed(row.v, row.T(), dry);
    EXPECT_NEAR(static_defect_from_pressure_ratio(row.p, row.total() - loss - row.p, chi), row.loss,
                two_digits);
  }
}

TEST(Sensitivity, ToTheAngleOfTheBeam) {
  for (const Row& row : table) {
    SCOPED_TRACE(row.name);
    EXPECT_NEAR(row.defect(row.v * beam_cosine(3.0, 0.0, 0.0, 0.0), row.T()), row.cosine, two_digits);
  }
}

TEST(Sensitivity, ToTheHumidity) {
  for (const Row& row : table) {
    SCOPED_TRACE(row.name);
    const double e = 0.7 * pcor::vapor_pressure_over_water(row.T());
    const double total = row.p * (1 + pressure_ratio_of_airspeed(row.v, row.T(), moist_air(e / row.p)));
    EXPECT_NEAR(static_defect_from_pressure_ratio(row.p, total - row.p,
                                                  pressure_ratio_of_airspeed(row.v, row.T(), dry)),
                row.dryness, 0.0007)
        << "another formula of the saturation pressure changes it by 1e-3 of itself";
  }
  // The tropical boundary layer.
  const double total = 950 * (1 + pressure_ratio_of_airspeed(100.0, 300.15, moist_air(30.0 / 950)));
  EXPECT_NEAR(
      static_defect_from_pressure_ratio(950.0, total - 950, pressure_ratio_of_airspeed(100.0, 300.15, dry)),
      -0.65, two_digits);
}

TEST(Sensitivity, OfTheAirspeedToDeltaP) {
  // A delta-p that is 1 hPa too high makes the airspeed too low by 0.94 m/s at 700 hPa and 120 m/s, and
  // by 1.06 at 550 hPa and 130 m/s.
  for (const auto& [p, v, change] : {std::array{700.0, 120.0, -0.94}, {550.0, 130.0, -1.06}}) {
    const double T = temperature_at_pressure(p);
    const double q = pcor::dynamic_pressure_from_airspeed(p, v, T, dry);
    const auto airspeed = [&, p = p](double defect) {
      return pcor::true_airspeed(pcor::mach_number(p + defect, q - defect, dry), T, dry);
    };
    EXPECT_NEAR(slope(airspeed, 0.0, 0.01), change, two_digits);
  }
}
