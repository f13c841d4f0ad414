#include "batch/pack.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include "numerics/missing.hpp"

using namespace pcor::internal;

namespace pcor {
namespace {

using internal::infinity;
using internal::nan;
using testing::IsNan;

using TestPack = Pack<xsimd::default_arch>;
using Values = std::array<double, TestPack::size>;

constexpr double last_place = std::numeric_limits<double>::epsilon();

TestPack pack(double value) { return TestPack(value); }

/// The first lane; the others have to be the same.
double value(const TestPack& lanes) {
  Values values;
  lanes.store(values.data(), values.size());
  for (const double other : values) EXPECT_TRUE(other == values[0] || std::isnan(other));
  return values[0];
}

TEST(Pack, ExponentialIsWithinTwoUnitsInTheLastPlace) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> any(-700.0, 700.0);
  std::uniform_real_distribution<double> small(-0.5, 0.5);
  for (int i = 0; i < 20000; ++i) {
    for (const double x : {any(random), small(random)}) {
      const double expected = std::exp(x);
      EXPECT_NEAR(value(exp(pack(x))), expected, 2.0 * last_place * expected) << x;
    }
  }
}

TEST(Pack, LogarithmIsWithinTwoUnitsInTheLastPlace) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> exponent(-300.0, 300.0);
  std::uniform_real_distribution<double> near_one(0.5, 2.0);
  for (int i = 0; i < 20000; ++i) {
    for (const double x : {std::pow(10.0, exponent(random)), near_one(random)}) {
      const double expected = std::log(x);
      EXPECT_NEAR(value(log(pack(x))), expected, 2.0 * last_place * std::abs(expected)) << x;
    }
  }
}

TEST(Pack, PowerLessOneIsAccurateForSmallValues) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> magnitude(-12.0, 0.3);
  for (int i = 0; i < 20000; ++i) {
    const double part = std::pow(10.0, magnitude(random));
    for (const double exponent : {2.0 / 7.0, 3.5}) {
      const double expected = std::expm1(exponent * std::log1p(part));
      EXPECT_NEAR(value(power_less_one(pack(300.0 * part), pack(300.0), pack(exponent))), expected,
                  part < 0.6 && exponent < 1.0 ? 8.0 * last_place * expected : 4e-15 * (1.0 + expected))
          << part;
    }
  }
  EXPECT_EQ(value(power_less_one(pack(0.0), pack(500.0), pack(0.3))), 0.0);
}

TEST(Pack, LimitsEqualThoseOfScalarFunctions) {
  EXPECT_EQ(value(exp(pack(0.0))), 1.0);
  EXPECT_EQ(value(exp(pack(-infinity))), 0.0);
  EXPECT_EQ(value(exp(pack(-800.0))), 0.0);
  EXPECT_EQ(value(exp(pack(800.0))), infinity);
  EXPECT_EQ(value(exp(pack(infinity))), infinity);
  EXPECT_THAT(value(exp(pack(nan))), IsNan());
  EXPECT_EQ(value(log(pack(1.0))), 0.0);
  EXPECT_EQ(value(log(pack(0.0))), -infinity);
  EXPECT_EQ(value(log(pack(infinity))), infinity);
  EXPECT_THAT(value(log(pack(-1.0))), IsNan());
  EXPECT_THAT(value(log(pack(-infinity))), IsNan());
  EXPECT_THAT(value(log(pack(nan))), IsNan());
  EXPECT_THAT(value(power_less_one(pack(-2.0), pack(1.0), pack(0.3))), IsNan());
  EXPECT_THAT(value(power_less_one(pack(nan), pack(1.0), pack(0.3))), IsNan());
}

// One unusual lane sends all through the general case.
TEST(Pack, UnusualLaneDoesNotAffectOtherLanes) {
  Values x;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = 0.1 * static_cast<double>(i);
  x.back() = nan;
  const TestPack lanes = TestPack::load(x.data(), x.size());
  Values found;
  exp(lanes).store(found.data(), found.size());
  for (std::size_t i = 0; i + 1 < x.size(); ++i) EXPECT_DOUBLE_EQ(found[i], std::exp(x[i]));
  EXPECT_THAT(found.back(), IsNan());
  log(lanes).store(found.data(), found.size());
  for (std::size_t i = 0; i + 1 < x.size(); ++i) EXPECT_DOUBLE_EQ(found[i], std::log(x[i]));
  EXPECT_THAT(found.back(), IsNan());
}

TEST(Pack, SelectsEachLaneSeparately) {
  Values x;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = static_cast<double>(i);
  x[1] = nan;
  const TestPack lanes = TestPack::load(x.data(), x.size());
  EXPECT_TRUE(any(is_missing(lanes)));
  EXPECT_FALSE(all(is_missing(lanes)));
  EXPECT_TRUE(all(is_missing(lanes) || lanes >= 0.0));
  EXPECT_FALSE(any(is_missing(lanes) && lanes >= 0.0));
  Values found;
  select(!(lanes < 1.0), lanes, TestPack(-1.0)).store(found.data(), found.size());
  EXPECT_EQ(found[0], -1.0);
  EXPECT_THAT(found[1], IsNan());
  for (std::size_t i = 2; i < x.size(); ++i) EXPECT_EQ(found[i], x[i]);
}

}  // namespace
}  // namespace pcor
