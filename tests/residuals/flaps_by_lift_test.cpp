#include "residuals/samples.hpp"
#include "residuals/time_spans.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

using pcor::FlightSamples;
using pcor::Quantity;
using pcor::internal::find_flaps_by_lift;
using pcor::internal::FlapsByLift;
using pcor::internal::marked_runs;
using pcor::internal::times_of;
using testing::HasSubstr;

namespace {

constexpr double min_airspeed = 60.0;

/// A C-130 that climbs out, cruises for an hour and a half, and approaches.
struct FlightWithFlaps {
  FlightSamples samples{};
  std::vector<double> attack{};  ///< deg
  std::vector<double> flaps{};   ///< percent

  /// @param cruise dynamic pressure, hPa @param flown percent of the flaps at take-off and approach
  explicit FlightWithFlaps(unsigned seed, double flown, double cruise = 75.0) {
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> normal;
    std::vector<double> p;
    std::vector<double> q;
    double gust = 0.0;
    for (int i = 0; i < 6000; ++i) {
      const bool slow = i < 120 || i >= 5500;
      const double dynamic = slow ? 34.0 : cruise + 8.0 * std::sin(i / 300.0);
      const double roll = i % 1000 < 150 ? 25.0 : 0.0;
      gust = 0.8 * gust + 0.3 * normal(engine);  // deg
      flaps.push_back(slow ? flown : 0.0);
      samples.time.push_back(1321560000.0 + i);
      p.push_back(slow ? 950.0 : 700.0);
      q.push_back(dynamic);
      samples.motion.airspeed.push_back(std::sqrt(dynamic / p.back()) * 395.0);
      samples.motion.roll.push_back(roll);
      samples.motion.vertical_speed.push_back(0.3 * normal(engine));
      // A weight that falls by 14 %, 3 deg of flaps at 50 %; compression is left to the tolerance of the law.
      const double weight = 1.0 - 0.14 * i / 6000.0;
      attack.push_back(-4.3 + 390.0 * weight / (dynamic * std::cos(roll * 0.0174533)) - 0.06 * flaps.back() +
                       gust);
    }
    samples.aircraft = "N130AR";
    samples.model.columns = {{Quantity::static_pressure, p}, {Quantity::dynamic_pressure, q}};
  }

  std::optional<FlapsByLift> found() const { return find_flaps_by_lift(samples, attack, min_airspeed); }
};

TEST(FlapsByLift, LowAngleForTheLiftMeansExtendedFlaps) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const FlightWithFlaps flight(seed, 50.0);
    const std::optional<FlapsByLift> found = flight.found();
    ASSERT_TRUE(found);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < flight.flaps.size(); ++i) wrong += found->out[i] != (flight.flaps[i] > 0.0);
    // Two changes, each to a piece of 20 s.
    EXPECT_LE(wrong, 40U) << seed;
    EXPECT_NEAR(found->deficit, 3.0 / (390.0 * 0.88 / 34.0), 0.05) << "3 deg of those that the lift needs";
    EXPECT_THAT(times_of(marked_runs(found->out), flight.samples.time), HasSubstr(", 21:31"));
  }
}

TEST(FlapsByLift, FirstSecondsAfterTakeOffHaveTheStateOfTheNextPiece) {
  FlightWithFlaps flight(1, 50.0);
  for (std::size_t i = 0; i < 15; ++i) flight.samples.motion.airspeed[i] = 40.0;
  const std::optional<FlapsByLift> found = flight.found();
  ASSERT_TRUE(found);
  EXPECT_EQ(std::count(found->out.begin(), found->out.begin() + 15, true), 0) << "ground";
  EXPECT_EQ(std::count(found->out.begin() + 15, found->out.begin() + 100, true), 85)
      << "5 of them in a piece of 20 s that is too short to be judged";
}

TEST(FlapsByLift, LongGapsOfTheAngleHaveNoExtendedFlaps) {
  FlightWithFlaps flight(1, 50.0);
  for (std::size_t i = 115; i < 1500; ++i) flight.attack[i] = std::numeric_limits<double>::quiet_NaN();
  const std::optional<FlapsByLift> found = flight.found();
  ASSERT_TRUE(found);
  // The last piece ends at 120; flaps are marked for 20 s after it.
  EXPECT_EQ(std::count(found->out.begin(), found->out.begin() + 120, true), 120);
  EXPECT_LE(std::count(found->out.begin() + 120, found->out.begin() + 1500, true), 21);
}

TEST(FlapsByLift, AGapBeforeAPieceDoesNotChangeItsSamples) {
  FlightWithFlaps flight(1, 50.0);
  const std::optional<FlapsByLift> whole = flight.found();
  for (std::size_t i = 5480; i < 5510; ++i) flight.attack[i] = std::numeric_limits<double>::quiet_NaN();
  const std::optional<FlapsByLift> found = flight.found();
  ASSERT_TRUE(whole && found);
  EXPECT_EQ(std::count(found->out.begin() + 5520, found->out.end(), true),
            std::count(whole->out.begin() + 5520, whole->out.end(), true));
}

TEST(FlapsByLift, SlowCleanFlightHasNoExtendedFlaps) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const std::optional<FlapsByLift> found = FlightWithFlaps(seed, 0.0).found();
    ASSERT_TRUE(found);
    EXPECT_EQ(std::count(found->out.begin(), found->out.end(), true), 0) << seed;
    EXPECT_LT(found->deviation, 0.1);
  }
}

TEST(FlapsByLift, BriefAngleErrorIsNotExtendedFlaps) {
  FlightWithFlaps flight(1, 0.0);
  for (std::size_t i = 3000; i < 3060; ++i) flight.attack[i] -= 2.0;
  const std::optional<FlapsByLift> found = flight.found();
  ASSERT_TRUE(found);
  EXPECT_EQ(std::count(found->out.begin(), found->out.end(), true), 0);
}

TEST(FlapsByLift, AreUnknownWithoutCleanWingData) {
  EXPECT_FALSE(FlightWithFlaps(1, 50.0, 40.0).found()) << "always slower than flaps may be flown";
  FlightWithFlaps flight(1, 50.0);
  for (double& each : flight.attack) each = 3.0;
  EXPECT_FALSE(flight.found()) << "an angle that is a constant";
}

}  // namespace
