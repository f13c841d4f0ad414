#include <gtest/gtest.h>
#include <pcor/physics/flow_angles.hpp>
#include <pcor/physics/humidity.hpp>
#include <pcor/physics/lams.hpp>
#include "support/archetype.hpp"

#include <array>
#include <cmath>
#include <type_traits>

using archetype::Physics;

namespace {

// Results of all functions of the physics for one sample, in the scalar S.
template <class S>
std::array<S, 22> everything(double p, double q, double v, double T, double e, double mach) {
  using namespace pcor;
  const MoistAir<S> air = moist_air(S(e) / S(p));
  const RecoveryFactor law{{0.988, 0.053, 0.090, 0.091}};
  const RadomeCalibration radome{5.5156, 19.07, 2.08};
  const S factor = law(S(mach));
  const auto one = lams_simultaneous(S(p), S(q), S(v), S(T), S(e), law);
  const auto two = lams_iterated(S(p), S(q), S(v), S(T), S(e), law);
  const auto three = lams_with_temperature(S(p), S(q), S(v), S(T), S(e));
  const S cosine = beam_cosine(S(1.5), S(-0.8), S(2.5), S(-1.0));
  return {air.gas_constant,
          air.heat_capacity_ratio,
          dry_air<S>().poisson_exponent,
          mach_number(S(p), S(q), air),
          dynamic_pressure_from_mach(S(p), S(mach), air),
          dynamic_pressure_from_airspeed(S(p), S(v), S(T), air),
          true_airspeed(S(mach), S(T), air),
          vapor_pressure_over_water(S(T)),
          vapor_pressure_over_ice(S(T)),
          saturation_vapor_pressure(S(T)),
          enhancement_factor(S(T), S(p)),
          vapor_pressure_from_dew_point(S(T), S(p)),
          factor,
          ambient_temperature(S(T), S(mach), factor, air),
          recovery_temperature(S(T), S(mach), factor, air),
          radome(S(-0.2), S(mach)),
          airspeed_from_beam(S(v), cosine),
          one.static_defect,
          two.static_defect,
          three.static_defect,
          three.mach,
          lams_temperature(S(v), S(mach), air)};
}

}  // namespace

TEST(Scalar, ArchetypeHasNoConversion) {
  static_assert(!std::is_convertible_v<double, Physics> && !std::is_convertible_v<Physics, double>);
  static_assert(!std::is_convertible_v<archetype::Truth, bool>);
}

TEST(Scalar, PhysicsCompilesForNonDoubleScalar) {
  // Powers are exp(y log x) there instead of pow: 1e-15 relative, which chi turns into 1e-12 hPa of 1000.
  for (const auto& [p, q, v, T, e, mach] :
       {std::array{700.0, 68.0, 120.0, 275.0, 4.0, 0.36}, {250.0, 121.0, 230.0, 245.0, 0.05, 0.77}}) {
    const auto expected = everything<double>(p, q, v, T, e, mach);
    const auto found = everything<Physics>(p, q, v, T, e, mach);
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_NEAR(found[i].value(), expected[i], 1e-12 * (10 + std::abs(expected[i]))) << i;
  }
}

TEST(Scalar, ArchetypeAndDoubleTakeTheSameBranches) {
  // Both branches of every select: impossible pressures and temperatures.
  for (const auto& [p, q] : {std::pair{-1.0, 5.0}, {0.0, 5.0}, {700.0, -5.0}}) {
    EXPECT_TRUE(std::isnan(pcor::mach_number(Physics(p), Physics(q), pcor::dry_air<Physics>()).value()));
    EXPECT_TRUE(std::isnan(pcor::mach_number(p, q, pcor::dry_air<double>())));
  }
  EXPECT_TRUE(
      std::isnan(pcor::lams_temperature(Physics(100.0), Physics(0.0), pcor::dry_air<Physics>()).value()));
  EXPECT_DOUBLE_EQ(pcor::saturation_vapor_pressure(Physics(250.0)).value(),
                   pcor::vapor_pressure_over_ice(250.0));
  EXPECT_NEAR(pcor::saturation_vapor_pressure(Physics(280.0)).value(), pcor::vapor_pressure_over_water(280.0),
              1e-13);
}

TEST(Scalar, PromotesToTheMoreGeneralType) {
  static_assert(std::is_same_v<pcor::Promoted<double, double>, double>);
  static_assert(std::is_same_v<pcor::Promoted<Physics, Physics>, Physics>);
}

TEST(Scalar, DetectsMissingValues) {
  EXPECT_TRUE(pcor::is_missing(pcor::missing<double>()));
  EXPECT_FALSE(pcor::is_missing(0.0));
  EXPECT_FALSE(pcor::is_missing(std::numeric_limits<double>::infinity()));
  EXPECT_TRUE(all(pcor::is_missing(pcor::missing<Physics>())));
}

TEST(Scalar, SelectsOneOfTwo) {
  EXPECT_EQ(pcor::select(true, 1.0, 2.0), 1.0);
  EXPECT_EQ(pcor::select(false, 1.0, 2.0), 2.0);
  EXPECT_TRUE(pcor::all(true));
  EXPECT_TRUE(pcor::any(true));
  EXPECT_FALSE(pcor::any(false));
}

TEST(Scalar, FunctionsAgreeWithTheStandardLibrary) {
  for (double x = -6; x <= 6; x += 0.25) EXPECT_NEAR(pcor::hyperbolic_tangent(x), std::tanh(x), 5e-16) << x;
  EXPECT_EQ(pcor::hyperbolic_tangent(1000.0), 1.0);
  EXPECT_EQ(pcor::hyperbolic_tangent(-1000.0), -1.0);
  for (const double x : {0.01, 0.5, 1.0, 700.0}) {
    EXPECT_NEAR(pcor::power(x, 3.5) / std::pow(x, 3.5), 1.0, 1e-14);
    EXPECT_NEAR(pcor::power(Physics(x), Physics(3.5)).value() / std::pow(x, 3.5), 1.0, 1e-14);
    EXPECT_NEAR(pcor::power(Physics(x), 3.5).value() / std::pow(x, 3.5), 1.0, 1e-14);
    EXPECT_NEAR(pcor::decimal_logarithm(Physics(x)).value(), std::log10(x), 1e-15);
  }
  EXPECT_TRUE(std::isnan(pcor::power(-1.0, 3.5)));
  EXPECT_TRUE(std::isnan(pcor::power(Physics(-1.0), Physics(3.5)).value()));
}

TEST(Scalar, APowerLessOneIsExactInFlightAndBeyond) {
  // In flight, in the range of the polynomials, to 1e-15; elsewhere the subtraction of one costs digits:
  // 4e-16 of the power itself.
  const auto expected = [](double ratio, double exponent) {
    return std::expm1(static_cast<long double>(exponent) * std::log1p(static_cast<long double>(ratio)));
  };
  const auto error = [&expected](double ratio, double exponent) {
    const auto found = static_cast<long double>(pcor::power_less_one(64.0 * ratio, 64.0, exponent));
    return std::abs(static_cast<double>(found - expected(ratio, exponent)));
  };
  for (const double exponent : {0.28, 2.0 / 7.0, 0.29}) {
    for (double ratio = 1e-7; ratio < 0.6; ratio += 0.00037) {
      EXPECT_LT(error(ratio, exponent), 1e-15 * static_cast<double>(expected(ratio, exponent))) << ratio;
    }
    for (double ratio = 0.6; ratio < 6.0; ratio += 0.013) EXPECT_LT(error(ratio, exponent), 2e-15) << ratio;
    for (double ratio = -0.9; ratio < 0.0; ratio += 0.013) EXPECT_LT(error(ratio, exponent), 2e-15) << ratio;
  }
  EXPECT_EQ(pcor::power_less_one(0.0, 500.0, 0.3), 0.0);
  for (const auto& [part, whole] : {std::pair{-2.0, 1.0}, {std::nan(""), 1.0}, {1.0, std::nan("")}})
    EXPECT_TRUE(std::isnan(pcor::power_less_one(part, whole, 0.3)));
}
