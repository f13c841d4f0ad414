// The temperature by the height on simulated flights whose thermometer errs as is known.
#include <pcor/temperature/temperature.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/numerics/line_fit.hpp>
#include <pcor/process/process.hpp>
#include "campaign/flight_air.hpp"
#include "model_io/calibration.hpp"
#include "numerics/missing.hpp"
#include "support/error_of.hpp"
#include "support/many_seeds.hpp"
#include "support/says.hpp"
#include "support/short_flight.hpp"
#include "temperature/temperature_notes.hpp"

using namespace pcor::internal;

namespace pcor {
namespace {

using test::error_of;
using test::IsError;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

namespace fs = std::filesystem;

/// Two and a half hours over a triangle: the thermometer reads 0.55 K and 1 % of the temperature in degC too
/// high, and isobars rise by 10 m in 100 km.
Scenario climbs() { return read_scenario(test::scenarios / "c130-climbs.toml"); }

/// Its first climb and descent alone.
Scenario one_climb() {
  Scenario scenario = climbs();
  scenario.legs.resize(6);
  return scenario;
}

Scenario one_climb_without_slope() {
  Scenario scenario = one_climb();
  scenario.effects.at(0).parameters["slope"] = 0.0;
  return scenario;
}

/// Ten minutes at 250 m above the ground.
Scenario no_climb() {
  Scenario scenario = climbs();
  scenario.legs.resize(2);
  scenario.legs[1].altitude = 350.0;
  scenario.legs.emplace_back().duration = 600.0;
  return scenario;
}

/// The law that the scenario flies with, and the laser.
ModelDefinition model() { return test::laser_model(); }

/// Errors are those of the noise: the pressures of the simulator have no error that lasts.
TemperatureOptions of_degree(int degree) {
  TemperatureOptions options;
  options.degree = degree;
  options.pressure_error = 0.0;
  return options;
}

/// Correction of the measured temperature, by regression on it: the simulator knows the air. It adds the
/// fault to the recovery temperature, so that there is no closed form.
std::array<double, 2> truth(const fs::path& path) {
  const Flight flight(path);
  const FlightAir air = read_flight_air({path}, 0, model());
  std::vector<double> true_temperature(flight.records());
  flight.read_at_rate(1, "TRUE_AT", {0, flight.records()}, flight.conversion("TRUE_AT", "K"),
                      true_temperature.data());
  std::vector<double> celsius;
  std::vector<double> correction;
  for (std::size_t i = 0; i < air.size(); ++i) {
    if (!air.flying[i]) continue;
    celsius.push_back(air.temperature[i] - constants::ice_point);
    correction.push_back(true_temperature[i] - air.temperature[i]);
  }
  const LineFit line = ordinary_fit(celsius, correction);
  return {line.offset, line.slope};
}

class Temperature : public testing::Test {
 protected:
  fs::path fly(Scenario scenario, std::uint64_t seed) {
    scenario.seed = seed;
    const fs::path path = directory_ / ("flight" + std::to_string(seed) + ".nc");
    simulate_flight(scenario, path);
    return path;
  }

  std::vector<fs::path> fly_several(const Scenario& scenario, std::uint64_t first, std::uint64_t count) {
    std::vector<fs::path> paths;
    for (std::uint64_t seed = first; seed < first + count; ++seed) paths.push_back(fly(scenario, seed));
    return paths;
  }

  fs::path copy(const fs::path& flight, const std::string& name) {
    fs::copy_file(flight, directory_ / name);
    return directory_ / name;
  }

  /// A copy without the static pressure of some records.
  fs::path without_records(const fs::path& flight, std::size_t first, std::size_t end,
                           const std::string& name) {
    fs::path path = copy(flight, name);
    int file = 0;
    int variable = 0;
    float missing = 0.0F;
    const std::size_t count = end - first;
    EXPECT_EQ(nc_open(path.c_str(), NC_WRITE, &file), NC_NOERR);
    EXPECT_EQ(nc_inq_varid(file, "PSFD", &variable), NC_NOERR);
    EXPECT_EQ(nc_get_att_float(file, variable, "_FillValue", &missing), NC_NOERR);
    const std::vector<float> values(count, missing);
    EXPECT_EQ(nc_put_vara_float(file, variable, &first, &count, values.data()), NC_NOERR);
    EXPECT_EQ(nc_close(file), NC_NOERR);
    return path;
  }

  fs::path processed(const fs::path& flight, const ModelDefinition& with, const std::string& name) {
    ProcessOptions options;
    options.hydrostatic = true;
    process_flight(flight, with, directory_ / name, options);
    return directory_ / name;
  }

  test::TemporaryDirectory directory_;
};

/// Greatest difference of two corrections, in standard errors of the first.
double apart(const TemperatureFit& one, const TemperatureFit& other) {
  if (one.coefficients.size() != other.coefficients.size()) return std::nan("");
  double maximum = 0.0;
  for (std::size_t k = 0; k < one.coefficients.size(); ++k)
    maximum =
        std::max(maximum, std::abs(one.coefficients[k] - other.coefficients[k]) / one.standard_errors[k]);
  return maximum;
}

// Where the search for the noise stops, 0.001 of -2 ln L, coefficients move by a small part of their
// error.
constexpr double search_stops = 0.1;

// Many seeds

const std::size_t seeds = test::number_of_seeds();

/// Statistics of one coefficient over the fits of all seeds: its error, and its stated errors.
struct Scores {
  std::vector<double> errors;
  std::vector<double> stated;

  double bias() const { return mean_of(errors); }
  double spread() const {
    double squares = 0.0;
    for (const double error : errors) squares += (error - bias()) * (error - bias());
    return std::sqrt(squares / static_cast<double>(errors.size() - 1));
  }
  double spread_over_stated() const { return spread() / mean_of(stated); }
  std::size_t within(double deviations) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < errors.size(); ++i)
      count += std::abs(errors[i]) < deviations * stated[i] ? 1 : 0;
    return count;
  }
};

Scenario::Effect effect(const std::string& id, const std::map<std::string, double>& parameters) {
  return {id, "", parameters};
}

class TemperatureStudy : public Temperature {};

/// The stated errors include the usual error of the humidity: flights on which it is drawn from its prior.
TEST_F(TemperatureStudy, RecoversOffsetAndSlopeOverSlopingIsobars) {
  std::array<Scores, 2> likelihood;
  std::array<Scores, 2> least_squares;
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  for (std::uint64_t seed = 6000; seed < 6000 + seeds; ++seed) {
    Scenario scenario = climbs();
    const std::array<double, 2> true_value = truth(fly(scenario, seed));
    scenario.effects.push_back(
        effect("humidity-error", {{"gain", 0.1 * normal(engine)}, {"dew_point", 0.0}}));
    const fs::path flight = fly(scenario, seed);
    // From the simulated error to the error of the recovery temperature.
    EXPECT_NEAR(true_value[0], -0.55, 0.03);
    EXPECT_NEAR(true_value[1], -0.01, 0.001);
    const TemperatureResult result = fit_temperature({flight}, model(), of_degree(1));
    for (std::size_t k = 0; k < 2; ++k) {
      likelihood[k].errors.push_back(result.likelihood.coefficients[k] - true_value[k]);
      likelihood[k].stated.push_back(result.likelihood.standard_errors[k]);
      least_squares[k].errors.push_back(result.least_squares.coefficients[k] - true_value[k]);
      least_squares[k].stated.push_back(result.least_squares.standard_errors[k]);
    }
    fs::remove(flight);
  }
  for (std::size_t k = 0; k < 2; ++k) {
    const std::string name = "a" + std::to_string(k);
    for (const auto& [method, scores] :
         {std::pair{"likelihood", likelihood[k]}, {"least_squares", least_squares[k]}}) {
      const std::string key = name + "_" + method;
      RecordProperty(key + "_within_2", std::to_string(scores.within(2.0)));
      RecordProperty(key + "_spread_over_stated", std::to_string(scores.spread_over_stated()));
      RecordProperty(key + "_bias", std::to_string(scores.bias()));
    }
    EXPECT_GE(likelihood[k].within(2.0), test::least_within(seeds, test::within_two)) << name;
    EXPECT_GE(likelihood[k].within(3.0), test::least_within(seeds, test::within_three)) << name;
    EXPECT_NEAR(likelihood[k].spread_over_stated(), 1.0, test::tolerance_of_spread(seeds)) << name;
    // The mean of n is known to 1/sqrt(n) of the error; the truth is a line through a curve, weighted by its
    // samples and not by the likelihood, for another three tenths.
    const double bias_is_known_to = 1.0 / std::sqrt(static_cast<double>(seeds));
    EXPECT_LT(std::abs(likelihood[k].bias()), (0.3 + 4.0 * bias_is_known_to) * likelihood[k].spread())
        << name;
    // Heights with a correlation time of 60 s give one independent sample in two minutes, so least squares
    // states errors that are sqrt(120), 11 times, too small; the limit is half this factor, because the
    // height is not the only source.
    EXPECT_GT(least_squares[k].spread_over_stated(), 5.0) << name;
    EXPECT_LT(least_squares[k].within(2.0), seeds / 2) << name;
  }
}

/// The default errors include the usual errors of pressures and humidity: flights on which each has an error
/// drawn from its prior, the law by 0.3 hPa in each of its terms.
TEST_F(TemperatureStudy, StatedErrorsHoldWithUsualSensorErrors) {
  Scores scores;
  std::size_t insignificant = 0;
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  for (std::uint64_t seed = 7000; seed < 7000 + seeds; ++seed) {
    Scenario scenario = climbs();
    const fs::path right = fly(scenario, seed);
    const std::array<double, 2> true_value = truth(right);
    Scenario::Law& law = scenario.systems.at(0).law;
    law.a0 += 0.3 / 650.0 * normal(engine);
    law.a1 += 0.3 / 130.0 * normal(engine);
    law.a2 += 0.3 / 60.0 * normal(engine);
    scenario.effects.push_back(effect("psfd-bias", {{"offset", 0.1 * normal(engine)}}));
    scenario.effects.push_back(
        effect("humidity-error", {{"gain", 0.1 * normal(engine)}, {"dew_point", 0.0}}));
    const fs::path wrong = fly(scenario, seed);
    TemperatureOptions options;
    options.degree = 1;
    const TemperatureResult result = fit_temperature({wrong}, model(), options);
    const TemperatureCorrection& at = result.corrections[2];
    scores.errors.push_back(at.correction - correction_at(at.temperature, {true_value[0], true_value[1]}));
    scores.stated.push_back(at.standard_error);
    if (!result.rejection_reason.empty()) ++insignificant;
    fs::remove(wrong);
  }
  RecordProperty("within_1", std::to_string(scores.within(1.0)));
  RecordProperty("within_2", std::to_string(scores.within(2.0)));
  RecordProperty("spread_over_stated", std::to_string(scores.spread_over_stated()));
  // The fault, 0.55 K, is two to four standard errors: one of 100 flights had an insignificant correction.
  EXPECT_LE(insignificant, seeds / 20);
  // Errors that are assumed twice too large have a spread of a half.
  EXPECT_NEAR(scores.spread_over_stated(), 1.0, test::tolerance_of_spread(seeds));
  EXPECT_GE(scores.within(2.0), test::least_within(seeds, test::within_two));
  EXPECT_LE(scores.within(1.0), seeds - seeds / 10);  // 68 % are expected, not all
}

// Humidity

TEST_F(Temperature, HumidityErrorIsNotAssignedToThermometer) {
  // A vapour pressure 20 % low is twice its usual error, and like 0.35 K where the likelihood takes it for
  // true.
  for (std::uint64_t seed = 51; seed < 56; ++seed) {
    Scenario scenario = climbs();
    scenario.effects = {effect("humidity-error", {{"gain", -0.2}, {"dew_point", 0.0}})};
    const fs::path flight = fly(scenario, seed);
    const TemperatureResult result = fit_temperature({flight}, model());
    EXPECT_THAT(result.rejection_reason, Not(IsEmpty())) << seed;
    // The truth is 25 % of the measured value, reduced by the prior of 10 %; three standard deviations.
    const double shrinkage = 1.0 - std::pow(result.humidity_error / 0.1, 2);
    EXPECT_NEAR(result.humidity_change, 0.25 * shrinkage, 3.0 * result.humidity_error) << seed;
    EXPECT_LT(result.humidity_error, 0.1) << seed;
    fs::remove(flight);
  }
}

TEST_F(Temperature, RefusesDryAirUnlessRequested) {
  const fs::path flight = fly(one_climb(), 1);
  ModelDefinition dry = model();
  dry.model.moist = false;
  EXPECT_THAT(error_of([&] { fit_temperature({flight}, dry, of_degree(1)); }),
              IsError(Error::Code::variable, "flight1.nc", "--force"));
  TemperatureOptions options = of_degree(1);
  options.dry_air = true;
  const TemperatureResult result = fit_temperature({flight}, dry, options);
  EXPECT_THAT(result.rejection_reason, HasSubstr("dry"));
  EXPECT_EQ(result.humidity_change, 0.0);
}

// The law

TEST_F(Temperature, LawErrorDoesNotContradictLeastSquares) {
  // Between climbs and descents the error with the attack looks like a slope of isobars to an estimate that
  // takes the law for right; least squares then contradicted the likelihood in 13 of 20 flights.
  Scenario scenario = one_climb();
  scenario.systems.at(0).law.a1 += 0.3 / 130.0;
  scenario.systems.at(0).law.a2 -= 0.3 / 60.0;
  std::size_t contradicted = 0;
  constexpr std::uint64_t flights = 8;
  for (std::uint64_t seed = 61; seed < 61 + flights; ++seed) {
    const fs::path flight = fly(scenario, seed);
    const TemperatureResult result = fit_temperature({flight}, model(), of_degree(1));
    contradicted += std::abs(result.least_squares_add) > 3.0 * result.least_squares_add_error ? 1 : 0;
    fs::remove(flight);
  }
  // Three deviations are exceeded once in 370 times, and the error of least squares is known to a fifth only:
  // one in eight.
  EXPECT_LE(contradicted, 1U);
}

// One flight

TEST_F(Temperature, ModelFileMatchesTheResult) {
  const TemperatureResult result = fit_temperature({fly(one_climb(), 1)}, model(), of_degree(1));
  const ModelDefinition read = parse_model(write_model(result.model), "made");
  const ModelEffect& effect = read.model.effects.back();
  EXPECT_EQ(effect.id, calibration_id);
  EXPECT_THAT(effect.parameters,
              ElementsAre(result.likelihood.coefficients[0], result.likelihood.coefficients[1], 0.0));
  EXPECT_EQ(read.covariance.matrix, result.covariance);
  for (std::size_t k = 0; k < 2; ++k) {
    const double error = result.likelihood.standard_errors[k];
    EXPECT_NEAR(result.covariance[k][k], error * error, 1e-12 * error * error);
  }
  // The applied correction equals the table of corrections.
  for (const TemperatureCorrection& at : result.corrections)
    EXPECT_NEAR(effect.parameters[0] + effect.parameters[1] * at.temperature, at.correction, 1e-12);
}

TEST_F(Temperature, ExistingCorrectionIsReplaced) {
  const fs::path flight = fly(one_climb(), 1);
  const TemperatureResult bare = fit_temperature({flight}, model(), of_degree(1));
  const ModelDefinition wrong = with_calibration(model(), {2.0, -0.03, 0.0005}, {0.1, 0.1, 0.1},
                                                 {{0.01, 0.0, 0.0}, {0.0, 0.01, 0.0}, {0.0, 0.0, 0.01}});
  for (const ModelDefinition& start : {wrong, bare.model}) {
    const TemperatureResult again = fit_temperature({flight}, start, of_degree(1));
    EXPECT_EQ(again.likelihood.coefficients, bare.likelihood.coefficients);
    EXPECT_EQ(write_model(again.model), write_model(bare.model));
  }
}

TEST_F(Temperature, ArchivedFlightsGiveTheSameResult) {
  // Archived steps are floats of 0.02 m/K, to 1e-9, and temperatures to 4e-6 K. At higher rates steps are of
  // the samples, where raw flights have means over a record: alike to the turbulence within a second.
  const ModelDefinition curved = with_calibration(model(), {0.5, -0.02, 0.0003}, {0.1, 0.1, 0.1},
                                                  {{0.01, 0.0, 0.0}, {0.0, 0.01, 0.0}, {0.0, 0.0, 0.01}});
  for (const int rate : {1, 5, 25}) {
    Scenario scenario = one_climb();
    scenario.rate = rate;
    const fs::path flight = fly(scenario, 1);
    const TemperatureResult raw = fit_temperature({flight}, model(), of_degree(1));
    TemperatureOptions options = of_degree(1);
    options.archived = true;
    for (const ModelDefinition& with : {model(), curved}) {
      const fs::path archive = processed(flight, with, "archived.nc");
      const TemperatureResult archived = fit_temperature({archive}, model(), options);
      // They have no angle of attack, so an error of the law with it is not removed. Errors become 4 %
      // smaller here, and coefficients change by sqrt(1.04^2 - 1), 0.3 of the error.
      EXPECT_LT(apart(raw.likelihood, archived.likelihood), 0.3) << rate << " Hz";
      EXPECT_NEAR(raw.flights[0].rms_after, archived.flights[0].rms_after, 0.01) << rate << " Hz";
      EXPECT_NEAR(static_cast<double>(archived.samples), static_cast<double>(raw.samples), 2.0);
    }
  }
}

TEST_F(Temperature, ShortPressureGapsChangeLittle) {
  const fs::path flight = fly(one_climb(), 1);
  const TemperatureResult whole = fit_temperature({flight}, model(), of_degree(1));
  fs::path gaps = flight;
  std::size_t missing = 0;
  const std::size_t records = Flight(flight).records();
  for (std::size_t first = 1000; first + 200 < records; first += 120, missing += 2) {
    const fs::path before = gaps;
    gaps = without_records(before, first, first + 2, "gaps" + std::to_string(first) + ".nc");
  }
  TemperatureOptions options = of_degree(1);
  const TemperatureResult raw = fit_temperature({gaps}, model(), options);
  options.archived = true;
  const TemperatureResult archived =
      fit_temperature({processed(gaps, model(), "archived.nc")}, model(), options);
  for (const TemperatureResult& result : {raw, archived}) {
    EXPECT_NEAR(static_cast<double>(result.samples + missing), static_cast<double>(whole.samples), 1.0);
    EXPECT_EQ(result.flights[0].segments, 1U);
    // 2 % fewer samples matter little if the noise is correlated over a minute; the steps across two seconds
    // are exact to (dp/p)^2/12, about 1e-7.
    EXPECT_LT(apart(whole.likelihood, result.likelihood), 0.3);
  }
}

TEST_F(Temperature, FlightCutInTwoGivesNearlyTheSameResult) {
  const fs::path flight = fly(climbs(), 1);
  const std::size_t records = Flight(flight).records();
  const std::size_t middle = records / 2;
  const TemperatureResult whole = fit_temperature({flight}, model(), of_degree(1));
  const TemperatureResult parts = fit_temperature(
      {without_records(flight, middle, records, "first.nc"), without_records(flight, 0, middle, "second.nc")},
      model(), of_degree(1));
  EXPECT_EQ(parts.samples, whole.samples);
  // The continuity of the height and of the slope of isobars is not known. With the same noise errors become
  // 5 % larger, so coefficients change by sqrt(1.05^2 - 1), a third of the error; the limit is three times
  // this. The noise is estimated again, which changes the stated errors by more.
  EXPECT_LT(apart(whole.likelihood, parts.likelihood), 1.0);
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_NEAR(parts.likelihood.standard_errors[k] / whole.likelihood.standard_errors[k], 1.0, 0.3);
}

// Many flights

TEST_F(Temperature, DoubledDataHalveTheVariance) {
  const std::vector<fs::path> flights = fly_several(one_climb(), 1, 2);
  std::vector<fs::path> twice = flights;
  twice.push_back(copy(flights[0], "again0.nc"));
  twice.push_back(copy(flights[1], "again1.nc"));
  const TemperatureResult once = fit_temperature(flights, model(), of_degree(1));
  const TemperatureResult all = fit_temperature(twice, model(), of_degree(1));
  EXPECT_EQ(all.samples, 2 * once.samples);
  // Duplicated data have the same most likely noise except for the restriction of the likelihood, in which
  // the two coefficients count half: errors change by the tolerance of the search. The uncertainty of the
  // noise is included in the errors, a sixth of the variance here, of which a quarter remains with twice the
  // data: 4 %.
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(once.likelihood.standard_errors[k] / all.likelihood.standard_errors[k], std::sqrt(2.0), 0.1);
    EXPECT_NEAR(once.least_squares.coefficients[k], all.least_squares.coefficients[k],
                1e-9 * std::abs(once.least_squares.coefficients[k]));
    EXPECT_NEAR(once.least_squares.standard_errors[k] / all.least_squares.standard_errors[k], std::sqrt(2.0),
                1e-9);
  }
  // The prior of humidity and law has half the relative weight with twice the data: if it is a tenth of the
  // information, coefficients change by a twentieth of its shift, which is a few errors.
  EXPECT_LT(apart(once.likelihood, all.likelihood), search_stops + 0.15);
}

TEST_F(Temperature, ResultIsIndependentOfTheNumberOfThreads) {
  const std::vector<fs::path> flights = fly_several(one_climb(), 1, 3);
  TemperatureOptions options;
  options.threads = 1;
  const TemperatureResult one = fit_temperature(flights, model(), options);
  for (const std::size_t threads : {2U, 3U, 8U}) {
    options.threads = threads;
    const TemperatureResult other = fit_temperature(flights, model(), options);
    EXPECT_EQ(other.likelihood.coefficients, one.likelihood.coefficients) << threads;
    EXPECT_EQ(other.covariance, one.covariance) << threads;
    EXPECT_EQ(write_model(other.model), write_model(one.model)) << threads;
  }
}

TEST_F(Temperature, ResultIsIndependentOfTheOrderOfFlights) {
  std::vector<fs::path> flights = fly_several(one_climb(), 1, 3);
  const TemperatureResult forward = fit_temperature(flights, model(), of_degree(1));
  std::reverse(flights.begin(), flights.end());
  const TemperatureResult backward = fit_temperature(flights, model(), of_degree(1));
  // Sums in another order differ in their last digits, and the search may stop at another step.
  EXPECT_LT(apart(forward.likelihood, backward.likelihood), search_stops);
  EXPECT_LT(apart(forward.least_squares, backward.least_squares), 1e-6);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(forward.flights[i].flight, backward.flights[2 - i].flight);
    EXPECT_EQ(forward.flights[i].samples, backward.flights[2 - i].samples);
    EXPECT_EQ(forward.flights[i].before, backward.flights[2 - i].before);
  }
}

TEST_F(Temperature, HeldOutFlightsSelectTheDegree) {
  const TemperatureResult without_slope =
      fit_temperature(fly_several(one_climb_without_slope(), 11, 4), model());
  EXPECT_THAT(without_slope.likelihood.coefficients, SizeIs(1));
  const TemperatureResult with_slope = fit_temperature(fly_several(one_climb(), 21, 4), model());
  EXPECT_THAT(with_slope.likelihood.coefficients, SizeIs(2));
  for (const TemperatureResult& result : {without_slope, with_slope}) {
    // More coefficients never fit worse, and the prediction of held-out flights is never better than their
    // fit.
    ASSERT_THAT(result.degrees, SizeIs(4));
    EXPECT_EQ(result.degrees[0].degree, -1);
    EXPECT_EQ(result.degrees[0].held_out, 0.0);
    for (std::size_t i = 1; i < 4; ++i) {
      EXPECT_LE(result.degrees[i].deviance, result.degrees[i - 1].deviance);
      EXPECT_GE(result.degrees[i].held_out, result.degrees[i].deviance);
    }
  }
}

TEST_F(Temperature, SmallGainAddsNoCoefficient) {
  // Three flights each in which one more coefficient gains by chance, over flights held out, more than its
  // standard error: 0.1 of -2 ln L for a curve, 4.0 for a slope. One of 12 sets of three exceeds each limit.
  EXPECT_THAT(fit_temperature(fly_several(one_climb(), 921, 3), model()).likelihood.coefficients, SizeIs(2));
  EXPECT_THAT(
      fit_temperature(fly_several(one_climb_without_slope(), 900, 3), model()).likelihood.coefficients,
      SizeIs(1));
}

// Slopes of isobars

TEST_F(TemperatureStudy, StatedErrorsCoverAnEstimatedSlope) {
  // 8 normal scores have an rms of more than 1.7 once in 300 times.
  double squares = 0.0;
  constexpr std::uint64_t flights = 8;
  for (std::uint64_t seed = 31; seed < 31 + flights; ++seed) {
    const fs::path flight = fly(climbs(), seed);
    TemperatureOptions options = of_degree(1);
    options.slope = IsobarSlope::whole_flight;
    const TemperatureResult result = fit_temperature({flight}, model(), options);
    const double score =
        (result.likelihood.coefficients[0] - truth(flight)[0]) / result.likelihood.standard_errors[0];
    squares += score * score;
    fs::remove(flight);
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(flights)), 1.7);
}

// Iteration with the pressure

TEST_F(Temperature, AlternatingFitConverges) {
  const std::vector<fs::path> flights = fly_several(one_climb(), 1, 2);
  ModelDefinition start = model();
  start.model.effects[0].parameters = {0.006};  // too large by 0.0019 times the pressure
  const IterativeCalibration found =
      calibrate_iteratively(flights, start, {pcor::lams_reference()}, {}, of_degree(1));
  ASSERT_TRUE(found.converged);
  ASSERT_GT(found.rounds.size(), 1U);
  for (std::size_t i = 1; i < found.rounds.size(); ++i) {
    // Below the limits of convergence, 1e-3 hPa and 1e-3 K, they fluctuate because each round estimates the
    // noise again.
    EXPECT_LT(found.rounds[i].defect_change, std::max(found.rounds[i - 1].defect_change, 1e-3));
    EXPECT_LT(found.rounds[i].temperature_change, std::max(found.rounds[i - 1].temperature_change, 1e-3));
  }
  // The first round goes all the way from no correction.
  double whole = 0.0;
  for (const TemperatureCorrection& at : found.temperature.corrections) {
    const std::vector<double>& first = found.rounds.front().coefficients;
    whole = std::max(whole, std::abs(first[0] + first[1] * at.temperature));
  }
  // The range of temperatures changes by less than 1 K with the pressures, and the correction by 1 % of this
  // change.
  EXPECT_NEAR(found.rounds.front().temperature_change, whole, 0.01);
  EXPECT_EQ(found.rounds.back().coefficients, found.temperature.likelihood.coefficients);

  const IterativeCalibration again =
      calibrate_iteratively(flights, found.temperature.model, {pcor::lams_reference()}, {}, of_degree(1));
  EXPECT_TRUE(again.converged);
  ASSERT_THAT(again.rounds, SizeIs(1));
  EXPECT_LT(again.rounds[0].defect_change, 1e-3);       // hPa, as promised
  EXPECT_LT(again.rounds[0].temperature_change, 1e-3);  // K
}

TEST_F(Temperature, AlternatingFitReportsDegreeSelection) {
  const std::vector<fs::path> flights{fly(one_climb(), 1)};
  const IterativeCalibration found =
      calibrate_iteratively(flights, model(), {pcor::lams_reference()}, {}, {});
  EXPECT_TRUE(found.converged);
  EXPECT_THAT(found.temperature.degrees, SizeIs(4));  // none to quadratic
  EXPECT_THAT(found.temperature.notes_on_degree, ElementsAre(test::Says("--degree")));
  EXPECT_THAT(found.temperature.notes, testing::Contains(found.temperature.notes_on_degree.front()));
  for (const CalibrationRound& round : found.rounds)
    EXPECT_THAT(round.coefficients, SizeIs(found.rounds.front().coefficients.size()));
}

TEST_F(Temperature, AlternatingFitReportsPressureChange) {
  const std::vector<fs::path> flights{fly(one_climb(), 1)};
  const IterativeCalibration found =
      calibrate_iteratively(flights, model(), {pcor::lams_reference()}, {}, of_degree(1));
  ASSERT_TRUE(found.converged);
  // From the end with 0.001 of the pressure more back to it.
  ModelDefinition start = found.temperature.model;
  start.model.effects[0].parameters[0] += 0.001;
  const IterativeCalibration back =
      calibrate_iteratively(flights, start, {pcor::lams_reference()}, {}, of_degree(1));
  const FlightAir air = read_flight_air({flights[0]}, 0, model());
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < air.size(); ++i) {
    if (!air.flying[i] || std::isnan(air.measured_static[i])) continue;
    squares += air.measured_static[i] * air.measured_static[i];
    count += 1.0;
  }
  // The ends are within the 0.001 hPa at which it stops; the pressure in the dynamic pressure's own part of
  // the law moves by less than 1 %.
  EXPECT_NEAR(back.rounds.front().defect_change, 0.001 * std::sqrt(squares / count), 0.01);
  EXPECT_LT(back.rounds.front().temperature_change, 2e-3);
}

// The report

TEST(TemperatureText, ImplausibleCorrectionExceedsItsStandardErrors) {
  TemperatureResult result;
  result.corrections = {{-50.0, -1.0, 0.1}, {20.0, -1.8, 0.4}};
  EXPECT_FALSE(result.is_implausible()) << "-1.8 +- 0.4 K may be -1.0 K";
  result.corrections[1].standard_error = 0.1;
  EXPECT_TRUE(result.is_implausible());
  EXPECT_THAT(temperature_warnings(result), ElementsAre(Not(HasSubstr("recovery factor"))));
  result.model.variables[Quantity::recovery_temperature] = "TTRR";
  EXPECT_THAT(temperature_warnings(result), ElementsAre(HasSubstr("recovery factor")));
}

template <class Item>
const Item* item(const Report& report, const std::string& title) {
  for (const ReportItem& one : report.items) {
    if (const auto* found = std::get_if<Item>(&one); found != nullptr && found->title == title) return found;
  }
  return nullptr;
}

TEST_F(Temperature, ReportHasOnlyTheUsedFlights) {
  const std::vector<fs::path> flights{fly(one_climb(), 1), fly(no_climb(), 2), fly(one_climb(), 3)};
  const TemperatureResult result = fit_temperature(flights, model(), of_degree(1));
  ASSERT_THAT(result.flights[1].excluded, HasSubstr("climbs and descents span"));
  const Report report = temperature_report(result);

  // A picture has the flights that were used, each of which is a separate stretch of time.
  EXPECT_THAT(report.flight_names, ElementsAre("flight1.nc", "flight3.nc"));
  EXPECT_THAT(report.flight_starts, ElementsAre(0U, result.flights[0].time.size()));
  EXPECT_EQ(report.time.size(), result.flights[0].time.size() + result.flights[2].time.size());
  for (const ReportColumn& column : report.columns)
    EXPECT_THAT(column.values, SizeIs(report.time.size())) << column.name;
  const auto* table = item<ReportTable>(report, "Flights");
  ASSERT_NE(table, nullptr);
  ASSERT_THAT(table->rows, SizeIs(3));
  for (const auto& row : table->rows) EXPECT_THAT(row, SizeIs(table->headers.size()));
  EXPECT_THAT(table->rows[1].back(), AllOf(HasSubstr("excluded: "), HasSubstr("climbs and descents span")));

  const auto* coefficients = item<ReportTable>(report, "Coefficients");
  ASSERT_NE(coefficients, nullptr);
  EXPECT_THAT(coefficients->rows, SizeIs(2));
  const auto* degrees = item<ReportTable>(report, "Degree of the correction");
  ASSERT_NE(degrees, nullptr);
  EXPECT_THAT(degrees->rows, SizeIs(3));
  const auto* bars = item<BarPanel>(report, "The correction");
  ASSERT_NE(bars, nullptr);
  ASSERT_THAT(bars->bars, SizeIs(result.corrections.size()));
  for (std::size_t i = 0; i < bars->bars.size(); ++i) {
    EXPECT_EQ(bars->bars[i].value, result.corrections[i].correction);
    EXPECT_EQ(bars->bars[i].error, result.corrections[i].standard_error);
  }
  EXPECT_NE(item<TimePanel>(report, "GPS height minus the integral of the hydrostatic equation"), nullptr);

  const std::string html = report_html(report);
  for (const char* word : {"flight1.nc", "flight3.nc", "excluded: ", "too small", "Degree of the correction"})
    EXPECT_THAT(html, HasSubstr(word));
  const std::string body = html.substr(html.find("<body>"), html.find("id=\"data\"") - html.find("<body>"));
  EXPECT_THAT(body, Not(testing::ContainsRegex("[^a-z]-?(nan|inf)[^a-z]")));
}

// Unsupported requests

TEST_F(Temperature, UninformativeFlightsAreRefused) {
  EXPECT_THAT(error_of([] { fit_temperature({}, model()); }), IsError(Error::Code::usage));
  EXPECT_THROW(calibrate_iteratively({}, model(), {pcor::lams_reference()}, {}, {}), Error);
  TemperatureOptions archived;
  archived.archived = true;
  EXPECT_THAT(error_of([&] {
                calibrate_iteratively({fly(one_climb(), 3)}, model(), {pcor::lams_reference()}, {}, archived);
              }),
              IsError(Error::Code::usage));
  const std::vector<fs::path> flights = fly_several(no_climb(), 1, 2);
  EXPECT_THAT(error_of([&] { fit_temperature({flights[0]}, model()); }),
              IsError(Error::Code::samples, "flight1.nc", "300 m"));
  EXPECT_THAT(error_of([&] { fit_temperature(flights, model()); }),
              IsError(Error::Code::samples, "2 flights", "flight1.nc"));
  EXPECT_THAT(error_of([&] {
                fit_temperature({flights[0], flights[0]}, model());
              }),
              IsError(Error::Code::usage, "flight1.nc"));
}

TEST_F(Temperature, InvalidDegreeIsRefused) {
  const fs::path flight = fly(one_climb(), 1);
  for (const int degree : {-1, 3, 100}) {
    EXPECT_THAT(error_of([&] { fit_temperature({flight}, model(), of_degree(degree)); }),
                IsError(Error::Code::usage, std::to_string(degree), "0 to 2"));
  }
}

TEST(IsobarSlopeNames, AreReadBack) {
  for (const char* name : {"fitted", "none", "level-legs", "climb-descent", "whole-flight"}) {
    ASSERT_TRUE(isobar_slope_named(name)) << name;
    EXPECT_EQ(to_string(*isobar_slope_named(name)), name);
  }
  EXPECT_FALSE(isobar_slope_named("steep"));
}

}  // namespace
}  // namespace pcor
