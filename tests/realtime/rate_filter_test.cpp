#include <pcor/realtime/rate_filter.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <random>
#include <vector>

#include "support/constants.hpp"

namespace {

using pcor::RateFilter;
using pcor::test::missing;
using pcor::test::pi;
using Complex = std::complex<double>;

constexpr double rate_filter_rates[] = {1.0, 5.0, 25.0, 50.0};
constexpr double delays[] = {0.0, 0.05, 0.3, 1.0, 1.5, -1.7};

/// A function of time at the samples of the widest window, 0 s in question.
template <class Function>
std::vector<double> around(RateFilter& filter, double rate, const Function& function) {
  std::vector<double> samples;
  const auto before = static_cast<double>(filter.before());
  for (std::size_t k = 0; k <= filter.before() + filter.after(); ++k)
    samples.push_back(function((static_cast<double>(k) - before) / rate));
  return samples;
}

double rate_of(RateFilter& filter, const std::vector<double>& samples) {
  return filter(samples.data() + filter.before(), filter.before(), filter.after());
}

template <class Function>
double rate_of(RateFilter& filter, double rate, const Function& function) {
  return rate_of(filter, around(filter, rate, function));
}

/// Response to exp(i 2 pi t / period) at 0 s.
Complex frequency_response(RateFilter& filter, double rate, double period) {
  return {rate_of(filter, rate, [&](double t) { return std::cos(2.0 * pi * t / period); }),
          rate_of(filter, rate, [&](double t) { return std::sin(2.0 * pi * t / period); })};
}

Complex ideal(double delay, double period) {
  const Complex turn(0.0, 2.0 * pi / period);
  return delay == 0.0 ? turn : (1.0 - std::exp(-delay * turn)) / delay;
}

TEST(RateFilter, PassesConstantsAndStraightLines) {
  for (const double rate : rate_filter_rates) {
    for (const double delay : delays) {
      RateFilter filter(rate, delay);
      EXPECT_EQ(rate_of(filter, rate, [](double) { return 701.3; }), 0.0);
      // Rounding of weights of up to 50 per sample, a few hundred of them.
      EXPECT_NEAR(rate_of(filter, rate, [](double t) { return 701.3 - 1.7 * t; }), -1.7, 1e-9);
    }
  }
}

TEST(RateFilter, PassesStraightLinesNearTheEnds) {
  for (const double rate : rate_filter_rates) {
    RateFilter filter(rate, 0.3);
    const std::vector<double> line = around(filter, rate, [](double t) { return 3.0 + 2.0 * t; });
    for (std::size_t before = 0; before <= filter.before(); ++before) {
      for (const std::size_t after : {std::size_t{1}, std::size_t{4}, filter.after()}) {
        EXPECT_NEAR(filter(line.data() + filter.before(), before, after), 2.0, 1e-9)
            << before << ' ' << after;
        EXPECT_NEAR(filter(line.data() + filter.before(), after, filter.after() - before % 3), 2.0, 1e-9);
      }
    }
    EXPECT_TRUE(std::isnan(filter(line.data() + filter.before(), 0, 0)));
  }
}

TEST(RateFilter, ResponseIsIdealAboveTheCutOffPeriod) {
  // Half a zero's width of the Hann window from the cut-off: 1 % of ripple.
  for (const double rate : rate_filter_rates) {
    const double shortest = rate == 1.0 ? 3.0 : 1.5;
    for (const double delay : delays) {
      RateFilter filter(rate, delay);
      for (double period = shortest; period < 40.0; period *= 1.3) {
        const Complex requested = ideal(delay, period);
        EXPECT_LT(std::abs(frequency_response(filter, rate, period) - requested),
                  0.015 * std::abs(ideal(0.0, period)))
            << rate << " Hz, delay " << delay << " s, period " << period << " s";
      }
    }
  }
}

TEST(RateFilter, RemovesShortPeriods) {
  for (const double rate : {5.0, 25.0, 50.0}) {
    RateFilter filter(rate);
    const double half = std::abs(frequency_response(filter, rate, 1.0)) / std::abs(ideal(0.0, 1.0));
    EXPECT_NEAR(half, 0.5, 0.01);
    for (const double period : {0.7, 0.5})
      EXPECT_LT(std::abs(frequency_response(filter, rate, period)), 0.01 * std::abs(ideal(0.0, period)));
  }
}

TEST(RateFilter, CorrectsAFirstOrderLag) {
  // Known response of a lag tau to a sine: y = Re(H exp(i w t)), H = 1/(1 + i w tau).
  for (const double rate : {5.0, 25.0}) {
    for (const double tau : {0.05, 0.3, 1.0, 8.0}) {
      for (const double period : {2.0, 5.0, 20.0}) {
        const double turn = 2.0 * pi / period;
        const Complex lag = 1.0 / Complex(1.0, turn * tau);
        const auto lagged = [&](double t) { return std::real(lag * std::exp(Complex(0.0, turn * t + 0.4))); };
        RateFilter filter(rate);
        const double corrected = lagged(0.0) + tau * rate_of(filter, rate, lagged);
        // 0.2 % of the derivative at these periods.
        EXPECT_NEAR(corrected, std::cos(0.4), 0.003 * tau * turn * std::abs(lag) + 1e-9);
      }
    }
  }
}

TEST(RateFilter, CorrectsALagOfARamp) {
  // A ramp from -1 s on, through a lag of tau: t + 1 - tau (1 - exp(-(t + 1)/tau)). Periods under 1 s of its
  // corner are not restored: 3 % of tau a second later.
  constexpr double tau = 0.3;
  RateFilter filter(25.0);
  const auto lagged = [](double t) {
    return t < -1.0 ? 0.0 : t + 1.0 - tau * (1.0 - std::exp(-(t + 1.0) / tau));
  };
  EXPECT_LT(lagged(0.0), 0.72);
  EXPECT_NEAR(lagged(0.0) + tau * rate_of(filter, 25.0, lagged), 1.0, 0.03 * tau);
}

TEST(RateFilter, TimeReversalChangesOnlyTheSign) {
  // The samples in the other order have the opposite rate, and a delay is then one of the other sign.
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal;
  for (const double delay : delays) {
    RateFilter filter(25.0, delay);
    RateFilter back(25.0, -delay);
    ASSERT_EQ(filter.before(), back.after());
    std::vector<double> samples(filter.before() + filter.after() + 1);
    for (double& each : samples) each = normal(engine);
    const std::vector<double> reversed(samples.rbegin(), samples.rend());
    EXPECT_NEAR(rate_of(filter, samples), -rate_of(back, reversed), 1e-9);
  }
}

TEST(RateFilter, ReducesNoise) {
  // The integral of (2 pi f)^2 over the remaining part of the band, cut off sharply at 1 Hz: 0.72 of 12.5
  // Hz; the slope of the cut-off adds to it.
  EXPECT_NEAR(RateFilter(25.0).gain(), std::pow(2.0 * pi, 2) / 3.0 / 12.5, 0.2);
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  RateFilter filter(25.0);
  double squares = 0.0;
  constexpr int draws = 2000;
  for (int i = 0; i < draws; ++i) {
    const double rate = rate_of(filter, 25.0, [&](double) { return normal(engine); });
    squares += rate * rate;
  }
  EXPECT_NEAR(squares / draws / filter.gain(), 1.0, 0.16);  // five deviations of chi-squared
}

TEST(RateFilter, InterpolatesShortGaps) {
  for (const double rate : rate_filter_rates) {
    RateFilter filter(rate);
    std::vector<double> line = around(filter, rate, [](double t) { return 5.0 - t; });
    line.front() = missing;
    line[filter.before() - 1] = missing;
    line[filter.before() + 2] = std::numeric_limits<double>::infinity();
    EXPECT_NEAR(rate_of(filter, line), -1.0, 1e-9);
    line[filter.before()] = missing;
    EXPECT_EQ(std::isnan(rate_of(filter, line)), rate == 1.0) << "two in a row are too many at 1 Hz";
  }
}

TEST(RateFilter, MissingSampleCausesASmallError) {
  // A sine of 4 s at 25 Hz, of which one sample of 40 ms is missing: the line over it errs by 0.2 %.
  RateFilter filter(25.0);
  std::vector<double> sine = around(filter, 25.0, [](double t) { return std::sin(0.5 * pi * t); });
  const double whole = rate_of(filter, sine);
  for (const std::size_t position : {filter.before() - 1, filter.before() + 7, std::size_t{12}}) {
    std::vector<double> holed = sine;
    holed[position] = missing;
    EXPECT_NEAR(rate_of(filter, holed), whole, 0.002 * whole);
  }
}

TEST(RateFilter, IgnoresSamplesBeyondALongGap) {
  RateFilter filter(1.0);
  std::vector<double> samples = around(filter, 1.0, [](double t) { return 5.0 - t; });
  samples[filter.before() + 2] = samples[filter.before() + 3] = missing;
  const double rate = rate_of(filter, samples);
  EXPECT_NEAR(rate, -1.0, 1e-9);
  for (std::size_t k = filter.before() + 4; k < samples.size(); ++k) samples[k] = 1e6;
  EXPECT_EQ(rate_of(filter, samples), rate);
}

TEST(RateFilter, HalfSampleDelayIsAccurate) {
  RateFilter filter(1.0, 0.5);
  for (const double period : {10.0, 20.0, 40.0})
    EXPECT_LT(std::abs(frequency_response(filter, 1.0, period) - ideal(0.5, period)),
              0.006 * std::abs(ideal(0.5, period)))
        << period;
}

TEST(RateFilter, GivesNanInAGapWithinTheDelay) {
  // Values 5 s ago are unknown: 3 s ago is the start.
  RateFilter filter(1.0, 5.0);
  const std::vector<double> line = around(filter, 1.0, [](double t) { return 2.0 * t; });
  EXPECT_TRUE(std::isnan(filter(line.data() + filter.before(), 3, filter.after())));
  EXPECT_NEAR(filter(line.data() + filter.before(), 5, filter.after()), 2.0, 1e-9);
  std::vector<double> holed = line;
  holed[filter.before() - 2] = holed[filter.before() - 3] = missing;
  EXPECT_TRUE(std::isnan(rate_of(filter, holed)));
}

TEST(RateFilter, CutOffHasTheRequestedPeriod) {
  RateFilter filter(1.0, 0.0, 10.0);
  EXPECT_NEAR(std::abs(frequency_response(filter, 1.0, 10.0)) / std::abs(ideal(0.0, 10.0)), 0.5, 0.02);
  EXPECT_NEAR(std::abs(frequency_response(filter, 1.0, 20.0)) / std::abs(ideal(0.0, 20.0)), 1.0, 0.01);
  EXPECT_LT(std::abs(frequency_response(filter, 1.0, 5.0)), 0.01 * std::abs(ideal(0.0, 5.0)));
}

}  // namespace
