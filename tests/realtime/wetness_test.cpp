#include <pcor/realtime/wetness.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/constants.hpp"

namespace {

using pcor::Wetness;
using pcor::test::missing;

constexpr double cloud = 0.3;  // g/m3

// Outside, in cloud from 10 to 30 s, outside to 90 s; means over whole seconds.
std::vector<double> pass(int rate, double drying) {
  Wetness wetness(rate, drying);
  std::vector<double> means;
  for (int second = 0; second < 90; ++second) {
    double sum = 0.0;
    for (int i = 0; i < rate; ++i) sum += wetness(second >= 10 && second < 30 ? cloud : 0.0);
    means.push_back(sum / rate);
  }
  return means;
}

// The integral of exp(-t/tau) over a second that begins at t.
double mean_of_decay(double t, double tau) { return tau * (std::exp(-t / tau) - std::exp(-(t + 1.0) / tau)); }

TEST(Wetness, HasAFirstOrderResponse) {
  constexpr double drying = 12.0;
  const std::vector<double> means = pass(1, drying);
  EXPECT_EQ(means[9], 0.0);
  const double wet = 1.0 - std::exp(-20.0 / Wetness::wetting);  // where it leaves the cloud
  for (int second = 10; second < 30; ++second)
    EXPECT_NEAR(means[static_cast<std::size_t>(second)], 1.0 - mean_of_decay(second - 10, Wetness::wetting),
                1e-14);
  for (int second = 30; second < 90; ++second)
    EXPECT_NEAR(means[static_cast<std::size_t>(second)], wet * mean_of_decay(second - 30, drying), 1e-14);
}

TEST(Wetness, IsIndependentOfTheSampleRate) {
  for (const double drying : {0.01, 1.0, 20.0}) {
    const std::vector<double> slow = pass(1, drying);
    for (const int rate : {5, 25, 50}) {
      const std::vector<double> fast = pass(rate, drying);
      for (std::size_t i = 0; i < slow.size(); ++i) EXPECT_NEAR(fast[i], slow[i], 1e-12) << rate << ' ' << i;
    }
  }
}

TEST(Wetness, ZeroDryingTimeDriesAtOnce) {
  const std::vector<double> means = pass(1, 0.0);
  EXPECT_GT(means[29], 0.99);
  EXPECT_EQ(means[30], 0.0);
}

TEST(Wetness, StartsWetInCloudAndDryOutside) {
  Wetness wetness(1.0, 10.0);
  EXPECT_EQ(wetness(cloud), 1.0) << "long in cloud";
  EXPECT_GT(wetness(0.0), 0.9);
  wetness.reset();
  EXPECT_EQ(wetness(0.0), 0.0) << "nothing is known of the cloud before";
}

TEST(Wetness, MissingLiquidWaterGivesNan) {
  Wetness wetness(1.0, 10.0);
  EXPECT_TRUE(std::isnan(wetness(missing)));
  wetness(cloud);
  EXPECT_TRUE(std::isnan(wetness(missing)));
  EXPECT_NEAR(wetness(0.0), mean_of_decay(1.0, 10.0) * (1.0 - std::exp(-1.0)), 1e-14)
      << "dried for two seconds";
}

}  // namespace
