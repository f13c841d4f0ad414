#include <gmock/gmock.h>
#include <pcor/base/error.hpp>
#include <pcor/compare/compare.hpp>
#include <pcor/compare/comparison_report.hpp>
#include <pcor/fit/refit.hpp>
#include <pcor/simulate/simulate.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "support/error_of.hpp"
#include "support/short_flight.hpp"
#include "support/synthetic_samples.hpp"
#include "support/thread_communicator.hpp"

using pcor::ComparedModel;
using pcor::CompareOptions;
using pcor::Comparison;
using pcor::Error;
using pcor::Mask;
using pcor::ModelDefinition;
using pcor::test::IsError;
using testing::HasSubstr;

namespace {

namespace fs = std::filesystem;
const fs::path data = fs::path(PCOR_SOURCE_DIR) / "data";

/// The two-hour flight of the C-130 with all manoeuvres, the same for all tests.
fs::path flight_file() { return pcor::test::simulated("c130-eq18"); }

ComparedModel laser_contender(double added_to_a0 = 0.0) {
  ModelDefinition model = pcor::test::laser_model();
  model.model.effects[0].parameters[0] += added_to_a0;
  return {added_to_a0 == 0.0 ? "true law" : "shifted law", model, {pcor::lams_reference()}};
}

ComparedModel pair_contender() {
  return {"pair",
          pcor::read_model(data / "models" / "c130-psfd-eq18.toml"),
          {pcor::static_system_reference(pcor::read_model(data / "models" / "c130-psfrd-eq18.toml"))}};
}

const pcor::PartStatistics* part_named(const std::vector<pcor::PartStatistics>& parts,
                                       const std::string& name) {
  const auto found =
      std::find_if(parts.begin(), parts.end(), [&](const auto& part) { return part.name == name; });
  return found == parts.end() ? nullptr : &*found;
}

}  // namespace

TEST(Compare, ResidualOfTheTrueLawIsNoise) {
  const Comparison result = pcor::compare({flight_file()}, {laser_contender()});
  const pcor::ModelComparison& model = result.models.front();
  // The floor is robust, the rms is not, and turbulence has bursts: 10 % or so between them.
  EXPECT_NEAR(model.all.rms_over_noise(), 1.1, 0.15);
  EXPECT_LT(std::abs(model.all.bias), 4.0 * model.all.bias_error);
  EXPECT_GT(model.autocorrelation_time, 2.0) << "the air ahead is not the pitot's for seconds";
}

TEST(Compare, ShiftOfTheLawAppearsAsBias) {
  const Comparison result = pcor::compare({flight_file()}, {laser_contender(), laser_contender(1e-3)});
  ASSERT_EQ(result.models.size(), 2U);
  // Delta-p of the second is larger by a thousandth of the static pressure, 0.5 to 0.95 hPa.
  double mean = 0.0;
  const pcor::FlightResiduals& flight = result.flights.front();
  const double shift = result.models[0].all.bias - result.models[1].all.bias;
  for (std::size_t i = 0; i < flight.mask.size(); ++i) {
    if (flight.mask[i] == Mask::none) mean += 1e-3 * flight.static_pressure[i];
  }
  mean /= static_cast<double>(result.models[0].all.samples);
  EXPECT_NEAR(shift, mean, 1e-9);
  EXPECT_GT(result.models[1].all.rms, result.models[0].all.rms);
  EXPECT_LT(result.models[1].r_squared, result.models[0].r_squared);
}

// A residual of zero has no noise, so that its ratio is unknown.
TEST(Compare, WindDoesNotCountBesideAnUnknownRatio) {
  Comparison comparison;
  Comparison& further = comparison.further.emplace_back();
  for (auto* const each : {&comparison, &further}) each->models.emplace_back().name = "a model";
  comparison.models[0].reference = "wind";
  comparison.models[0].all.rms = 2.0;
  comparison.models[0].all.noise_rms = 1.0;
  further.models[0].reference = "total:PSFRD+QCFR";
  EXPECT_EQ(&worst_by_noise(comparison, comparison.models[0]), &further.models[0]);
  const pcor::Report report = pcor::comparison_report(comparison);
  for (const std::string& text : {report.title, report.summary[0], report.summary[1]})
    EXPECT_THAT(text, testing::Not(HasSubstr("nan")));
}

// The mean residual of a climb contains the shear of the wind, up to three of its stated errors.
TEST(Compare, SeparatesTheAtmosphereFromTheBiasAgainstWind) {
  std::vector<ComparedModel> contenders{laser_contender(), laser_contender(0.001)};
  for (ComparedModel& contender : contenders) contender.references = {pcor::wind_reference(contender.model)};
  const Comparison comparison = compare(pcor::FlightSet({flight_file()}), contenders, {});
  ASSERT_EQ(comparison.models.size(), 2U);
  double squares = 0.0;
  std::size_t parts = 0;
  for (const auto* list : {&comparison.models[0].regimes, &comparison.models[0].bands}) {
    for (const pcor::PartStatistics& part : *list) {
      const double score = part.statistics.bias / part.statistics.bias_error;
      EXPECT_LT(std::abs(score), 3.5) << part.name;  // some thirty parts: 1.4 % by chance
      squares += score * score;
      ++parts;
    }
  }
  ASSERT_GT(parts, 20U);
  // All parts contain the error of the level; three standard errors of the rms of two independent scores.
  EXPECT_LT(std::sqrt(squares / static_cast<double>(parts)), 1.0 + 3.0 / std::sqrt(2.0 * 2.0));
  // A thousandth of 600 to 1000 hPa; both models have the same noise, estimated separately.
  const double shift = comparison.models[0].all.bias - comparison.models[1].all.bias;
  EXPECT_NEAR(shift, 0.75, 0.1);
  EXPECT_GT(comparison.models[0].all.mean, comparison.models[1].all.mean)
      << "the measured mean has this sign";
  EXPECT_THAT(pcor::comparison_report(comparison).title,
              testing::AllOf(HasSubstr("true law"), HasSubstr("shifted law")));
  EXPECT_LT(comparison.models[0].all.bias_error, 0.2);
  // The residuals as measured keep their scatter.
  const pcor::Statistics& all = comparison.models[0].all;
  CompareOptions as_measured;
  as_measured.separates_atmosphere = false;
  const Comparison measured = compare(pcor::FlightSet({flight_file()}), contenders, as_measured);
  EXPECT_EQ(measured.models[0].all.bias, all.mean);
  EXPECT_EQ(measured.models[0].all.scatter(), all.scatter());
  EXPECT_EQ(measured.models[0].autocorrelation_time, comparison.models[0].autocorrelation_time);
}

// Its climb alone stated a level of -5.6 hPa, with an rms of 0.03 hPa.
TEST(Compare, UndeterminedLevelLeavesMeansOfAllParts) {
  const ModelDefinition model = pcor::read_model(data / "models" / "c130-psfd-2014.toml");
  const Comparison comparison =
      pcor::compare({pcor::test::short_flight()}, {{"a law", model, {pcor::height_reference(model)}}});
  const pcor::ModelComparison& by_height = comparison.models.front();
  ASSERT_GT(by_height.all.bias_error, 1.0);
  ASSERT_GT(by_height.regimes.size(), 3U);
  for (const pcor::PartStatistics& part : by_height.regimes)
    EXPECT_EQ(part.statistics.bias, part.statistics.mean) << part.name;
}

TEST(Compare, ReportsBiasFromLaserCalibration) {
  ComparedModel given = laser_contender();
  given.model.uncertainty.sensors = {{"lams-elevation.dtheta1", 0.0},
                                     {"lams-azimuth.dtheta2", 0.0},
                                     {"temp-offset.offset", 0.0},
                                     {"recovery-factor.da", 0.0}};
  ComparedModel scaled = given;
  scaled.name = "laser scale 0.2 % off";
  scaled.model.model.effects.push_back(pcor::neutral_effect("lams-scale"));
  scaled.model.model.effects.back().parameters = {0.002};  // the usual doubt
  const Comparison comparison = pcor::compare({flight_file()}, {given, scaled});
  const double shift = comparison.models[1].all.bias - comparison.models[0].all.bias;
  // The residual is not linear in the speed: 1 % for a step of 0.2 %.
  EXPECT_NEAR(comparison.models[0].reference_error / std::abs(shift), 1.0, 0.01);
  EXPECT_EQ(comparison.models[1].reference_error, 0.0);  // the model states the error of its laser
}

TEST(Compare, FindsEveryRegimeOfTheScenario) {
  const Comparison result = pcor::compare({flight_file()}, {laser_contender()});
  const std::vector<pcor::PartStatistics>& regimes = result.models.front().regimes;
  for (const char* name : {"take-off", "climb", "descent", "level", "turn", "pitch manoeuvre",
                           "yaw manoeuvre", "speed run", "reverse heading", "circle"}) {
    EXPECT_NE(part_named(regimes, name), nullptr) << name;
  }
  // Phases share out the samples; the ground is masked.
  std::size_t sum = 0;
  for (const char* name : {"take-off", "climb", "descent", "level"})
    sum += part_named(regimes, name)->statistics.samples;
  EXPECT_EQ(sum, result.masks[0]);
}

TEST(Compare, FindsBothSpeedRunsForEachSeed) {
  const pcor::test::TemporaryDirectory directory;
  pcor::Scenario scenario = pcor::read_scenario(data / "scenarios" / "c130-eq18.toml");
  for (std::uint64_t seed = 301; seed < 305; ++seed) {
    scenario.seed = seed;
    pcor::simulate_flight(scenario, directory / "flight.nc");
    const Comparison result = pcor::compare({directory / "flight.nc"}, {laser_contender()});
    const std::vector<pcor::Interval>& intervals = result.flights.front().samples->intervals;
    const auto runs = std::count_if(intervals.begin(), intervals.end(), [](const pcor::Interval& interval) {
      return interval.regime == pcor::Regime::speed_run;
    });
    EXPECT_EQ(runs, 2) << seed;
  }
}

TEST(Compare, EachModelHasItsOwnReference) {
  // Models of two systems side by side: each has the R2 that it has alone.
  ComparedModel other = laser_contender();
  other.model = pcor::read_model(data / "models" / "c130-psfrd-eq18.toml");
  for (const auto& [role, variable] : laser_contender().model.variables)
    other.model.variables.emplace(role, variable);
  const double alone = pcor::compare({flight_file()}, {other}).models.front().r_squared;
  const Comparison both = pcor::compare({flight_file()}, {laser_contender(), other});
  EXPECT_NEAR(both.models[1].r_squared, alone, 1e-3);
  EXPECT_EQ(both.models[0].all.noise_rms, both.models[1].all.noise_rms) << "a flight has one noise";
}

TEST(Compare, PairsReferencesByName) {
  const auto reference = [](const char* text) { return pcor::read_reference(text, laser_contender().model); };
  ComparedModel first = laser_contender();
  first.references = {pcor::lams_reference(), reference("total:PSFRD+QCFR"), reference("pressure:PS_A")};
  ComparedModel second = laser_contender(1e-3);
  second.name = "true law, shifted";  // the first by name has the first reference
  second.references = {reference("pressure:PS_A"), pcor::lams_reference(), reference("pressure:TRUE_PS")};
  const Comparison result = pcor::compare({flight_file()}, {first, second});
  const auto told = [](const Comparison& comparison) {
    std::vector<std::string> names;
    for (const pcor::ModelComparison& model : comparison.models)
      names.push_back(model.name + " against " + model.reference);
    return names;
  };
  EXPECT_THAT(told(result), testing::ElementsAre("true law against lams", "true law, shifted against lams"));
  ASSERT_EQ(result.further.size(), 3U);
  EXPECT_THAT(told(result.further[0]), testing::ElementsAre("true law against total:PSFRD+QCFR"));
  EXPECT_THAT(told(result.further[1]), testing::ElementsAre("true law against pressure:PS_A",
                                                            "true law, shifted against pressure:PS_A"));
  EXPECT_THAT(told(result.further[2]), testing::ElementsAre("true law, shifted against pressure:TRUE_PS"));
}

// The laws differ in pressure and Mach number, so that each would put samples into other bands.
TEST(Compare, ResultIsIndependentOfModelOrder) {
  const std::vector<ComparedModel> given{laser_contender(), laser_contender(0.02), laser_contender(-0.01)};
  std::vector<ComparedModel> named = given;
  for (std::size_t i = 0; i < named.size(); ++i) named[i].name = std::string(1, static_cast<char>('c' - i));
  const Comparison straight = compare(pcor::FlightSet({flight_file()}), named);
  std::vector<ComparedModel> turned(named.rbegin(), named.rend());
  const Comparison reverse = compare(pcor::FlightSet({flight_file()}), turned);
  EXPECT_EQ(straight.masks, reverse.masks);
  for (std::size_t i = 0; i < named.size(); ++i) {
    const pcor::ModelComparison& one = straight.models[i];
    const pcor::ModelComparison& other = reverse.models[named.size() - 1 - i];
    EXPECT_EQ(one.name, named[i].name);
    EXPECT_EQ(one.name, other.name);
    EXPECT_EQ(one.all.rms, other.all.rms);
    EXPECT_EQ(one.static_pressure.slope, other.static_pressure.slope);
    ASSERT_EQ(one.bands.size(), other.bands.size());
    for (std::size_t b = 0; b < one.bands.size(); ++b) {
      EXPECT_EQ(one.bands[b].name, other.bands[b].name);
      EXPECT_EQ(one.bands[b].statistics.samples, other.bands[b].statistics.samples);
      EXPECT_EQ(one.bands[b].statistics.rms, other.bands[b].statistics.rms);
    }
  }
}

TEST(Compare, FlightStatisticsAddUpToTheTotal) {
  const Comparison result = pcor::compare({flight_file(), flight_file()}, {laser_contender()});
  const pcor::ModelComparison& model = result.models.front();
  ASSERT_EQ(model.flights.size(), 2U);
  EXPECT_EQ(model.flights[0].statistics.samples + model.flights[1].statistics.samples, model.all.samples);
  EXPECT_DOUBLE_EQ(model.flights[0].statistics.rms, model.flights[1].statistics.rms);
  EXPECT_NEAR(model.all.rms, model.flights[0].statistics.rms, 1e-12);
  EXPECT_EQ(std::accumulate(result.masks.begin(), result.masks.end(), std::size_t{0}),
            2 * result.flights.front().mask.size());
}

TEST(Compare, WorstMinutesAreReportedInOrder) {
  const Comparison result = pcor::compare({flight_file()}, {laser_contender()});
  const std::vector<pcor::WorstInterval>& worst = result.models.front().worst;
  ASSERT_EQ(worst.size(), 5U);
  for (std::size_t i = 1; i < worst.size(); ++i)
    EXPECT_FALSE(pcor::fails_more(worst[i].statistics, worst[i - 1].statistics));
  EXPECT_NEAR(worst[0].end - worst[0].begin, 60.0, 1.0);
  EXPECT_GT(worst[0].statistics.rms, result.models.front().all.rms);
}

TEST(Compare, TwoSystemsReproduceTheFiguresOfTheMemo) {
  const Comparison result = pcor::compare({flight_file()}, {pair_contender()});
  ASSERT_TRUE(result.total_pressure);
  // Figure 1 of the memo: slope 1.0000, offset 0.10 hPa, rms 0.04. The simulated systems have no offset.
  EXPECT_NEAR(result.total_pressure->slope, 1.0, 1e-4);
  EXPECT_NEAR(result.total_pressure->rms, 0.04, 0.01);
  EXPECT_LT(std::abs(result.total_pressure->mean_difference), 0.01);
  // Figure 2: slope 0.99985, rms 0.15 hPa; here the law is true, so only the sensors' noise remains.
  EXPECT_NEAR(result.models[0].static_pressure.slope, 1.0, 1e-4);
  EXPECT_LT(result.models[0].static_pressure.rms, 0.05);
}

TEST(Compare, KeepsRecordsOfChosenFlightsOnly) {
  const pcor::test::TemporaryDirectory directory;
  pcor::Scenario scenario = pcor::read_scenario(data / "scenarios" / "c130-short.toml");
  std::vector<fs::path> flights;
  for (const int seed : {4, 2, 5, 1, 3}) {
    flights.push_back(directory / ("flight" + std::to_string(seed) + ".nc"));
    scenario.seed = static_cast<std::uint64_t>(seed);
    scenario.start += 86400.0 * seed;
    pcor::simulate_flight(scenario, flights.back());
  }
  const std::vector<ComparedModel> contenders{laser_contender(), pair_contender()};
  const Comparison whole = pcor::compare(flights, contenders);
  ASSERT_EQ(whole.flights.size(), flights.size());
  // Half of those that are kept are the worst.
  std::size_t worst = 0;
  const std::vector<pcor::PartStatistics>& of_flights = whole.models.front().flights;
  for (std::size_t f = 1; f < flights.size(); ++f) {
    if (of_flights[f].statistics.rms > of_flights[worst].statistics.rms) worst = f;
  }
  CompareOptions options;
  options.max_series = 2;
  const auto expect_the_same = [&](const Comparison& some) {
    ASSERT_EQ(some.flights.size(), 2U);
    ASSERT_EQ(some.further.size(), 1U);
    EXPECT_EQ(some.further.front().flights.size(), 2U);
    std::vector<std::size_t> kept;
    for (std::size_t f = 0; f < flights.size(); ++f) {
      for (const pcor::FlightResiduals& flight : some.flights) {
        if (flight.samples->name != flights[f].filename()) continue;
        kept.push_back(f);
        EXPECT_EQ(flight.samples->time, whole.flights[f].samples->time);
        EXPECT_THAT(flight.values.front(),
                    testing::Pointwise(testing::NanSensitiveDoubleEq(), whole.flights[f].values.front()));
      }
    }
    EXPECT_THAT(kept, testing::SizeIs(2));
    EXPECT_THAT(kept, testing::Contains(worst));
    EXPECT_EQ(some.models.front().all.rms, whole.models.front().all.rms);
    EXPECT_EQ(some.models.front().flights.size(), flights.size());
    EXPECT_EQ(some.models[0].static_pressure.slope, whole.models[0].static_pressure.slope);
    EXPECT_EQ(some.intervals.size(), whole.intervals.size());
    EXPECT_EQ(some.masks, whole.masks);
    EXPECT_THAT(pcor::comparison_report(some).summary, testing::Contains(HasSubstr("2 of the 5 flights")));
  };
  expect_the_same(pcor::compare(flights, contenders, options));
  testing::internal::CaptureStderr();  // HDF5 prints errors of failed netCDF queries in further threads
  pcor::test::run_with_communicator(
      3,
      [&](pcor::Communicator& comm) {
        expect_the_same(pcor::compare({flights, {{}, &comm}}, contenders, options));
      },
      true);
  testing::internal::GetCapturedStderr();
}

TEST(Compare, ResidualFileNamesItsQuantities) {
  const pcor::test::TemporaryDirectory directory;
  const pcor::Flight input(flight_file());
  const auto description = [&](const std::shared_ptr<const pcor::Reference>& reference,
                               const char* variable) {
    ComparedModel contender = laser_contender();
    contender.references = {reference};
    CompareOptions options;
    options.separates_atmosphere = false;
    pcor::write_residuals(pcor::compare({flight_file()}, {contender}, options), 0, input,
                          directory / "residuals.nc", "");
    return pcor::Flight(directory / "residuals.nc").variable(variable).long_name;
  };
  EXPECT_EQ(description(pcor::lams_reference(), "RESIDUAL_1"),
            "Static pressure of LAMS minus static pressure of the model true law");
  const auto wind = pcor::wind_reference(laser_contender().model);
  for (const char* const variable : {"RESIDUAL_1", "PCOR_REFERENCE_1"})
    EXPECT_THAT(description(wind, variable),
                testing::AllOf(HasSubstr(wind->description()), testing::Not(HasSubstr("tatic pressure"))));
}

TEST(Compare, ImpossibleComparisonIsRefused) {
  const auto refusal = [](const std::vector<fs::path>& flights, const ComparedModel& contender,
                          const CompareOptions& options = {}) {
    return pcor::test::error_of([&] { pcor::compare(flights, {contender}, options); });
  };
  CompareOptions fast;
  fast.mask.min_airspeed = 500.0;
  EXPECT_THAT(refusal({flight_file()}, laser_contender(), fast),
              IsError(Error::Code::samples, "--min-airspeed"));
  ComparedModel absent = laser_contender();
  absent.references = {pcor::pressure_reference("PS_B")};
  EXPECT_THAT(refusal({flight_file()}, absent), IsError(Error::Code::variable, "PS_B", "PS_A"));
  EXPECT_THAT(refusal({}, laser_contender()), IsError(Error::Code::usage));
}

TEST(ComparisonReport, ModelsWithLongNamesAreNumbered) {
  const std::string long_name(33, 'x');
  Comparison comparison;
  for (const std::string& name : {std::string("short"), long_name})
    comparison.models.emplace_back().name = name;
  const pcor::Report report = pcor::comparison_report(comparison);
  EXPECT_EQ(report.columns[1].title, "residual, model 2");
  const auto is_table = [](const auto& item) { return std::holds_alternative<pcor::ReportTable>(item); };
  const auto table = std::find_if(report.items.begin(), report.items.end(), is_table);
  ASSERT_NE(table, report.items.end());
  EXPECT_EQ(std::get<pcor::ReportTable>(*table).rows[1][1], long_name);
}

TEST(ComparisonReport, WorstRegimeHasOnePerCentOfTheSamples) {
  Comparison comparison;
  pcor::ModelComparison& model = comparison.models.emplace_back();
  model.all.samples = 14000;
  for (const auto& [name, samples, rms] : {std::tuple("take-off", 66U, 2.0), {"descent", 2016U, 0.5}}) {
    pcor::PartStatistics& part = model.regimes.emplace_back();
    part.name = name;
    part.statistics.samples = samples;
    part.statistics.rms = rms;
    part.statistics.noise_rms = 0.3;
  }
  EXPECT_THAT(pcor::comparison_report(comparison).summary,
              testing::Contains(HasSubstr("largest errors in the regime descent")));
}

TEST(ComparisonReport, HasTheFiguresAndIsSmall) {
  const std::string one =
      pcor::report_html(pcor::comparison_report(pcor::compare({flight_file()}, {laser_contender()})));
  EXPECT_THAT(one, HasSubstr("Residual in time"));
  EXPECT_THAT(one, HasSubstr("Delta-p of the reference and of the model"));
  const std::string pair =
      pcor::report_html(pcor::comparison_report(pcor::compare({flight_file()}, {pair_contender()})));
  EXPECT_THAT(pair, HasSubstr("Total pressures of the two systems"));
  EXPECT_THAT(pair, HasSubstr("Corrected static pressures"));
  // 1.5 MB for five hours; this flight has two.
  EXPECT_LT(pair.size(), std::size_t{1500000} * 2 / 5);
}

namespace {

using MadeFlights = std::vector<std::shared_ptr<const pcor::FlightSamples>>;

/// @param airspeed m/s
std::shared_ptr<const pcor::FlightSamples> made_flight(unsigned day, double memory, double airspeed) {
  made::Plan plan;
  plan.seed = day;
  plan.samples = 1800;
  plan.memory = memory;
  plan.defect = made::equation_18;
  pcor::FlightSamples samples = made::flight(plan);
  for (double& time : samples.time) time += 86400.0 * day;
  samples.motion.time = samples.time;
  samples.motion.airspeed.assign(samples.time.size(), airspeed);
  return std::make_shared<const pcor::FlightSamples>(std::move(samples));
}

/// Error of the bias of the true law.
double bias_error(const MadeFlights& flights) {
  ModelDefinition law = made::model({"static-constant", "static-alpha", "static-qp"});
  law.model.effects[0].parameters = {0.004127875};
  law.model.effects[1].parameters = {0.021279816};
  law.model.effects[2].parameters = {0.030849643};
  return pcor::compare(flights, {{"law", law, made::pressure_reference()}}).models.front().all.bias_error;
}

}  // namespace

TEST(Compare, BiasErrorIsIndependentOfFlightOrder) {
  MadeFlights flights;
  for (unsigned day = 0; day < 8; ++day)
    flights.push_back(made_flight(day, day % 2 == 0 ? 0.2 : 0.95, 130.0));
  const double in_order = bias_error(flights);
  for (std::size_t f = 0; f < flights.size(); f += 2) std::swap(flights[f], flights[f + 1]);
  EXPECT_NEAR(bias_error(flights), in_order, 0.01 * in_order);
}

TEST(Compare, FlightsWithoutSamplesDoNotDetermineTheNoise) {
  MadeFlights flying;
  MadeFlights all;
  for (unsigned day = 0; day < 7; ++day) {
    all.push_back(made_flight(day, 0.7, day % 2 == 0 ? 20.0 : 130.0));
    if (day % 2 == 1) flying.push_back(all.back());
  }
  const double expected = bias_error(flying);
  EXPECT_NEAR(bias_error(all), expected, 1e-6 * expected);
}

class RealFlight : public testing::Test {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("PCOR_FLIGHTS");
    if (folder != nullptr) path_ = fs::path(folder) / "GOTEX-rf06-C130-2004.nc";
    if (!fs::exists(path_)) GTEST_SKIP() << "no GOTEX-rf06-C130-2004.nc in $PCOR_FLIGHTS";
  }
  fs::path path_;
};

// The corrections of 2011 on a flight of 2004: 0.51 +- 0.46 hPa between the systems while flying, flaps in or
// out; total pressures with slope 0.99989, offset -0.05 and rms 0.088 hPa.
TEST_F(RealFlight, Equation18FailuresAreLocated) {
  CompareOptions options;
  options.mask.max_flaps = 100.0;
  const Comparison result = pcor::compare({path_}, {pair_contender()}, options);
  const pcor::Statistics& all = result.models.front().all;
  EXPECT_NEAR(all.bias, 0.51, 0.02);
  EXPECT_NEAR(all.scatter(), 0.46, 0.02);
  EXPECT_GT(all.rms_over_noise(), 5.0);
  const pcor::PartStatistics* const descent = part_named(result.models.front().regimes, "descent");
  ASSERT_NE(descent, nullptr);
  EXPECT_GT(descent->statistics.rms, all.rms) << "it is worst in the approach";
  EXPECT_NEAR(result.total_pressure->slope, 0.99989, 0.00002);
  EXPECT_NEAR(result.total_pressure->offset, -0.05, 0.02);
  EXPECT_NEAR(result.total_pressure->rms, 0.088, 0.005);
}

TEST_F(RealFlight, LargestErrorsOccurWithFlapsExtended) {
  const Comparison result = pcor::compare({path_}, {pair_contender()});
  const pcor::Statistics& out = result.models.front().flaps_out;
  const pcor::Statistics& in = result.models.front().all;
  // The first minute in the air, and the last nine, in which the aircraft slows down and descends.
  EXPECT_NEAR(static_cast<double>(out.samples), 540.0, 60.0);
  EXPECT_GT(out.rms, 2.0 * in.rms);
  EXPECT_LT(in.scatter(), 0.3);
}

TEST_F(RealFlight, RefitOfBothSystemsRemovesTheError) {
  const ComparedModel pair = pair_contender();
  pcor::RefitOptions options;
  options.fit_reference = true;
  options.training_share = 0.5;
  options.mask.min_airspeed = 80.0;
  options.mask.max_flaps = 100.0;
  const pcor::RefitResult fit = pcor::refit({path_}, pair.model, pair.references, options);
  ASSERT_EQ(fit.flights.size(), 2U);
  const pcor::FlightFit& second_half = fit.flights[1];
  ASSERT_TRUE(second_half.holdout);
  EXPECT_GT(second_half.before.scatter(), 0.35);
  EXPECT_LT(second_half.after.scatter(), 0.28);
  EXPECT_LT(second_half.after.rms, 0.5 * second_half.before.rms);
  ASSERT_TRUE(fit.reference);
}
