#include <gtest/gtest.h>
#include <pcor/physics/geodesy.hpp>
#include "support/archetype.hpp"

#include <cmath>
#include <limits>

using archetype::Physics;
using pcor::geopotential_height;
using pcor::normal_gravity;

namespace {

/// The normal potential of WGS 84 in closed form (Heiskanen and Moritz, Physical Geodesy, eq. 2-62), m2/s2:
/// exact at every height, without a series in the height.
long double normal_potential(double latitude, double height) {
  constexpr long double a = 6378137.0L, flattening = 1.0L / 298.257223563L;
  constexpr long double mass = 3.986004418e14L, rotation = 7.292115e-5L;
  const long double b = a * (1.0L - flattening);
  const long double eccentric = std::sqrt(a * a - b * b);
  const long double angle = latitude * std::acos(-1.0L) / 180.0L;
  const long double square = eccentric * eccentric / (a * a);
  const long double normal = a / std::sqrt(1.0L - square * std::sin(angle) * std::sin(angle));
  const long double across = (normal + height) * std::cos(angle);
  const long double along = (normal * (1.0L - square) + height) * std::sin(angle);
  // The ellipsoid through the point with the same foci: its minor axis u and reduced latitude.
  const long double r = across * across + along * along - eccentric * eccentric;
  const long double u =
      std::sqrt(0.5L * (r + std::sqrt(r * r + 4.0L * eccentric * eccentric * along * along)));
  const long double sine = along / u;
  const auto q = [&](long double axis) {
    const long double x = axis / eccentric;
    return 0.5L * ((1.0L + 3.0L * x * x) * std::atan(1.0L / x) - 3.0L * x);
  };
  const long double centrifugal = 0.5L * rotation * rotation;
  return mass / eccentric * std::atan(eccentric / u) +
         centrifugal * a * a * q(u) / q(b) * (sine * sine - 1.0L / 3.0L) + centrifugal * across * across;
}

double exact_geopotential_height(double latitude, double height) {
  return static_cast<double>((normal_potential(latitude, 0.0) - normal_potential(latitude, height)) /
                             9.80665L);
}

}  // namespace

TEST(Geodesy, NormalGravityEqualsPublishedValues) {
  // NIMA TR8350.2 table 3.4, with all its digits.
  EXPECT_NEAR(normal_gravity(0.0), 9.7803253359, 1e-10);
  EXPECT_NEAR(normal_gravity(90.0), 9.8321849378, 2e-10);
  // GRS 80 (Moritz 2000) has other digits at the equator; the rise from there is the same to 1e-9.
  EXPECT_NEAR(normal_gravity(45.0) - normal_gravity(0.0), 9.806199203 - 9.7803267715, 1e-8);
}

TEST(Geodesy, NormalGravityIsTheSameInTheSouth) {
  for (const double latitude : {12.0, 45.0, 89.0})
    EXPECT_EQ(normal_gravity(latitude), normal_gravity(-latitude)) << latitude;
}

TEST(Geodesy, GeopotentialHeightIsThatOfTheNormalPotential) {
  // Integral of the terms that the series omits: (h/a)^3 h and up to twice the flattening times (h/a)^2 h, 2
  // mm at 20 km and 7 mm at 30 km.
  for (const double latitude : {-90.0, -60.0, -30.0, 0.0, 20.0, 45.0, 75.0}) {
    for (const double height : {-1000.0, 0.0, 1000.0, 5000.0, 12000.0, 20000.0, 30000.0}) {
      EXPECT_NEAR(geopotential_height(latitude, height), exact_geopotential_height(latitude, height),
                  height > 20000.0 ? 7e-3 : 2e-3)
          << latitude << " deg, " << height << " m";
    }
  }
}

TEST(Geodesy, GeopotentialHeightAgreesWithTheGuideOfTheWmo) {
  // WMO-No. 8, part I, chapter 12, eq. 12.16 to 12.19: gamma/g0 R z/(R + z) with the radius R of the
  // latitude.
  for (const double latitude : {0.0, 30.0, 45.0, 60.0, 90.0}) {
    const double sine = std::sin(latitude * std::acos(-1.0) / 180.0);
    const double guide_gravity =
        9.780325 * (1.0 + 0.00193185 * sine * sine) / std::sqrt(1.0 - 0.00669435 * sine * sine);
    const double radius = 6378.137e3 / (1.006803 - 0.006706 * sine * sine);
    for (const double height : {1000.0, 10000.0, 20000.0}) {
      const double guide = guide_gravity / 9.80665 * radius * height / (radius + height);
      // Its constants have six digits: 2e-7 of 20 km is 4 mm.
      EXPECT_NEAR(geopotential_height(latitude, height), guide, 5e-3) << latitude << ", " << height;
    }
  }
}

TEST(Geodesy, GeopotentialHeightMatchesStandardAtmosphere) {
  // US Standard Atmosphere 1976, table I: heights in whole metres, at the latitude of standard gravity, of an
  // earth whose gravity falls with the radius 6356.766 km (Lambert).
  constexpr double latitude = 45.5425;
  const struct {
    double geometric, geopotential;
  } rows[] = {{1000.0, 1000.0},   {2000.0, 1999.0},   {5000.0, 4996.0},  {10000.0, 9984.0},
              {15000.0, 14965.0}, {20000.0, 19937.0}, {30000.0, 29859.0}};
  for (const auto& row : rows)
    EXPECT_NEAR(geopotential_height(latitude, row.geometric), row.geopotential, 0.55) << row.geometric;
}

TEST(Geodesy, MissingInputsGiveNan) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(normal_gravity(nan)));
  EXPECT_TRUE(std::isnan(geopotential_height(nan, 1000.0)));
}

TEST(Geodesy, CompilesForAnotherScalarType) {
  const Physics latitude(40.0), height(9000.0);
  EXPECT_EQ(normal_gravity(latitude).value(), normal_gravity(40.0));
  EXPECT_EQ(geopotential_height(latitude, height).value(), geopotential_height(40.0, 9000.0));
}
