#include "residuals/parameter_dependent_columns.hpp"

#include <gtest/gtest.h>
#include <pcor/fit/refit.hpp>
#include <pcor/residuals/residuals.hpp>

#include <cmath>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "support/short_flight.hpp"

namespace {

using pcor::Flight;
using pcor::FlightSamples;
using pcor::ModelDefinition;
using pcor::Quantity;

ModelDefinition with_clock(double seconds) {
  ModelDefinition model = pcor::test::laser_model();
  model.model.effects.push_back({"clock-skew", {seconds}});
  return model;
}

std::shared_ptr<FlightSamples> samples_of(const std::filesystem::path& path, const ModelDefinition& model) {
  return std::make_shared<FlightSamples>(pcor::read_samples(Flight(path), model, *pcor::lams_reference()));
}

/// Computes the columns again with another value of the last parameter.
void update_columns(FlightSamples& samples, const ModelDefinition& model, double seconds) {
  std::vector<double> parameters;
  for (const pcor::ModelEffect& effect : model.model.effects)
    parameters.insert(parameters.end(), effect.parameters.begin(), effect.parameters.end());
  parameters.back() = seconds;
  pcor::internal::find_parameter_dependent_columns(model.model, parameters.data(), samples.time, samples.step,
                                                   samples.model);
}

/// The short flight with something more in its scenario, without noise or with it.
std::filesystem::path short_flight_with(const pcor::test::TemporaryDirectory& directory,
                                        const std::string& more, bool noise) {
  std::ifstream file(pcor::test::scenarios / "c130-short.toml");
  std::stringstream text;
  text << file.rdbuf() << more;
  std::ofstream(directory / "more.toml") << text.str();
  pcor::Scenario scenario = pcor::read_scenario(directory / "more.toml");
  scenario.noise_on = noise;
  pcor::simulate_flight(scenario, directory / "more.nc");
  return directory / "more.nc";
}

/// Flight whose laser is late by `seconds`.
std::filesystem::path late_flight(const pcor::test::TemporaryDirectory& directory, double seconds,
                                  bool noise) {
  return short_flight_with(
      directory,
      "\n[[effect]]\nid = \"clock-skew\"\non = \"VLAMS\"\nseconds = " + std::to_string(seconds) + "\n",
      noise);
}

TEST(ParameterDependentColumns, SlopeEqualsTheFiniteDifference) {
  const ModelDefinition model = with_clock(0.5);
  const auto samples = samples_of(pcor::test::short_flight(), model);
  ASSERT_EQ(samples->model.parameter_dependent.size(), 1U);
  EXPECT_EQ(samples->model.parameter_dependent[0].at, 0.5);
  const std::vector<double> before = *samples->model.find(Quantity::airspeed_rate);
  const std::vector<double> slope = samples->model.parameter_dependent[0].slope;
  constexpr double step = 0.02;
  const double* const column = samples->model.find(Quantity::airspeed_rate)->data();
  update_columns(*samples, model, 0.5 + step);
  EXPECT_EQ(samples->model.find(Quantity::airspeed_rate)->data(), column) << "others point to it";
  double largest = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!std::isfinite(before[i]) || !std::isfinite(column[i])) continue;
    // The curvature over the step: about 1 m/s2 a second squared.
    EXPECT_NEAR(column[i] - before[i], step * slope[i], 2e-3);
    largest = std::max(largest, std::abs(slope[i]));
  }
  EXPECT_GT(largest, 0.1);
}

TEST(ParameterDependentColumns, MissingSamplesAreIndependentOfTheDelay) {
  const ModelDefinition model = with_clock(0.0);
  const auto samples = samples_of(pcor::test::short_flight(), model);
  const std::vector<double> at_zero = *samples->model.find(Quantity::airspeed_rate);
  for (const double seconds : {-5.0, 1.4, 30.0}) {
    update_columns(*samples, model, seconds);
    const std::vector<double>& now = *samples->model.find(Quantity::airspeed_rate);
    for (std::size_t i = 0; i < now.size(); ++i)
      EXPECT_EQ(std::isnan(now[i]), std::isnan(at_zero[i])) << seconds << ' ' << i;
  }
}

TEST(ParameterDependentColumns, FormulaCanReadTheAirspeedRate) {
  ModelDefinition model = pcor::test::laser_model();
  pcor::ModelEffect formula;
  formula.id = "mine";
  formula.location = pcor::EffectLocation::static_defect;
  formula.formula = "k * airspeed_rate";
  formula.parameter_names = {"k"};
  formula.parameters = {0.1};
  model.model.effects.push_back(formula);
  const auto samples = samples_of(pcor::test::short_flight(), model);
  const pcor::Residuals residuals(samples, model, *pcor::lams_reference());
  const pcor::Residuals without(samples_of(pcor::test::short_flight(), pcor::test::laser_model()),
                                pcor::test::laser_model(), *pcor::lams_reference());
  EXPECT_EQ(residuals.mask_counts()[0], without.mask_counts()[0]);
}

ModelDefinition with_wetting(double drying) {
  ModelDefinition model = pcor::test::laser_model();
  model.variables[Quantity::liquid_water] = "PLWCC";
  model.model.effects.push_back({"temp-wetting", {-1.0, drying}});
  return model;
}

/// A flight through clouds of which the thermometer is wet for so long.
std::filesystem::path wet_flight(const pcor::test::TemporaryDirectory& directory, double drying) {
  return short_flight_with(directory,
                           "\n[[atmosphere.cloud]]\nbase = 0\ntop = 9000\ncover = 0.3\n"
                           "\n[[effect]]\nid = \"temp-wetting\"\nerror = -2.0\ndrying = " +
                               std::to_string(drying) + "\n",
                           false);
}

TEST(ParameterDependentColumns, DependOnTheDryingTime) {
  const pcor::test::TemporaryDirectory directory;
  const ModelDefinition model = with_wetting(8.0);
  const auto samples = samples_of(wet_flight(directory, 8.0), model);
  ASSERT_EQ(samples->model.parameter_dependent.size(), 1U);
  const std::vector<double> before = *samples->model.find(Quantity::wetness);
  const std::vector<double> slope = samples->model.parameter_dependent[0].slope;
  update_columns(*samples, model, 8.1);
  const std::vector<double>& now = *samples->model.find(Quantity::wetness);
  double largest = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_GE(before[i], 0.0);
    EXPECT_LE(before[i], 1.0);
    // The curvature over 0.1 s: exp(-t/tau) has at most about 0.02 per second squared.
    EXPECT_NEAR(now[i] - before[i], 0.1 * slope[i], 2e-4);
    largest = std::max(largest, slope[i]);
  }
  EXPECT_GT(largest, 0.01) << "the longer it dries the wetter it is";
}

TEST(ParameterDependentColumns, RefitFindsTheDryingTime) {
  const pcor::test::TemporaryDirectory directory;
  const std::filesystem::path flight = wet_flight(directory, 15.0);
  for (const double start : {2.0, 40.0}) {
    const pcor::RefitResult fit = pcor::refit({flight}, with_wetting(start), {pcor::lams_reference()});
    const pcor::FittedParameter& drying = fit.parameters.back();
    ASSERT_EQ(drying.name, "temp-wetting.drying");
    // A second in which a cloud begins or ends counts as a whole: the time is up to an eighth too short.
    EXPECT_NEAR(drying.value, 15.0, 15.0 / 8.0) << start;
  }
}

TEST(ParameterDependentColumns, RefitFindsALargeDelay) {
  const pcor::test::TemporaryDirectory directory;
  const std::filesystem::path flight = late_flight(directory, 1.0, false);
  const pcor::RefitResult fit = pcor::refit({flight}, with_clock(0.0), {pcor::lams_reference()});
  // Without noise: means over seconds, shifted by one, are those of another second.
  EXPECT_NEAR(fit.parameters.back().value, 1.0, 0.01);
}

TEST(ParameterDependentColumns, RefitFindsTheSameDelayFromAnyStart) {
  const pcor::test::TemporaryDirectory directory;
  const std::filesystem::path flight = late_flight(directory, 1.0, true);
  const pcor::FittedParameter first =
      pcor::refit({flight}, with_clock(0.5), {pcor::lams_reference()}).parameters.back();
  EXPECT_NEAR(first.value, 1.0, 3.0 * first.standard_error);
  for (const double start : {-2.0, 2.0, 5.0, 30.0}) {
    const pcor::RefitResult fit = pcor::refit({flight}, with_clock(start), {pcor::lams_reference()});
    EXPECT_NEAR(fit.parameters.back().value, first.value, first.standard_error) << start;
  }
}

}  // namespace
