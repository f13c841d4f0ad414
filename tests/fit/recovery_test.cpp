#include <gmock/gmock.h>
#include <pcor/fit/refit.hpp>
#include <pcor/simulate/simulate.hpp>

#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "support/many_seeds.hpp"
#include "support/says.hpp"
#include "support/temporary_directory.hpp"

// Simulated flights of two hours with all manoeuvres and the usual noise, refitted, over many seeds: the
// fits recover the true coefficients within correctly stated errors.

namespace {

using pcor::test::number_of_seeds;

constexpr std::uint64_t first_seed = 5000;

const std::filesystem::path scenarios = std::filesystem::path(PCOR_SOURCE_DIR) / "data" / "scenarios";

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Statistics of one coefficient over the fits of all seeds.
struct Record {
  double truth = 0.0;
  std::vector<double> values;
  std::vector<double> errors;

  double spread() const {
    const double mean = mean_of(values);
    double squares = 0.0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    return std::sqrt(squares / static_cast<double>(values.size() - 1));
  }
  std::size_t within(double deviations) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
      count += std::abs(values[i] - truth) < deviations * errors[i] ? 1 : 0;
    return count;
  }
};

struct Study {
  std::map<std::string, Record> records;
  double rms_over_pressure = 0.0;  // mean over the seeds
  double r_squared = 0.0;
};

Study study(const std::string& scenario_name, const std::string& model_name, pcor::RefitOptions options) {
  options.trust_reference = true;  // it is exact in these flights
  const pcor::test::TemporaryDirectory directory;
  const pcor::ModelDefinition model = pcor::read_model(scenarios / "models" / (model_name + ".toml"));
  pcor::Scenario scenario = pcor::read_scenario(scenarios / (scenario_name + ".toml"));
  Study result;
  for (std::uint64_t seed = first_seed; seed < first_seed + number_of_seeds(); ++seed) {
    scenario.seed = seed;
    pcor::simulate_flight(scenario, directory / "flight.nc");
    const pcor::RefitResult fit =
        pcor::refit({directory / "flight.nc"}, model, {pcor::lams_reference()}, options);
    for (const pcor::FittedParameter& parameter : fit.parameters) {
      Record& record = result.records[parameter.name];
      record.truth = parameter.start;  // the model has the coefficients that the scenario flies with
      record.values.push_back(parameter.value);
      record.errors.push_back(parameter.standard_error);
    }
    result.rms_over_pressure += fit.rms_over_pressure / static_cast<double>(number_of_seeds());
    result.r_squared += fit.r_squared / static_cast<double>(number_of_seeds());
  }
  return result;
}

/// @param spread ratio of spread and stated error where it is known not to be 1, keyed by coefficient
void expect_recovery(const Study& study, const std::map<std::string, double>& spread = {}) {
  for (const auto& [name, record] : study.records) {
    EXPECT_GE(record.within(3.0), pcor::test::least_within(number_of_seeds(), pcor::test::within_three))
        << name;
    const auto known = spread.find(name);
    EXPECT_NEAR(record.spread() / mean_of(record.errors), known == spread.end() ? 1.0 : known->second,
                pcor::test::tolerance_of_spread(number_of_seeds()))
        << name;
  }
}

}  // namespace

TEST(Recovery, RecoversEquation18) {
  const Study result = study("c130-eq18", "c130-psfd-eq18", {});
  expect_recovery(result);
  // The memo: rms 0.00045 of p. Simulated noise that is as large, within a fifth.
  EXPECT_NEAR(result.rms_over_pressure, 0.00045, 0.0001);
  EXPECT_GT(result.r_squared, 0.75);
}

TEST(Recovery, RecoversEquation19InStages) {
  pcor::RefitOptions options;
  options.stages = {{{pcor::Regime::pitch_manoeuvre}, {"static-alpha"}},
                    {{pcor::Regime::yaw_manoeuvre}, {"static-beta-odd"}}};
  expect_recovery(study("c130-eq19", "c130-psfd-eq19", options));
}

TEST(Recovery, RecoversEquation20WithAnIndependentMachNumber) {
  const Study result = study("gv-eq20", "gv-psf-eq20", {});
  // 100 flights: the stated error of a2 is 1.6 times too large; the cause is not known.
  expect_recovery(result, {{"static-qp.a2", 0.63}});
  // The memo: rms 0.00081 of p, r 0.97.
  EXPECT_LT(result.rms_over_pressure, 0.00081);
  EXPECT_GT(result.r_squared, 0.75);
}

TEST(Recovery, Equation20WithRawMachIsReportedCollinear) {
  const pcor::test::TemporaryDirectory directory;
  pcor::simulate_flight(pcor::read_scenario(scenarios / "gv-eq20.toml"), directory / "flight.nc");
  const auto fit_of = [&](const char* name) {
    return pcor::refit({directory / "flight.nc"}, pcor::read_model(scenarios / "models" / name),
                       {pcor::lams_reference()});
  };
  const pcor::RefitResult raw = fit_of("gv-psf-eq20-raw-mach.toml");
  EXPECT_GT(raw.condition_number, 5.0 * fit_of("gv-psf-eq20.toml").condition_number);
  EXPECT_THAT(raw.notes, testing::Contains(pcor::test::Says("nearly collinear")));
  EXPECT_THAT(raw.notes, testing::Contains(pcor::test::Says("not determined")));
}

// The noise of the laser must not pass for an effect before it: least squares of delta-p itself would find a
// recovery factor of 0.2 less in every flight, at 12 standard errors.
TEST(RecoveryStudy, EffectsBeforeTheLaserGiveNoFalseFinding) {
  const pcor::test::TemporaryDirectory directory;
  pcor::Scenario scenario = pcor::read_scenario(scenarios / "c130-eq18.toml");
  pcor::ModelDefinition model = pcor::read_model(scenarios / "models" / "c130-psfd-eq18.toml");
  std::map<std::string, std::size_t> negative{{"recovery-factor", 0}, {"lams-elevation", 0}};
  std::map<std::string, std::size_t> at_bound = negative;
  for (std::uint64_t seed = 7000; seed < 7008; ++seed) {
    scenario.seed = seed;
    pcor::simulate_flight(scenario, directory / "flight.nc");
    for (auto& [id, count] : negative) {
      pcor::ModelDefinition with = model;
      with.model.effects.push_back(pcor::neutral_effect(id));
      const pcor::RefitResult fit = pcor::refit({directory / "flight.nc"}, with, {pcor::lams_reference()});
      const pcor::FittedParameter& added = fit.parameters.back();
      if (added.value < 0.0) ++count;
      if (added.at_bound) ++at_bound[id];
      for (const pcor::FittedParameter& p : fit.parameters) {
        // One of 64 scores is beyond four with a probability of 1 in 250. With a coefficient at its bound
        // the errors do not cover all coefficients.
        const double score = added.at_bound ? 0.0 : std::abs(p.value - p.start) / p.standard_error;
        EXPECT_LT(score, 4.0) << p.name << " seed " << seed;
      }
    }
  }
  for (const auto& [id, count] : negative) {
    EXPECT_LT(count, 8U) << id << " has one sign on all seeds: a chance of 1 in 256";
    // The bound of the recovery factor, 0.2, is 2.3 of its standard errors.
    EXPECT_LT(at_bound[id], 3U) << id;
  }
}

TEST(Recovery, FlightWithoutManoeuvresIsReported) {
  const pcor::test::TemporaryDirectory directory;
  pcor::simulate_flight(pcor::read_scenario(scenarios / "c130-no-manoeuvres.toml"), directory / "flight.nc");
  const pcor::RefitResult fit =
      pcor::refit({directory / "flight.nc"}, pcor::read_model(scenarios / "models" / "c130-psfd-eq18.toml"),
                  {pcor::lams_reference()});
  for (const pcor::FittedParameter& parameter : fit.parameters) {
    // The result is honest: a coefficient far from the truth has a large error.
    EXPECT_LT(std::abs(parameter.value - parameter.start), 4.0 * parameter.standard_error) << parameter.name;
  }
  ASSERT_FALSE(fit.notes.empty());
  EXPECT_THAT(fit.notes.front(), pcor::test::Says("pitch or yaw manoeuvre or a speed run"));
}
