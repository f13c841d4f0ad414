// Temperature of layers: the memo's sums, their errors, and the implied correction.
#include "checks/climb_layers.hpp"
#include "checks/standard_air.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/physics/hydrostatic.hpp>
#include <pcor/physics/standard_atmosphere.hpp>
#include <pcor/simulate/simulate.hpp>
#include "numerics/missing.hpp"
#include "support/data.hpp"
#include "support/error_of.hpp"
#include "support/temporary_directory.hpp"

using namespace pcor::internal;

namespace pcor {
namespace {

using internal::nan;
using test::scenarios;
using test::standard_air;
using testing::IsEmpty;
using testing::SizeIs;

// The thermometer of the simulated flights, on the recovery temperature: 0.55 K and 0.01 of the temperature
// in degC too warm. In ambient temperature that is less by 1 + 0.2 r M^2, with r = 0.95 and a Mach number of
// 0.30 to 0.37.
constexpr double injected_offset = 0.55, injected_slope = 0.01;

double ambient_share(double mach) { return 1.0 / (1.0 + 0.2 * 0.95 * mach * mach); }

/// A flight of the C-130 of an hour: two climbs and two descents, level legs, over isobars that slope by 10 m
/// per 100 km to the east.
FlightAir simulated_air(int seed, double heading) {
  const std::string text = R"(
format = "pcor-scenario/1"
name = "layers"
aircraft = "C-130"
start = 2011-11-17T20:00:00Z
seed = )" + std::to_string(seed) +
                           "\nheading = " + std::to_string(heading) + R"(
[atmosphere]
pressure_height_east = 10
ground_temperature = 290
[[system]]
static = "PSFD"
dynamic = "QCF"
law = { static-constant = 0.004127875, static-alpha = 0.021279816, static-qp = 0.030849643 }
[[effect]]
id = "temp-offset"
offset = 0.55
slope = 0.01
[[leg]]
kind = "take-off"
altitude = 1000
speed = 110
[[leg]]
kind = "climb"
altitude = 5500
[[leg]]
kind = "level"
duration = 320
[[leg]]
kind = "descent"
altitude = 1500
[[leg]]
kind = "turn"
angle = 90
[[leg]]
kind = "level"
duration = 320
[[leg]]
kind = "climb"
altitude = 5500
[[leg]]
kind = "descent"
altitude = 1500
[[leg]]
kind = "level"
duration = 60
)";
  const test::TemporaryDirectory directory;
  simulate_flight(parse_scenario(text, "layers.toml"), directory / "flight.nc");
  return read_flight_air({directory / "flight.nc"}, 0,
                         read_model(scenarios / "models" / "c130-psfd-eq18.toml"));
}

/// Eight flights into all directions, simulated once.
const std::vector<FlightAir>& flights() {
  static const std::vector<FlightAir> all = [] {
    std::vector<FlightAir> flown;
    for (int seed = 1; seed <= 8; ++seed) flown.push_back(simulated_air(seed, 45.0 * seed));
    return flown;
  }();
  return all;
}

/// Truth of the simulated flights: their correction is the correction of the law, without error.
LayerOptions exact_law() {
  LayerOptions options;
  options.static_bias = 0.0;
  options.static_change = 0.0;
  options.pressure_noise = 0.01;
  return options;
}

/// True T_p - T_m in a layer of a simulated flight.
double truth(const FlightAir& air, const Layer& layer) {
  const double share = ambient_share(air.mach[(layer.first + layer.last) / 2]);
  const double measured = layer.measured_temperature() - 273.15;
  // measured = t + share (0.55 + 0.01 t).
  const double true_temperature = (measured - share * injected_offset) / (1.0 + share * injected_slope);
  return true_temperature - measured;
}

double rms(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

std::vector<double> climb(double from, double to, double rate) {
  std::vector<double> heights;
  for (double height = from; rate > 0.0 ? height <= to : height >= to; height += rate)
    heights.push_back(height);
  return heights;
}

/// A layer of a given T_p and T_m.
Layer layer_of(double predicted, double measured, std::size_t number) {
  Layer layer;
  layer.climb = number;
  layer.first = 1000 * number;
  layer.last = layer.first + 200;
  layer.height_begin = 3000.0;
  layer.height_end = 4000.0;
  layer.pressure_begin = 700.0;
  layer.pressure_end = 620.0;
  layer.s2 = 1000.0;
  layer.s1 = -layer.s2 / predicted;
  layer.s3 = layer.s2 / measured;
  return layer;
}

LayerOptions noise_and_gradient(double height_noise, double gradient) {
  LayerOptions uncertainty;
  uncertainty.pressure_noise = uncertainty.static_bias = uncertainty.static_change = 0.0;
  uncertainty.height_noise = height_noise;
  uncertainty.gradient = gradient;
  return uncertainty;
}

// The sums

TEST(Layers, TemperatureEqualsMeanOfStandardAtmosphere) {
  const FlightLayers found = find_layers(standard_air(climb(1000.0, 5000.0, 5.0)));
  ASSERT_THAT(found.layers, SizeIs(4));
  for (const Layer& layer : found.layers) {
    // The harmonic mean over height where T is linear in it: the thickness over ln(T_end/T_begin).
    const double below = standard_temperature(layer.height_begin);
    const double above = standard_temperature(layer.height_end);
    const double mean = (above - below) / std::log(above / below);
    // 5 m steps by the mean of both ends: (5 m/8 km)^2 of the lapse.
    EXPECT_NEAR(layer.hydrostatic_temperature(), mean, 1e-5);
    EXPECT_NEAR(layer.measured_temperature(), mean, 1e-5);
  }
}

TEST(Layers, PartsHaveEqualThicknessAndShareEnds) {
  LayerOptions options;
  options.thickness = 700.0;
  const FlightLayers found = find_layers(standard_air(climb(1000.0, 4500.0, 5.0)), options);
  ASSERT_THAT(found.layers, SizeIs(5));
  for (std::size_t i = 0; i < found.layers.size(); ++i) {
    EXPECT_NEAR(found.layers[i].s2, 700.0, 5.0);  // tolerance of one sample
    EXPECT_EQ(found.layers[i].climb, 0U);
    if (i == 0) continue;
    EXPECT_EQ(found.layers[i].first, found.layers[i - 1].last);
  }
}

TEST(Layers, ClimbAndDescentGiveTheSameDifference) {
  std::vector<double> heights = climb(1000.0, 3000.0, 5.0);
  const std::vector<double> down = climb(3000.0, 1000.0, -5.0);
  heights.insert(heights.end(), down.begin(), down.end());
  const FlightLayers found = find_layers(standard_air(heights, 0.4));
  ASSERT_THAT(found.layers, SizeIs(4));
  for (const Layer& layer : found.layers) EXPECT_NEAR(layer.difference(), -0.4, 1e-4);
  EXPECT_LT(found.layers[3].s2, 0.0);
}

TEST(Layers, RequireAMinimumClimbRateAndThickness) {
  EXPECT_THAT(find_layers(standard_air(climb(1000.0, 3000.0, 1.5))).layers, IsEmpty());
  EXPECT_THAT(find_layers(standard_air(climb(1000.0, 1400.0, 5.0))).layers, IsEmpty());
  EXPECT_THAT(find_layers(standard_air(std::vector<double>(600, 2000.0))).layers, IsEmpty());
  LayerOptions slow;
  slow.min_climb_rate = 1.0;
  EXPECT_THAT(find_layers(standard_air(climb(1000.0, 3000.0, 1.5)), slow).layers, SizeIs(2));
}

TEST(Layers, EndAtGapsMissingValuesAndHeightSteps) {
  const FlightAir whole = standard_air(climb(1000.0, 3400.0, 5.0));
  const auto layers_of = [](const FlightAir& air) {
    LayerOptions options;
    options.thickness = 5000.0;
    return find_layers(air, options).layers;
  };
  ASSERT_THAT(layers_of(whole), SizeIs(1));
  FlightAir missing = whole;
  missing.temperature[240] = nan;
  EXPECT_THAT(layers_of(missing), SizeIs(2));
  FlightAir gap = whole;
  auto samples = std::make_shared<FlightSamples>(*whole.samples);
  for (std::size_t i = 240; i < samples->time.size(); ++i) samples->time[i] += 20.0;
  gap.samples = samples;
  EXPECT_THAT(layers_of(gap), SizeIs(2));
  FlightAir step = whole;
  for (std::size_t i = 240; i < step.size(); ++i) step.geopotential_height[i] += 15.0;
  const std::vector<Layer> stepped = layers_of(step);
  ASSERT_THAT(stepped, SizeIs(2));
  // 15 m in 1200 m would be 3 K.
  for (const Layer& layer : stepped) EXPECT_NEAR(layer.difference(), 0.0, 1e-4);
  FlightAir taxi = whole;
  for (std::size_t i = 0; i < 240; ++i) taxi.flying[i] = false;
  EXPECT_THAT(layers_of(taxi), SizeIs(1));
}

// Errors

TEST(LayerErrors, EqualThoseOfTheMemo) {
  // The memo: 12 to 16 kft is 644 to 549 hPa; 0.1 hPa makes 0.3 K. The memo's value is for one end: both
  // ends together have sqrt(2) of it.
  LayerOptions options;
  options.pressure_noise = 0.1;
  options.thickness = 1e4;
  const FlightLayers found =
      find_layers(standard_air(climb(12000.0 * 0.3048, 16000.0 * 0.3048, 5.0)), options);
  ASSERT_THAT(found.layers, SizeIs(1));
  EXPECT_NEAR(found.layers[0].pressure_begin, 644.0, 1.0);
  EXPECT_NEAR(found.layers[0].pressure_end, 549.0, 1.0);
  EXPECT_NEAR(found.layers[0].errors.pressure_noise / std::sqrt(2.0), 0.3, 0.05);
  // The memo: 10 m in 100 km at 200 m/s while climbing 5 m/s is 0.004 of the temperature, about 1 K.
  FlightAir fast = standard_air(climb(9000.0, 11000.0, 5.0));
  fast.east_speed.assign(fast.size(), 200.0);
  options.gradient = 10.0;
  const FlightLayers gradient = find_layers(fast, options);
  ASSERT_THAT(gradient.layers, SizeIs(1));
  EXPECT_NEAR(gradient.layers[0].errors.gradient / gradient.layers[0].measured_temperature(), 0.004, 1e-4);
}

TEST(LayerErrors, AreIndependentOfTheNumberOfSamples) {
  const FlightAir fast = standard_air(climb(1000.0, 3000.0, 10.0));
  const FlightAir slow = standard_air(climb(1000.0, 3000.0, 2.5));
  LayerOptions options;
  options.height_noise = 1.0;
  options.gradient = 0.0;
  const FlightLayers few = find_layers(fast, options);
  const FlightLayers many = find_layers(slow, options);
  ASSERT_FALSE(few.layers.empty());
  ASSERT_EQ(few.layers.size(), many.layers.size());
  // The ends are the same to a sample of 10 m in 1000 m.
  EXPECT_NEAR(many.layers[0].errors.total() / few.layers[0].errors.total(), 1.0, 0.02);
}

TEST(LayerErrors, EqualTheChangeByAnInjectedError) {
  // Each error is added to the air, and the temperature changes by the stated error: first order in the
  // error, and the ends meet samples, so to 1 %.
  const FlightAir air = standard_air(climb(1000.0, 3000.0, 5.0));
  LayerOptions options;
  options.thickness = 1e4;
  options.height_noise = 1.0;
  options.gradient = 10.0;
  const Layer layer = find_layers(air, options).layers.at(0);
  const auto moved = [&](const FlightAir& changed) {
    return std::abs(find_layers(changed, options).layers.at(0).hydrostatic_temperature() -
                    layer.hydrostatic_temperature());
  };
  FlightAir biased = air;
  for (double& pressure : biased.pressure) pressure += options.static_bias;
  EXPECT_NEAR(moved(biased) / layer.errors.static_bias, 1.0, 0.01);
  FlightAir sloping = air;
  for (std::size_t i = 0; i < air.size(); ++i)
    sloping.geopotential_height[i] += 10.0 / 1e5 * 100.0 * static_cast<double>(i);
  EXPECT_NEAR(moved(sloping) / layer.errors.gradient, 1.0, 0.01);
  FlightAir noisy = air;
  noisy.geopotential_height[layer.last] += 1.0;  // error of one end
  EXPECT_NEAR(moved(noisy) * std::sqrt(2.0) / layer.errors.height_noise, 1.0, 0.01);
  FlightAir pressure = air;
  pressure.pressure[layer.last] += options.pressure_noise;
  const double at_both = std::sqrt(1.0 + std::pow(layer.pressure_end / layer.pressure_begin, 2));
  EXPECT_NEAR(moved(pressure) * at_both / layer.errors.pressure_noise, 1.0, 0.01);
}

TEST(LayerErrors, HeightNoiseIsEstimatedFromTheFlight) {
  // A wave of 2 m and 60 s on the GPS height: 1.41 m rms, of which the lines take next to nothing.
  const auto wave = [](FlightAir air) {
    for (std::size_t i = 0; i < air.size(); ++i)
      air.geopotential_height[i] += 2.0 * std::sin(static_cast<double>(i) * 2.0 * 3.14159265 / 60.0);
    return air;
  };
  const std::vector<double> up = climb(1000.0, 3000.0, 5.0);
  EXPECT_NEAR(find_layers(wave(standard_air(up))).uncertainty.height_noise, 1.41, 0.05);
  EXPECT_EQ(find_layers(standard_air(up)).uncertainty.height_noise, 0.15);
  // Four minutes are too short: GPS of 2004.
  EXPECT_EQ(find_layers(standard_air(climb(1000.0, 2200.0, 5.0))).uncertainty.height_noise, 1.0);
  // A wrong thermometer does not count as noise of the height.
  EXPECT_EQ(find_layers(standard_air(up, 2.0)).uncertainty.height_noise, 0.15);
}

TEST(LayerErrors, PressureGradientIsEstimatedFromLevelLegs) {
  std::vector<double> heights(700, 1000.0);
  const std::vector<double> up = climb(1000.0, 3000.0, 5.0);
  heights.insert(heights.end(), up.begin(), up.end());
  FlightAir air = standard_air(heights);
  EXPECT_EQ(find_layers(air).uncertainty.gradient, 5.0);
  for (std::size_t i = 0; i < air.size(); ++i)  // 20 m per 100 km at 100 m/s
    air.geopotential_height[i] += 20.0 / 1e5 * 100.0 * static_cast<double>(i);
  EXPECT_NEAR(find_layers(air).uncertainty.gradient, 20.0, 0.2);
  LayerOptions options;
  options.gradient = 3.0;
  EXPECT_EQ(find_layers(air, options).uncertainty.gradient, 3.0);
}

// Simulated flights

TEST(LayersStudy, DifferFromTheTruthByTheirErrors) {
  std::vector<double> scores;
  for (const FlightAir& air : flights()) {
    const FlightLayers found = find_layers(air, exact_law());
    EXPECT_GE(found.layers.size(), 14U);  // 4.5 + 4 + 4 + 4 km, less the ends
    for (const Layer& layer : found.layers)
      scores.push_back((layer.difference() - truth(air, layer)) / layer.errors.total());
  }
  // Into all directions the slope of the isobars is 7 m per 100 km rms, and about that is found on level
  // legs.
  EXPECT_LT(rms(scores), 1.5);
  EXPECT_GT(rms(scores), 0.4);
}

TEST(LayersOfSimulatedFlights, GiveTheOffsetWithinItsError) {
  std::vector<double> scores;
  for (const FlightAir& air : flights()) {
    const FlightLayers found = find_layers(air, exact_law());
    const LayerFit fit = fit_layers({found});
    double mean = 0.0;
    for (const Layer& layer : found.layers)
      mean += truth(air, layer) / static_cast<double>(found.layers.size());
    scores.push_back((fit.offset.value - mean) / fit.offset.error);
    EXPECT_LT(fit.offset.error, 0.25);  // half of the offset that the memo looks for
  }
  EXPECT_LT(rms(scores), 1.5);
  // Below one, because isobars that slope the same all the time cancel better than they are trusted to.
  EXPECT_GT(rms(scores), 0.1);
}

TEST(LayersOfSimulatedFlights, SeveralFlightsGiveOffsetAndSlope) {
  std::vector<FlightLayers> found;
  for (const FlightAir& air : flights()) found.push_back(find_layers(air, exact_law()));
  const LayerFit fit = fit_layers(found);
  const double share = ambient_share(0.34);
  const double slope = -share * injected_slope / (1.0 + share * injected_slope);
  const double offset = -share * injected_offset / (1.0 + share * injected_slope);
  EXPECT_NEAR(fit.correction_at(273.15).value, offset, 2.5 * fit.correction_at(273.15).error);
  EXPECT_NEAR(fit.c1.value, slope, 2.5 * fit.c1.error);
  EXPECT_LT(fit.correction_at(273.15).error, 0.1);
  EXPECT_LT(fit.c1.error, 0.01);
}

// A real flight

TEST(LayersOfARealFlight, HaveErrorsOfTheGpsOf2004) {
  const char* folder = std::getenv("PCOR_FLIGHTS");
  if (folder == nullptr) GTEST_SKIP() << "PCOR_FLIGHTS does not name a folder of flights";
  const auto path = std::filesystem::path(folder) / "GOTEX-rf06-C130-2004.nc";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  ModelDefinition model;
  model.model.name = "recorded";
  model.variables = {{Quantity::static_pressure, "PSXC"},
                     {Quantity::dynamic_pressure, "QCXC"},
                     {Quantity::ambient_temperature, "ATX"},
                     {Quantity::vapor_pressure, "EDPC"}};
  const FlightLayers found = find_layers(read_flight_air({path}, 0, model));
  // Two thick climbs and two descents; autonomous GPS of 2004 errs by 1 m and more.
  EXPECT_GE(found.layers.size(), 3U);
  EXPECT_GT(found.uncertainty.height_noise, 1.0);
  for (const Layer& layer : found.layers) {
    const double one_metre = layer.measured_temperature() * std::sqrt(2.0) / std::abs(layer.s2);
    EXPECT_GT(layer.errors.total(), one_metre);
    EXPECT_NEAR(layer.difference(), 0.0, 4.0 * layer.errors.total());
  }
}

// The memo

TEST(LayerFit, ReproducesTheMeanOfTheTableInTheMemo) {
  // T_p and T_m, degC, of eight segments of IDEAS-4; the first of RF07 is the sum of the next two.
  const struct {
    double predicted, measured, printed;
    bool in_mean;
  } rows[] = {{-10.98, -10.37, -0.5, true},  {-6.36, -5.89, -0.47, false}, {2.27, 2.42, -0.15, true},
              {-12.85, -12.15, -0.70, true}, {-0.9, -0.5, -0.4, true},     {-6.5, -6.3, -0.4, true},
              {-9.4, -8.8, -0.6, true},      {-9.5, -8.4, -1.1, true}};
  std::vector<FlightLayers> flights;
  double printed = 0.0;
  std::vector<std::size_t> misprints;
  for (std::size_t i = 0; i < std::size(rows); ++i) {
    FlightLayers flight;
    flight.uncertainty = noise_and_gradient(1.0, 0.0);
    flight.layers = {layer_of(rows[i].predicted + 273.15, rows[i].measured + 273.15, 0)};
    const double difference = flight.layers[0].difference();
    if (std::abs(difference - rows[i].printed) > 0.015) misprints.push_back(i);
    if (!rows[i].in_mean) continue;
    flights.push_back(flight);
    printed += rows[i].printed / 7.0;
  }
  // RF05 is -0.61 and RF08 2337 -0.2 by its own columns.
  EXPECT_THAT(misprints, testing::ElementsAre(0, 5));
  EXPECT_NEAR(printed, -0.55, 0.005);
  const LayerFit fit = fit_layers(flights);
  // Weights are (1/T)^2 of equal errors of height, nearly equal.
  EXPECT_NEAR(fit.offset.value, -0.54, 0.006);
  EXPECT_EQ(fit.layers, 7U);
}

TEST(LayerFit, FindsALineAndItsErrors) {
  FlightLayers flight;
  flight.uncertainty = noise_and_gradient(1.0, 0.0);
  for (std::size_t i = 0; i < 9; ++i) {
    const double measured = 240.0 + 5.0 * static_cast<double>(i);
    flight.layers.push_back(layer_of(measured - 0.55 - 0.01 * (measured - 273.15), measured, i));
  }
  const LayerFit fit = fit_layers({flight});
  EXPECT_NEAR(fit.c1.value, -0.01, 1e-9);
  EXPECT_NEAR(fit.correction_at(273.15).value, -0.55, 1e-9);
  // In the memo's form, at 0 K, c0 is ten times and more as uncertain as at the centre.
  EXPECT_NEAR(fit.correction_at(0.0).value, -0.55 + 2.7315, 1e-9);
  EXPECT_GT(fit.correction_at(0.0).error, 10.0 * fit.c0.error);
}

TEST(LayerFit, SharedEndsOfLayersAreCorrelated) {
  // Three layers of a climb: the height between them drops out of the mean of the whole.
  const FlightAir air = standard_air(climb(1000.0, 4000.0, 5.0));
  LayerOptions options = noise_and_gradient(nan, 0.0);
  FlightLayers cut = find_layers(air, options);
  ASSERT_THAT(cut.layers, SizeIs(3));
  options.thickness = 1e4;
  const FlightLayers whole = find_layers(air, options);
  ASSERT_THAT(whole.layers, SizeIs(1));
  const LayerFit one = fit_layers({whole});
  EXPECT_NEAR(one.offset.error, whole.layers[0].errors.total(), 1e-12);
  // The layers differ in temperature by 5 %; independent ones would have sqrt(3) times the error.
  EXPECT_NEAR(fit_layers({cut}).offset.error / one.offset.error, 1.0, 0.1);
}

TEST(LayerFit, CommonErrorsDoNotAverageOut) {
  // The same climb twenty times: noise averages, the slope of the isobars only the fifth of each climb.
  FlightLayers flight;
  flight.uncertainty = noise_and_gradient(0.001, 10.0);
  for (std::size_t i = 0; i < 20; ++i) {
    Layer layer = layer_of(270.0, 270.0, i);
    layer.east = 20000.0;
    flight.layers.push_back(layer);
  }
  // 20 km at 10 m per 100 km: 2 m of 1000 m, 0.54 K.
  EXPECT_NEAR(fit_layers({flight}).offset.error, 0.54 * std::sqrt(0.8 + 0.2 / 20.0), 0.002);
  // Up and down on the same heading the mean cancels the flight's part.
  for (std::size_t i = 0; i < 20; i += 2) {
    std::swap(flight.layers[i].pressure_begin, flight.layers[i].pressure_end);
    flight.layers[i].s1 *= -1.0;
    flight.layers[i].s2 *= -1.0;
    flight.layers[i].s3 *= -1.0;
  }
  EXPECT_NEAR(fit_layers({flight}).offset.error, 0.54 * std::sqrt(0.2 / 20.0), 0.002);
}

TEST(LayerFit, InconsistentLayersIncreaseTheErrors) {
  FlightLayers flight;
  flight.uncertainty = noise_and_gradient(1.0, 0.0);
  for (std::size_t i = 0; i < 6; ++i)
    flight.layers.push_back(layer_of(270.0 + (i % 2 == 0 ? 3.0 : -3.0), 270.0, i));
  const LayerFit fit = fit_layers({flight});
  EXPECT_GT(fit.error_scale, 5.0);
  EXPECT_NEAR(fit.offset.error, 3.0 / std::sqrt(5.0), 0.03);  // error estimated from the scatter
  EXPECT_TRUE(std::isnan(fit.c1.value));                      // one temperature makes no line
}

TEST(LayerFit, EmptyFitIsUnknown) {
  const LayerFit fit = fit_layers({});
  EXPECT_EQ(fit.layers, 0U);
  EXPECT_TRUE(std::isnan(fit.offset.value));
}

// Footnote 5 of the memo: T_a of every second, and a line through columns (1, T in K).
TEST(LayerFit, WorksWhereTheInversionOfTheMemoIsSingular) {
  const FlightAir& air = flights().front();
  std::vector<double> measured;
  std::vector<double> hydrostatic;
  std::size_t without_change = 0;
  for (std::size_t i = 1; i < air.size(); ++i) {
    if (!air.flying[i] || !air.flying[i - 1]) continue;
    const double rise = air.geopotential_height[i] - air.geopotential_height[i - 1];
    const double logarithm = std::log(air.pressure[i] / air.pressure[i - 1]);
    if (std::isnan(rise + logarithm + air.temperature[i])) continue;
    without_change += std::abs(logarithm) < 2e-5 ? 1 : 0;
    measured.push_back(air.temperature[i]);
    hydrostatic.push_back(-9.80665 / air.gas_constant[i] * rise / logarithm);
  }
  ASSERT_GT(measured.size(), 3000U);
  // In level flight the pressure hardly changes, and T_a is bounded by nothing: one value in a hundred is
  // further off than the ice point is from nothing at all.
  EXPECT_GT(without_change, 30U);
  const auto wild = std::count_if(hydrostatic.begin(), hydrostatic.end(),
                                  [](double t) { return !(std::abs(t - 273.0) < 273.0); });
  EXPECT_GT(wild, static_cast<long>(hydrostatic.size() / 100));
  // The columns are all but parallel: the normal equations are singular to single precision.
  Eigen::Matrix2f normal = Eigen::Matrix2f::Zero();
  Eigen::Matrix2d exact = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const Eigen::Vector2d row(1.0, measured[i]);
    normal += (row * row.transpose()).cast<float>();
    exact += row * row.transpose();
    right += row * (hydrostatic[i] - measured[i]);
  }
  EXPECT_LT(Eigen::PartialPivLU<Eigen::Matrix2d>(exact).rcond(),
            static_cast<double>(std::numeric_limits<float>::epsilon()));
  // If the inversion succeeds in double precision, the answer does not constrain the thermometer.
  const Eigen::Vector2d fitted = exact.ldlt().solve(right);
  double squares = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const double rest = hydrostatic[i] - measured[i] - fitted(0) - fitted(1) * measured[i];
    squares += rest * rest;
  }
  const double scatter = std::sqrt(squares / static_cast<double>(measured.size()));
  const double slope_error = scatter * std::sqrt(exact(0, 0) / exact.determinant());
  EXPECT_GT(slope_error, 10.0 * injected_slope);
  // Layers of the same flight are correlated, and centred columns are orthogonal.
  const LayerFit fit = fit_layers({find_layers(air, exact_law())});
  EXPECT_LT(fit.c1.error, 0.03);
  EXPECT_NEAR(fit.c1.value, -injected_slope, 2.5 * fit.c1.error);
}

}  // namespace
}  // namespace pcor
