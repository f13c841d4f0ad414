#include "residuals/masks.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

using pcor::internal::find_unlocked;
using testing::Contains;
using testing::Each;
using testing::Ge;
using testing::IsEmpty;
using testing::SizeIs;

namespace {

/// An hour in which speed and height change, and a laser that knows the airspeed.
struct FlightWithLaser {
  std::vector<double> airspeed{};  ///< airspeed derived from the pressures
  std::vector<double> ratio{};
  std::vector<double> beam{};
  std::vector<std::size_t> samples{};

  /// @param defect of the pressures, a part of p @param noise of the laser, m/s
  explicit FlightWithLaser(double defect, double speed = 220.0, double noise = 0.2) {
    std::mt19937_64 engine(1);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 3600; ++i) {
      const double truth = speed * (1.0 + 0.2 * std::sin(i / 170.0)) + 2.0 * std::sin(i / 9.0);
      const double sound = 320.0 - 15.0 * std::sin(i / 900.0);
      // q/p = 0.7 M^2 is accurate enough here, and a low pressure makes it too large.
      const double mach = truth / sound;
      const double q = 0.7 * mach * mach;
      ratio.push_back((q + defect) / (1.0 - defect));
      airspeed.push_back(sound * std::sqrt(ratio.back() / 0.7));
      beam.push_back(truth + noise * normal(engine));
    }
    samples.resize(beam.size());
    std::iota(samples.begin(), samples.end(), 0);
  }

  std::vector<std::size_t> unlocked() const { return find_unlocked(beam, airspeed, ratio, samples); }
};

TEST(LaserLock, WrongPressuresKeepTheLock) {
  for (const double defect : {-0.03, -0.01, 0.0, 0.01, 0.03}) {
    const FlightWithLaser flight(defect);
    double maximum = 0.0;
    for (std::size_t i = 0; i < flight.beam.size(); ++i)
      maximum = std::max(maximum, std::abs(flight.beam[i] - flight.airspeed[i]));
    if (std::abs(defect) == 0.03) {
      EXPECT_GT(maximum, 8.0) << "a limit in m/s would take samples out";
    }
    EXPECT_THAT(flight.unlocked(), IsEmpty()) << defect;
  }
}

TEST(LaserLock, RandomBeamSpeedIsUnlocked) {
  FlightWithLaser flight(0.02);
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> anything(50.0, 400.0);
  for (std::size_t i = 1000; i < 1300; ++i) flight.beam[i] = anything(engine);
  const std::vector<std::size_t> unlocked = flight.unlocked();
  for (std::size_t i = 1000; i < 1300; ++i) EXPECT_THAT(unlocked, Contains(i));
  EXPECT_THAT(unlocked, SizeIs(testing::Le(302U)));
}

TEST(LaserLock, ShiftedBeamSpeedIsUnlocked) {
  FlightWithLaser flight(0.02);
  for (std::size_t i = 2000; i < 3000; ++i) flight.beam[i] += 12.0;
  EXPECT_THAT(flight.unlocked(), SizeIs(1000U));
  EXPECT_THAT(flight.unlocked(), Each(Ge(2000U)));
}

TEST(LaserLock, IsNotLostInGusts) {
  FlightWithLaser flight(0.02);
  // Error caused by a flap or a sideslip, 1.5 hPa at 70 m/s: 1.8 m/s.
  FlightWithLaser slow(0.0, 70.0, 0.05);
  for (std::size_t i = 500; i < 700; ++i) slow.beam[i] += 1.8;
  EXPECT_THAT(slow.unlocked(), IsEmpty());
  // One sample in a hundred is wrong by five standard deviations.
  for (std::size_t i = 0; i < flight.beam.size(); i += 100) flight.beam[i] += 1.0;
  EXPECT_THAT(flight.unlocked(), IsEmpty());
}

TEST(LaserLock, TooFewSamplesAreNotTested) {
  FlightWithLaser flight(0.02);
  flight.samples.resize(20);
  flight.beam[5] += 100.0;
  EXPECT_THAT(flight.unlocked(), IsEmpty());
}

}  // namespace
