#include "residuals/masks.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <vector>

using pcor::internal::find_bursts;
using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::Ge;
using testing::IsEmpty;
using testing::Le;

namespace {

using Series = std::vector<double>;

/// An hour of a dynamic pressure with gusts, and the residual of a reference that responds to them.
struct GustyFlight {
  Series pressure{};
  Series residual{};
  Series time{};
  std::mt19937_64 engine{1};
  std::normal_distribution<double> normal{};

  GustyFlight() {
    for (int i = 0; i < 3600; ++i) {
      const double gusts = i > 1800 && i < 2400 ? 2.0 : 0.2;  // hPa
      time.push_back(i);
      pressure.push_back(70.0 + 15.0 * std::sin(i / 170.0) + 3.0 * std::sin(i / 3.0) +
                         gusts * normal(engine));
      residual.push_back(0.3 * normal(engine));
    }
  }

  void disturb(std::size_t first, std::size_t count, double offset, double noise) {
    for (std::size_t i = first; i < first + count; ++i) {
      const double error = offset + noise * normal(engine);
      pressure[i] += error;
      residual[i] += 0.9 * error;
    }
  }

  std::vector<std::size_t> bursts() const { return find_bursts(residual, {&pressure}, time, 1.0); }
};

TEST(Bursts, GustsAndManoeuvresAreNotBursts) {
  // The gusts begin and end within seconds: the residual shows no part of them.
  EXPECT_THAT(GustyFlight().bursts(), IsEmpty());
}

TEST(Bursts, WholeBurstIsMasked) {
  for (const std::size_t length : {1U, 5U, 15U}) {
    GustyFlight flight;
    flight.disturb(1000, length, 8.0, 0.0);
    // The sample before and the sample after the jump, and three more on either side, are masked.
    EXPECT_THAT(flight.bursts(), AllOf(Each(Ge(996U)), Each(Le(1003U + length)))) << length;
    for (std::size_t i = 1000; i < 1000 + length; ++i) EXPECT_THAT(flight.bursts(), Contains(i)) << length;
  }
}

TEST(Bursts, ShortNoiseIsABurst) {
  GustyFlight flight;
  flight.disturb(1000, 18, 0.0, 6.0);
  const std::vector<std::size_t> bursts = flight.bursts();
  EXPECT_THAT(bursts, AllOf(Each(Ge(996U)), Each(Le(1021U))));
  for (std::size_t i = 1000; i < 1018; ++i) EXPECT_THAT(bursts, Contains(i));
}

TEST(Bursts, StepOfTheResidualAloneIsNotABurst) {
  GustyFlight flight;
  for (std::size_t i = 1000; i < 1015; ++i) flight.residual[i] += 8.0;
  EXPECT_THAT(flight.bursts(), IsEmpty()) << "the pressure returns to its old level";
}

TEST(Bursts, LongNoiseIsNotABurst) {
  GustyFlight flight;
  flight.disturb(1000, 120, 0.0, 6.0);
  EXPECT_THAT(flight.bursts(), IsEmpty()) << "a sensor that has become noisy is not a burst";
}

}  // namespace
