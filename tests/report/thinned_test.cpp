#include "report/thinned.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace pcor::internal::report {
namespace {

using testing::ElementsAre;

std::vector<double> seconds(std::size_t count) {
  std::vector<double> time;
  for (std::size_t i = 0; i < count; ++i) time.push_back(static_cast<double>(i));
  return time;
}

TEST(Thinned, KeepsTheEndsOfAStraightLine) {
  const std::vector<double> time = seconds(50);
  EXPECT_THAT(thinned(time, {0}, {{&time, 1.0}}, 100, 1e-9), ElementsAre(0U, 49U));
}

TEST(Thinned, KeepsTheCornersOnly) {
  const std::vector<double> time = seconds(40);
  std::vector<double> corner(40, 0.0);
  for (std::size_t i = 10; i < 40; ++i) corner[i] = static_cast<double>(std::min<std::size_t>(i, 30) - 10);
  EXPECT_THAT(thinned(time, {0}, {{&corner, 1.0}}, 100, 1e-9), ElementsAre(0U, 10U, 30U, 39U));
}

TEST(Thinned, FlightsAreThinnedSeparately) {
  const std::vector<double> time{0.0, 1.0, 2.0, 0.0, 1.0, 2.0};
  const std::vector<double> series{0.0, 0.0, 0.0, 5.0, 5.0, 5.0};
  EXPECT_THAT(thinned(time, {0, 3}, {{&series, 1.0}}, 100, 1e-9), ElementsAre(0U, 2U, 3U, 5U));
}

TEST(Thinned, OmitsMissingValues) {
  const std::vector<double> time = seconds(5);
  const std::vector<double> series{std::nan(""), 1.0, std::nan(""), 7.0, 2.0};
  EXPECT_THAT(thinned(time, {0}, {{&series, 1.0}}, 100, 1e-9), ElementsAre(1U, 3U, 4U));
}

TEST(Thinned, LimitedCountKeepsTheHighestWeight) {
  const std::vector<double> time = seconds(30);
  std::vector<double> small(30, 0.0);
  std::vector<double> large(30, 0.0);
  small[10] = 5.0;
  large[20] = 1.0;
  EXPECT_THAT(thinned(time, {0}, {{&small, 1.0}, {&large, 100.0}}, 1, 1e-9), ElementsAre(0U, 20U, 29U));
}

TEST(Thinned, RepresentsAWaveWithinTheTolerance) {
  const std::size_t count = 2000;
  const std::vector<double> time = seconds(count);
  std::vector<double> wave;
  for (const double t : time) wave.push_back(std::sin(0.02 * t));
  constexpr double enough = 1e-3;
  const std::vector<std::size_t> kept = thinned(time, {0}, {{&wave, 1.0}}, count, enough);
  EXPECT_LT(kept.size(), count / 3);  // lines of 4.5 s would do, were they all as long
  for (std::size_t k = 0; k + 1 < kept.size(); ++k) {
    for (std::size_t i = kept[k]; i <= kept[k + 1]; ++i) {
      const double part = (time[i] - time[kept[k]]) / (time[kept[k + 1]] - time[kept[k]]);
      EXPECT_LE(std::abs(wave[i] - wave[kept[k]] - part * (wave[kept[k + 1]] - wave[kept[k]])),
                enough * 1.0001);
    }
  }
}

}  // namespace
}  // namespace pcor::internal::report
