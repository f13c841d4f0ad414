// The arithmetic of reverse headings against the memo's table and against winds that are known.
#include "checks/leg_pair.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include <pcor/physics/air_data.hpp>
#include <pcor/physics/constants.hpp>
#include <pcor/physics/moist_air.hpp>
#include <pcor/regimes/regimes.hpp>

using namespace pcor::internal;

namespace pcor {
namespace {

using constants::radians_per_degree;

/// A row of the memo's table of reverse headings on flight 5 of IDEAS-4.
struct Row {
  std::string begin, end;
  double tail_wind, scatter;  // UXW, m/s
  double heading;             // THDG, deg
  double standard_wind;       // UX of the standard processing, m/s
};

// The first row begins at 23:00:00: the memo prints 22:00:00, which rows three and four lie in (T8).
const std::array<Row, 4> table{{{"23:00:00", "23:05:30", 1.56, 0.91, 242.0, 2.89},
                                {"23:07:00", "23:12:00", -1.08, 0.55, 59.0, -1.47},
                                {"22:51:00", "22:53:00", 1.975, 0.40, 149.0, 2.40},
                                {"22:55:00", "22:57:00", 0.99, 0.52, 329.0, 1.21}}};

// The memo prints no pressure. At this height and speed of a C-130 the Mach number is 0.358.
constexpr double pressure = 700.0;     // hPa
constexpr double airspeed = 118.0;     // m/s
constexpr double temperature = 270.0;  // K
constexpr double mach = 0.358;

LegMean leg_of(double heading, const Estimate& tail_wind) {
  LegMean leg;
  leg.tail_wind = tail_wind;
  leg.heading = heading;
  leg.airspeed = airspeed;
  leg.pressure = pressure;
  leg.mach = mach;
  leg.temperature = temperature;
  return leg;
}

LegPair pair_in_table(std::size_t first, double Row::*tail_wind) {
  const auto leg = [tail_wind](const Row& row) { return leg_of(row.heading, {row.*tail_wind, 0.0}); };
  return pair_of(leg(table[first]), leg(table[first + 1]));
}

LegPair new_pair(std::size_t first) { return pair_in_table(first, &Row::tail_wind); }

LegPair standard_pair(std::size_t first) { return pair_in_table(first, &Row::standard_wind); }

// Half of the last digit that the memo's text prints.
constexpr double printed = 0.0051;

TEST(LegPair, ReproducesTheSumsOfTheMemo) {
  EXPECT_NEAR(new_pair(0).sum.value, 0.48, 1e-12);
  EXPECT_NEAR(new_pair(2).sum.value, 2.97, printed);
  EXPECT_NEAR(standard_pair(0).sum.value, 1.42, 1e-12);
  EXPECT_NEAR(standard_pair(2).sum.value, 3.61, 1e-12);
}

TEST(LegPair, ReproducesAirspeedAndPressureChangesOfTheMemo) {
  // The new airspeed is higher by the error of the old one.
  const auto change = [](std::size_t first, Estimate LegPair::*number) {
    return (new_pair(first).*number).value - (standard_pair(first).*number).value;
  };
  EXPECT_NEAR(change(0, &LegPair::airspeed_error), 0.47, printed);
  EXPECT_NEAR(change(2, &LegPair::airspeed_error), 0.32, printed);
  // 5 %: the state is assumed; from 600 to 750 hPa and 110 to 125 m/s the factor changes by 5 %.
  EXPECT_NEAR(change(0, &LegPair::pressure_error), -0.5, 0.025);
  EXPECT_NEAR(change(2, &LegPair::pressure_error), -0.34, 0.017);
}

TEST(LegPair, ReproducesTheHeadingErrorsOfTheMemo) {
  EXPECT_NEAR(new_pair(0).heading_error, -3.0, 1e-9);
  EXPECT_NEAR(new_pair(2).heading_error, 0.0, 1e-9);
}

/// Whether the legs of the table, with the first one beginning at `begin`, are apart from each other.
bool are_apart(const std::string& begin) {
  std::string text = "format = \"pcor-intervals/1\"\n";
  for (const Row& row : table) {
    text += "[[add]]\nregime = \"reverse heading\"\npair = 1\nbegin = \"" +
            (&row == &table[0] ? begin : row.begin) + "\"\nend = \"" + row.end + "\"\n";
  }
  const UserIntervals legs = read_intervals_text(text, "table");
  bool apart = true;
  for (const Interval& a : legs.add) {
    for (const Interval& b : legs.add) {
      if (&a != &b && a.begin < b.end && b.begin < a.end) apart = false;
    }
  }
  return apart;
}

TEST(LegPair, FirstLegOfTheMemoNeedsCorrectedTime) {
  EXPECT_TRUE(are_apart("23:00:00"));
  EXPECT_FALSE(are_apart("22:00:00"));
}

/// A leg in a wind, m/s, with an airspeed that is too high.
LegMean flown(double heading, double east, double north, double too_high) {
  const double sine = std::sin(heading * radians_per_degree);
  const double cosine = std::cos(heading * radians_per_degree);
  LegMean leg = leg_of(heading, {east * sine + north * cosine - too_high, 0.1});
  leg.cross_speed = east * cosine - north * sine;
  return leg;
}

TEST(LegPair, WindCancelsOnOppositeHeadings) {
  for (const double heading : {0.0, 47.0, 180.0, 300.0}) {
    const LegPair pair = pair_of(flown(heading, 12.0, -7.0, 0.0), flown(heading + 180.0, 12.0, -7.0, 0.0));
    EXPECT_NEAR(pair.sum.value, 0.0, 1e-12);  // rounding of the sines
    EXPECT_NEAR(pair.airspeed_error.value, 0.0, 1e-12);
    EXPECT_NEAR(std::remainder(pair.heading_error, 360.0), 0.0, 1e-9);
  }
}

TEST(LegPair, FindsTheErrorOfTheAirspeed) {
  const LegPair pair = pair_of(flown(70.0, 12.0, -7.0, 0.8), flown(250.0, 12.0, -7.0, 0.8));
  EXPECT_NEAR(pair.airspeed_error.value, 0.8, 1e-12);
  EXPECT_NEAR(pair.airspeed_error.error, 0.5 * std::sqrt(2.0) * 0.1,
              1e-12);  // difference of two means of 0.1 m/s
}

TEST(LegPair, HeadingErrorIsCorrectedForWind) {
  const LegPair pair = pair_of(flown(70.0, 12.0, -7.0, 0.8), flown(256.0, 12.0, -7.0, 0.8));
  EXPECT_NEAR(pair.heading_error, 6.0, 1e-9);
  EXPECT_GT(std::abs(pair.heading_share), 0.5);  // a cross wind of 10.7 m/s through 6 deg is 1.1 m/s
  // Remainder: effect of the airspeed's error on the wind, 0.8 m/s through half of 6 deg squared.
  EXPECT_NEAR(pair.airspeed_error.value, 0.8, 0.8 * std::pow(6.0 * radians_per_degree, 2));
}

TEST(LegPair, SensitivityAgreesWithAirDataEquations) {
  // The Mach number from pressures, and the temperature from a total one, by the library's exact equations.
  const auto speed = [](double p, double total, double total_temperature) {
    const MoistAir<double> dry = dry_air<double>();
    const double m = mach_number(p, total - p, dry);
    return true_airspeed(m, total_temperature / (1.0 + 0.2 * m * m), dry);
  };
  const double p = 500.0;
  const double total = 620.0;
  const double step = 1e-3;  // hPa: the error of the difference is 1e-9
  const double slope = (speed(p + step, total, 270.0) - speed(p - step, total, 270.0)) / (2.0 * step);
  const double m = mach_number(p, total - p, dry_air<double>());
  EXPECT_NEAR(pressure_per_airspeed(p, m, speed(p, total, 270.0)) * slope, 1.0, 1e-6);
}

}  // namespace
}  // namespace pcor
