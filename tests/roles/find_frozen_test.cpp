#include "roles/find_frozen.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <random>
#include <vector>

#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

using pcor::internal::find_frozen;
using testing::IsEmpty;
using testing::Not;

namespace {

using Series = std::vector<double>;

struct Sensor {
  double noise = 0.3;       ///< change from one sample to the next
  double resolution = 0.0;  ///< 0: resolution of a double
  double turn = 400.0;      ///< s in which the flight changes
  double swing = 30.0;
};

/// Three hours of a sensor.
Series recorded(const Sensor& sensor, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  Series values;
  for (int i = 0; i < 10800; ++i) {
    double value = 300.0 + sensor.swing * std::sin(i / sensor.turn) + sensor.noise * normal(engine);
    if (sensor.resolution > 0.0) value = sensor.resolution * std::round(value / sensor.resolution);
    values.push_back(value);
  }
  return values;
}

void freeze(Series& values, std::size_t first, std::size_t count) {
  for (std::size_t i = first + 1; i < first + count; ++i) values[i] = values[first];
}

std::vector<std::pair<std::size_t, std::size_t>> found(const Series& values, bool always_varies = false) {
  std::vector<std::pair<std::size_t, std::size_t>> spans;
  for (const pcor::Segment& span : find_frozen(values, std::vector<bool>(values.size(), true), always_varies))
    spans.emplace_back(span.first, span.count);
  return spans;
}

using Spans = std::vector<std::pair<std::size_t, std::size_t>>;

TEST(Frozen, ConstantMinuteIsFrozen) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Series values = recorded({}, seed);
    EXPECT_THAT(found(values), IsEmpty());
    freeze(values, 5000, 60);
    EXPECT_EQ(found(values), Spans({{5000, 60}}));
  }
}

TEST(Frozen, EverySpanIsFoundWithItsLength) {
  Series values = recorded({}, 1);
  const Spans spans{{1000, 30}, {1100, 600}, {1705, 25}, {4000, 3000}};
  for (const auto& [first, count] : spans) freeze(values, first, count);
  EXPECT_EQ(found(values), spans);
}

TEST(Frozen, LongSpansDoNotDefineTheUsualLength) {
  for (const Sensor& sensor : {Sensor{}, Sensor{0.3, 0.1}, Sensor{0.5, 1.0}}) {
    for (const Spans& spans :
         {Spans{{3000, 7800}}, Spans{{1000, 4000}, {6000, 4000}}, Spans{{1000, 1500}, {6000, 4000}}}) {
      Series values = recorded(sensor, 1);
      for (const auto& [first, count] : spans) freeze(values, first, count);
      const Spans frozen = found(values, true);
      ASSERT_EQ(frozen.size(), spans.size()) << sensor.resolution;
      for (std::size_t i = 0; i < spans.size(); ++i) {
        // Neighbours that are equal by chance belong to a span.
        EXPECT_NEAR(static_cast<double>(frozen[i].first), static_cast<double>(spans[i].first), 5.0);
        EXPECT_NEAR(static_cast<double>(frozen[i].second), static_cast<double>(spans[i].second), 10.0);
      }
    }
  }
}

TEST(Frozen, SensorThatStopsAfterTheTakeOffIsFound) {
  Series values = recorded({}, 1);
  freeze(values, 40, values.size() - 40);
  const std::vector<bool> all(values.size(), true);
  EXPECT_EQ(find_frozen(pcor::Quantity::static_pressure, values, all).size(), 1U);
  EXPECT_THAT(find_frozen(pcor::Quantity::flaps, values, all), IsEmpty());
}

// The same value after the landing is as wrong.
TEST(Frozen, ASpanContinuesOnTheGround) {
  Series values = recorded({}, 1);
  freeze(values, 8000, 2800);
  std::vector<bool> flying(values.size(), true);
  std::fill(flying.begin() + 9000, flying.end(), false);
  const std::vector<pcor::Segment> frozen = find_frozen(values, flying);
  ASSERT_EQ(frozen.size(), 1U);
  EXPECT_EQ(frozen[0].first + frozen[0].count, values.size());
  std::fill(flying.begin() + 9200, flying.end(), true);  // a touch and go
  EXPECT_EQ(find_frozen(values, flying).size(), 1U);
}

TEST(Frozen, IsFoundInCoarseValues) {
  // Steps of a third of the noise: one value in seven repeats itself.
  Series values = recorded({0.3, 0.1}, 1);
  freeze(values, 5000, 60);
  EXPECT_EQ(found(values), Spans({{5000, 60}}));
  // Whole numbers, of which every other repeats itself at least.
  values = recorded({0.5, 1.0}, 1);
  freeze(values, 5000, 300);
  ASSERT_EQ(found(values).size(), 1U);
  // Neighbours that are equal by chance belong to it.
  EXPECT_NEAR(static_cast<double>(found(values)[0].first), 5000.0, 5.0);
  EXPECT_NEAR(static_cast<double>(found(values)[0].second), 300.0, 10.0);
}

TEST(Frozen, CoarseSlowOrRestingSeriesAreNotFrozen) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const bool always_varies : {false, true}) {
      EXPECT_THAT(found(recorded({0.5, 1.0}, seed), always_varies), IsEmpty()) << "whole numbers";
      EXPECT_THAT(found(recorded({0.05, 1.0}, seed), always_varies), IsEmpty())
          << "whole numbers without noise";
      EXPECT_THAT(found(recorded({0.01, 0.1, 3000.0, 5.0}, seed), always_varies), IsEmpty())
          << "a temperature that creeps";
    }
    EXPECT_THAT(found(recorded({0.0, 0.0, 400.0, 0.0}, seed)), IsEmpty()) << "a constant";
    // Out for ten minutes at a time, in motion for ten seconds.
    Series flaps(10800, 0.0);
    for (std::size_t first = 0; first + 1200 < flaps.size(); first += 1200) {
      for (std::size_t i = 0; i < 620; ++i)
        flaps[first + i] = std::min({50.0, 5.0 * static_cast<double>(i), 5.0 * static_cast<double>(620 - i)});
    }
    EXPECT_THAT(found(flaps), IsEmpty()) << "flaps";
    // Calm air for half of the flight, in which the steps show.
    Series calm = recorded({0.02, 0.1, 2000.0, 3.0}, seed);
    const Series rough = recorded({0.5, 0.1, 2000.0, 3.0}, seed);
    std::copy_n(rough.begin(), 5400, calm.begin());
    EXPECT_THAT(found(calm), IsEmpty()) << "calm air after rough";
    EXPECT_THAT(found(calm, true), IsEmpty()) << "calm air after rough";
  }
}

// A vane with steps of 0.022 deg: turbulence, then air so calm that it keeps one value for minutes.
TEST(Frozen, CalmVaneIsNotFrozen) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const double noise : {0.002, 0.01}) {
      Series vane = recorded({noise, 0.022, 2000.0, 1.0}, seed);
      const Series rough = recorded({0.5, 0.022, 2000.0, 1.0}, seed);
      std::copy_n(rough.begin(), 5400, vane.begin());
      EXPECT_THAT(found(vane, true), IsEmpty()) << noise;
    }
  }
}

TEST(Frozen, ExcludedAndMissingSamplesAreNotFrozen) {
  Series values = recorded({}, 1);
  freeze(values, 0, 900);
  std::vector<bool> flying(values.size(), true);
  std::fill_n(flying.begin(), 900, false);
  EXPECT_THAT(find_frozen(values, flying), IsEmpty());
  for (std::size_t i = 2000; i < 2300; ++i) values[i] = std::nan("");
  EXPECT_THAT(find_frozen(values, flying), IsEmpty()) << "what is missing is not frozen";
}

// Telemetry with dropouts: pieces of 18 samples are one run.
TEST(Frozen, DropoutsDoNotEndARun) {
  Series values = recorded({}, 1);
  freeze(values, 5000, 600);
  for (std::size_t i = 0; i < values.size(); i += 19) values[i] = std::nan("");
  EXPECT_EQ(found(values), Spans({{5000, 600}}));
}

}  // namespace

/// Segments found in a variable that has 25 samples in each of 1200 records, all in flight.
Spans found_fast(const Series& values) {
  const pcor::test::TemporaryDirectory directory;
  const std::filesystem::path path = directory / "flight.nc";
  Series seconds, means;
  for (std::size_t i = 0; i < values.size() / 25; ++i) {
    seconds.push_back(static_cast<double>(i));
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(25 * i);
    means.push_back(std::accumulate(first, first + 25, 0.0) / 25.0);
  }
  pcor::test::make_flight(path, seconds,
                          [&](pcor::test::NetcdfMaker& file) { file.series("TTRR", "degC", values, 25); });
  Spans spans;
  for (const pcor::Segment& span :
       find_frozen(pcor::Flight(path), "TTRR", pcor::Quantity::recovery_temperature, means,
                   std::vector<bool>(means.size(), true)))
    spans.emplace_back(span.first, span.count);
  return spans;
}

/// 1200 s at 25 Hz. @param calm standard deviation in each last two minutes of ten
Series fast_series(double noise, double resolution, double calm) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  Series values;
  double wave = 0.0;
  for (int i = 0; i < 30000; ++i) {
    wave = 0.96 * wave + 0.28 * normal(engine) * (i % 15000 < 12000 ? noise : calm);
    values.push_back(resolution * std::round((280.0 + std::sin(1e-3 * i) + wave) / resolution));
  }
  return values;
}

TEST(FrozenAtTheRecordedRate, EverySecondWithAFrozenSampleIsFound) {
  Series values = fast_series(0.5, 0.001, 0.5);
  EXPECT_THAT(found_fast(values), IsEmpty());
  freeze(values, 250 * 25, 4 * 25);  // less than five seconds
  freeze(values, 400 * 25 + 10, 5 * 25);
  std::fill_n(values.begin() + 598 * 25, 2 * 25, std::nan(""));
  freeze(values, 600 * 25, 15 * 25);
  freeze(values, 900 * 25, 60 * 25);
  EXPECT_EQ(found_fast(values), Spans({{400, 6}, {600, 15}, {900, 60}}));
}

TEST(FrozenAtTheRecordedRate, HeldOrCalmValuesAreNotFrozen) {
  Series held = fast_series(0.5, 0.05, 0.5);
  for (std::size_t i = 0; i < held.size(); i += 25) freeze(held, i, 25);
  EXPECT_THAT(found_fast(held), IsEmpty()) << "1 Hz, each value 25 times";
  freeze(held, 600 * 25, 60 * 25);
  EXPECT_EQ(found_fast(held), Spans({{600, 60}}));
  Series coarse = fast_series(0.5, 0.5, 0.5);
  for (std::size_t i = 0; i < coarse.size(); i += 25) freeze(coarse, i, 25);
  EXPECT_THAT(found_fast(coarse), IsEmpty()) << "1 Hz in steps of the noise";
  EXPECT_THAT(found_fast(fast_series(0.7, 0.022, 0.01)), IsEmpty()) << "calm after turbulence";
}

TEST(Frozen, ConstantFlightIsFrozenOnlyForVaryingSensors) {
  const Series still(10800, 131.0);
  const std::vector<bool> all(still.size(), true);
  EXPECT_EQ(find_frozen(pcor::Quantity::static_pressure, still, all).size(), 1U);
  EXPECT_THAT(find_frozen(pcor::Quantity::flaps, still, all), IsEmpty()) << "may stay in for a whole flight";
  const Series few(299, 131.0);
  EXPECT_THAT(find_frozen(pcor::Quantity::static_pressure, few, std::vector<bool>(299, true)), IsEmpty());
}

// Outside cloud a probe may report exactly zero for minutes, between clouds of noisy values.
TEST(Frozen, ZeroLiquidWaterIsNotFrozen) {
  Series values = recorded({}, 1);
  const std::vector<bool> all(values.size(), true);
  for (std::size_t i = 0; i < values.size(); i += 900)
    std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(i),
                std::min<std::size_t>(300, values.size() - i), 0.0);
  EXPECT_THAT(find_frozen(pcor::Quantity::static_pressure, values, all), Not(IsEmpty()));
  EXPECT_THAT(find_frozen(pcor::Quantity::liquid_water, values, all), IsEmpty());
  freeze(values, 5000, 100);
  EXPECT_EQ(find_frozen(pcor::Quantity::liquid_water, values, all).size(), 1U) << "another value can be";
}

TEST(InFlight, MissingValueIsLikeTheLastOne) {
  const double missing = std::nan("");
  EXPECT_EQ(pcor::internal::in_flight({missing, 10.0, 20.0, missing, 30.0, 10.0, missing}, 20.0),
            std::vector<bool>({false, false, true, true, true, false, false}));
}
