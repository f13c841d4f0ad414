// The spectrum of delta-p, on series whose spectrum is known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "checks/checks.hpp"

using namespace pcor::internal;

namespace pcor {
namespace {

using testing::HasSubstr;

CheckedFlight with_defect(std::vector<double> defect, double step = 1.0) {
  CheckedFlight flight;
  FlightAir& air = flight.air;
  auto samples = std::make_shared<FlightSamples>();
  samples->name = "made.nc";
  const std::size_t count = defect.size();
  samples->step = step;
  for (std::size_t i = 0; i < count; ++i) samples->time.push_back(1e9 + step * static_cast<double>(i));
  air.samples = std::move(samples);
  air.flying.assign(count, true);
  air.pressure.assign(count, 700.0);
  air.mach.assign(count, 0.36);
  air.airspeed.assign(count, 120.0);
  for (std::size_t i = 0; i < count; ++i) air.measured_static.push_back(i % 2 == 0 ? 700.0 : 700.02);
  air.laser.emplace();
  air.laser->static_defect = std::move(defect);
  return flight;
}

std::vector<double> white(std::size_t count, double rms, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal(0.0, rms);
  std::vector<double> values(count);
  for (double& value : values) value = normal(engine);
  return values;
}

TEST(SpectrumCheck, FindsTheFloorOfWhiteNoise) {
  const CheckResult result = check_spectrum({with_defect(white(8000, 0.2, 1))});
  ASSERT_TRUE(result.was_run) << result.reason;
  // Three standard errors as stated, which must themselves be small: a thousand independent values and more.
  EXPECT_NEAR(result.number("floor_hpa"), 0.2, 3.0 * result.number("floor_stderr_hpa"));
  EXPECT_LT(result.number("floor_stderr_hpa"), 0.01);
  EXPECT_NEAR(result.number("slope"), 0.0, 3.0 * result.number("slope_stderr"));
  EXPECT_LT(result.number("slope_stderr"), 0.15);
  // 1 m/s more at the same total pressure and temperature is a Mach number of 0.36308 instead of 0.36, and so
  // 1.06 hPa less.
  EXPECT_NEAR(result.number("floor_m_s"), result.number("floor_hpa") / 1.06, 0.002);
  EXPECT_THAT(result.finding, HasSubstr("flattens"));
  EXPECT_EQ(result.verdict, CheckVerdict::consistent);
}

TEST(SpectrumCheck, ExcessNoiseIsInconsistent) {
  EXPECT_EQ(check_spectrum({with_defect(white(4000, 0.6, 2))}).verdict, CheckVerdict::inconsistent);
}

/// A random walk, smoothed over two samples: frequency to the -2 and steeper.
std::vector<double> falling(double step) {
  const std::vector<double> steps = white(8000, step, 3);
  std::vector<double> walk(steps.size());
  double position = 0.0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double before = position;
    position = 0.99 * position + steps[i];
    walk[i] = 0.5 * (before + position);
  }
  return walk;
}

TEST(SpectrumCheck, FallingTurbulenceSpectrumIsReported) {
  const CheckResult result = check_spectrum({with_defect(falling(0.02))});
  ASSERT_TRUE(result.was_run);
  EXPECT_LT(result.number("slope"), -1.5);
  EXPECT_THAT(result.finding, HasSubstr("still falls"));
}

// Where the spectrum does not flatten, its power is an upper limit of the noise, which contradicts nothing.
TEST(SpectrumCheck, TurbulenceAboveTheLimitIsNoEvidenceOfNoise) {
  const CheckResult result = check_spectrum({with_defect(falling(4.0))});
  ASSERT_TRUE(result.was_run) << result.reason;
  EXPECT_GT(result.number("floor_hpa"), 0.3);
  EXPECT_NE(result.verdict, CheckVerdict::inconsistent);
}

TEST(SpectrumCheck, OctavesHaveTheVarianceOfTheSeries) {
  // White noise: every octave has half the variance of the next shorter one, and together they have all but
  // that of periods beyond 256 s and of the line, 1 %.
  const CheckResult result = check_spectrum({with_defect(white(20000, 0.3, 4))});
  const auto& bars = result.bars;
  double sum = 0.0;
  for (std::size_t i = 0; i < bars.size(); ++i) {
    sum += bars[i].value * bars[i].value;
    if (i == 0) continue;
    const double ratio = bars[i - 1].value / bars[i].value;
    EXPECT_NEAR(ratio, std::sqrt(2.0), 4.0 * std::hypot(bars[i].error / bars[i].value, 0.01) * ratio) << i;
  }
  EXPECT_NEAR(sum / 0.09, 1.0, 0.05);
}

TEST(SpectrumCheck, UnusedFlightsAreThoseWithTheSeries) {
  const CheckedFlight fast = with_defect(white(8000, 0.2, 6), 0.04);
  const CheckedFlight slow = with_defect(white(1000, 0.2, 7));
  CheckedFlight without_laser = slow;
  without_laser.air.laser.reset();
  EXPECT_THAT(check_spectrum({fast, without_laser}).notes, testing::IsEmpty());
  EXPECT_THAT(check_spectrum({fast, slow, without_laser}).notes,
              testing::ElementsAre(testing::Field(&Note::text, HasSubstr("1 of 3 flights are not used"))));
}

TEST(SpectrumCheck, ReasonForNoResultIsReported) {
  std::vector<double> holes = white(4000, 0.2, 5);
  for (std::size_t i = 0; i < holes.size(); i += 200) holes[i] = std::numeric_limits<double>::quiet_NaN();
  const CheckResult result = check_spectrum({with_defect(holes)});
  EXPECT_FALSE(result.was_run);
  EXPECT_THAT(result.reason, HasSubstr("gap"));
}

}  // namespace
}  // namespace pcor
