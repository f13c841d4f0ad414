#include <pcor/realtime/low_pass.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <vector>

#include "support/constants.hpp"

namespace {

using pcor::LowPass;
using pcor::Quality;
using pcor::QualityFlags;
using pcor::Quantity;
using pcor::State;
using pcor::test::infinity;
using pcor::test::missing;
using pcor::test::pi;
using testing::ElementsAre;

constexpr double low_pass_rates[] = {1.0, 25.0};
const Quantity filtered_quantity = pcor::extra_quantity(0);  // a quantity whose values are all valid

struct Result {
  double value;
  bool window_incomplete;
};

// The filter, sample by sample.
class Filter {
 public:
  explicit Filter(double rate) : filter_(Quantity::lams_temperature, filtered_quantity, rate) {}

  Result operator()(double value) {
    State<double> state;
    QualityFlags flags;
    state[Quantity::lams_temperature] = value;
    filter_.compute(state, flags);
    return {state[filtered_quantity], flags.has(Quality::filter_window_incomplete)};
  }

  void reset() { filter_.reset(); }
  std::size_t delay() const { return filter_.delay(); }

 private:
  LowPass filter_;
};

// Filter output of a series, each value at its sample; the ends have part of a window.
std::vector<Result> filtered(double rate, const std::vector<double>& series) {
  Filter filter(rate);
  std::vector<Result> results;
  for (std::size_t i = 0; i < series.size() + filter.delay(); ++i) {
    const Result result = filter(i < series.size() ? series[i] : missing);
    if (i >= filter.delay()) results.push_back(result);
  }
  return results;
}

// The amplitude that the filter leaves of a period (s), and the part of it that is shifted by a quarter.
struct Response {
  double in_phase;
  double in_quadrature;
};

Response low_pass_response(double rate, double period) {
  Filter filter(rate);
  Response sum{0.0, 0.0};
  const auto phase_of = [&](double i) { return 2.0 * pi * i / (rate * period) + 0.7; };
  double squares = 0.0, cross = 0.0, products[2] = {0.0, 0.0}, quadrature_squares = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double value = filter(std::cos(phase_of(i))).value;
    if (i < 1000) continue;
    const double then = phase_of(i - static_cast<double>(filter.delay()));
    squares += std::cos(then) * std::cos(then);
    quadrature_squares += std::sin(then) * std::sin(then);
    cross += std::cos(then) * std::sin(then);
    products[0] += value * std::cos(then);
    products[1] += value * std::sin(then);
  }
  const double determinant = squares * quadrature_squares - cross * cross;
  sum.in_phase = (products[0] * quadrature_squares - products[1] * cross) / determinant;
  sum.in_quadrature = (products[1] * squares - products[0] * cross) / determinant;
  return sum;
}

TEST(LowPass, ImpossibleOvershootIsMissing) {
  LowPass filter(Quantity::lams_temperature, Quantity::filtered_lams_temperature, 25.0);
  std::size_t missing_values = 0;
  for (std::size_t i = 0; i < 1000; ++i) {
    State<double> state;
    QualityFlags flags;
    state[Quantity::lams_temperature] = i < 500 ? 200.0 : 399.0;
    filter.compute(state, flags);
    const double value = state[Quantity::filtered_lams_temperature];
    ASSERT_FALSE(value > 400.0) << i;
    if (i < 2 * filter.delay() || !std::isnan(value)) continue;
    ASSERT_TRUE(flags.has(Quality::filter_window_incomplete)) << i;
    ++missing_values;
  }
  EXPECT_GT(missing_values, 0U);
}

}  // namespace

TEST(LowPass, DeclaresInputsAndOutputs) {
  const LowPass filter(Quantity::lams_temperature, filtered_quantity, 1.0);
  EXPECT_THAT(filter.inputs(), ElementsAre(Quantity::lams_temperature));
  EXPECT_THAT(filter.outputs(), ElementsAre(filtered_quantity));
}

TEST(LowPass, ResultIsDelayed) {
  EXPECT_EQ(LowPass::delay(1.0), 6U);
  EXPECT_EQ(LowPass::delay(25.0), 150U);
  for (const double rate : low_pass_rates) {
    Filter filter(rate);
    for (int i = 0; i < 1000; ++i) {
      const Result result = filter(250.0 + 0.01 * i);
      if (i < static_cast<int>(filter.delay())) {
        EXPECT_TRUE(std::isnan(result.value)) << "no sample is due";
        EXPECT_TRUE(result.window_incomplete);
      } else if (i >= 2 * static_cast<int>(filter.delay())) {
        // Rounding of 250 K is 3e-14 K, and hundreds of departures are added up.
        EXPECT_NEAR(result.value, 250.0 + 0.01 * (i - static_cast<double>(filter.delay())), 1e-12);
      }
    }
  }
}

TEST(LowPass, PassesConstantsExactly) {
  for (const double rate : low_pass_rates) {
    for (const double constant : {271.3, -5.0, 0.0, 1e-3}) {
      std::vector<double> series(700, constant);
      for (const std::size_t gone : {90U, 91U, 200U, 300U, 302U, 420U}) series[gone] = missing;
      const std::vector<Result> results = filtered(rate, series);
      std::size_t passed = 0;
      for (const Result& result : results) {
        if (std::isnan(result.value)) continue;
        EXPECT_EQ(result.value, constant);
        ++passed;
      }
      EXPECT_GT(passed, 600U);
    }
  }
}

// For any missing samples, a line passes or there is no value.
TEST(LowPass, PassesALineWithMissingSamples) {
  std::mt19937 random(20120106);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (const double rate : low_pass_rates) {
    for (const double share : {0.0, 0.02, 0.2}) {
      std::vector<double> series;
      for (int i = 0; i < 2000; ++i) series.push_back(unit(random) < share ? missing : 250.0 + 0.02 * i);
      const std::vector<Result> results = filtered(rate, series);
      std::size_t passed = 0;
      for (std::size_t i = 0; i < series.size(); ++i) {
        EXPECT_TRUE(!std::isnan(series[i]) || std::isnan(results[i].value))
            << "no result without its own sample";
        EXPECT_EQ(results[i].window_incomplete, std::isnan(results[i].value) && !std::isnan(series[i]));
        if (std::isnan(results[i].value)) continue;
        EXPECT_NEAR(results[i].value, 250.0 + 0.02 * static_cast<double>(i), 1e-11);
        ++passed;
      }
      EXPECT_GT(passed, share < 0.1 ? 1800U : 500U) << rate << " Hz, " << share;
    }
  }
}

TEST(LowPass, PassesPeriodsOfSixSecondsWithoutShift) {
  for (const double rate : low_pass_rates) {
    for (const double period : {6.0, 7.3, 8.0, 10.1, 12.0, 31.0, 60.0, 300.0}) {
      const Response response = low_pass_response(rate, period);
      EXPECT_NEAR(response.in_phase, 1.0, 0.006) << rate << " Hz, " << period << " s";
      // A symmetric filter has no delay; the remainder is the rounding of 3000 products.
      EXPECT_NEAR(response.in_quadrature, 0.0, 1e-9) << rate << " Hz, " << period << " s";
    }
    EXPECT_NEAR(low_pass_response(rate, 3.0).in_phase, 0.5, 0.005) << "half the amplitude";
  }
}

TEST(LowPass, RemovesPeriodsUnderThreeSeconds) {
  for (const double period : {2.0, 1.7, 1.5, 1.3, 1.0, 0.7, 0.3, 0.1}) {
    EXPECT_LT(std::abs(low_pass_response(25.0, period).in_phase), 0.003) << period;
    EXPECT_NEAR(low_pass_response(25.0, period).in_quadrature, 0.0, 1e-9) << period;
  }
  // Near 3 s it is on its way; at 1 Hz 2 s is the shortest period that there is.
  for (const double rate : low_pass_rates) {
    EXPECT_LT(std::abs(low_pass_response(rate, 2.2).in_phase), 0.013) << rate;
    EXPECT_LT(std::abs(low_pass_response(rate, 2.5).in_phase), 0.14) << rate;
  }
  std::vector<double> fastest;
  for (int i = 0; i < 100; ++i) fastest.push_back(i % 2 == 0 ? 1.0 : -1.0);
  EXPECT_LT(std::abs(filtered(1.0, fastest)[50].value), 0.001);
}

TEST(LowPass, FlagsAnIncompleteWindow) {
  for (const double rate : low_pass_rates) {
    Filter filter(rate);
    const std::size_t delay = filter.delay();
    for (std::size_t i = 0; i < 3 * delay; ++i) filter(260.0);
    // One sample between missing ones: it has its own weight alone, 2/3 at 1 Hz and 2/75 at 25 Hz.
    for (std::size_t i = 0; i < delay; ++i) filter(missing);
    filter(261.0);
    for (std::size_t i = 1; i < delay; ++i) filter(missing);
    const Result alone = filter(missing);
    EXPECT_EQ(std::isnan(alone.value), rate > 1.0);
    EXPECT_EQ(alone.window_incomplete, rate > 1.0);
  }
}

TEST(LowPass, InfinityCountsAsMissing) {
  std::vector<double> infinite(60, 260.0), absent(60, 260.0);
  for (const std::size_t i : {20U, 33U, 34U}) {
    infinite[i] = i % 2 == 0 ? infinity : -infinity;
    absent[i] = missing;
  }
  const std::vector<Result> ours = filtered(1.0, infinite), expected = filtered(1.0, absent);
  for (std::size_t i = 0; i < ours.size(); ++i) {
    EXPECT_TRUE(ours[i].value == expected[i].value ||
                (std::isnan(ours[i].value) && std::isnan(expected[i].value)))
        << i;
  }
}

TEST(LowPass, ResetRestartsTheState) {
  for (const double rate : low_pass_rates) {
    Filter fresh(rate), used(rate);
    for (int i = 0; i < 777; ++i) used(1000.0 * std::sin(i));
    used.reset();
    for (int i = 0; i < 777; ++i) {
      const double value = 260.0 + std::sin(0.1 * i);
      const Result expected = fresh(value), found = used(value);
      EXPECT_TRUE(found.value == expected.value || (std::isnan(found.value) && std::isnan(expected.value)));
      EXPECT_EQ(found.window_incomplete, expected.window_incomplete);
    }
  }
}

TEST(LowPass, FlagsTheInitialDelay) {
  for (const double rate : low_pass_rates) {
    Filter filter(rate);
    for (int begin = 0; begin < 2; ++begin) {
      for (std::size_t i = 0; i < 3 * filter.delay(); ++i) {
        const Result result = filter(260.0);
        EXPECT_TRUE(i >= filter.delay() || std::isnan(result.value)) << i;
        EXPECT_EQ(std::isnan(result.value), result.window_incomplete) << i;
      }
      filter.reset();
    }
  }
}

TEST(LowPass, LowRatesAreNotFiltered) {
  for (const double rate : {0.1, 0.5, 2.0 / 3.0}) {
    EXPECT_EQ(LowPass::delay(rate), 0U);
    Filter filter(rate);
    for (const double value : {260.0, 270.0, 255.0}) EXPECT_EQ(filter(value).value, value);
  }
}
