#include "improve/model_trials.hpp"

#include <gtest/gtest.h>
#include <pcor/roles/add_effects.hpp>

#include <cmath>
#include <string>
#include <vector>

#include "diagnose/rms.hpp"
#include "support/data.hpp"
#include "support/short_flight.hpp"

namespace pcor::internal {
namespace {

using test::data_directory;

/// The law of the flight, with the laser.
ModelDefinition law() {
  ModelDefinition file = read_model(data_directory / "models" / "c130-psfd-eq18.toml");
  file.variables.emplace(Quantity::attack, "ATTACK");
  file.variables.emplace(Quantity::sideslip, "SSLIP");
  file.variables.emplace(Quantity::lams_airspeed, "VLAMS");
  return file;
}

ModelDefinition with(const std::string& effect, double value) {
  ModelDefinition file = add_effects(law(), {{effect}});
  file.model.effects.back().parameters[0] = value;
  return file;
}

std::vector<TrialFlight> tried(const std::vector<TrialModel>& models, const References& references,
                               const RefitOptions& options = {}) {
  return try_models({test::short_flight()}, models, references, options);
}

double rms_between(const std::vector<double>& a, const std::vector<double>& b,
                   const std::vector<std::size_t>& indices) {
  SquareSum sum;
  for (const std::size_t i : indices) sum.add(a[i] - b[i]);
  return sum.rms();
}

TEST(Union, HasEachEffectOfAllModelsOnce) {
  const ModelDefinition whole = union_of({{with("static-mach", 0.01)}, {with("static-beta-odd", 0.02)}});
  EXPECT_EQ(whole.model.effects.size(), law().model.effects.size() + 2);
  EXPECT_EQ(coefficients_in(whole, whole).size(), coefficients_in(law(), whole).size());
  EXPECT_EQ(coefficients_in(with("static-mach", 0.01), whole).back(), 0.0) << "an absent effect does nothing";
  EXPECT_EQ(coefficients_in(with("static-beta-odd", 0.02), whole).back(), 0.02);
}

TEST(Union, KeepsTheShapeOfAnAbsentEffect) {
  ModelDefinition shaped = add_effects(law(), {{"pitot-angle", {0.0002, 4.0}}});
  EXPECT_EQ(coefficients_in(law(), union_of({{law()}, {shaped}})).back(), 4.0);
}

TEST(Trials, AModelComparedWithItselfIsEqual) {
  const std::vector<TrialFlight> flights = tried({{law()}, {law()}}, {lams_reference()});
  const TrialComparison same = comparison_of(flights, 0, 1, false);
  EXPECT_EQ(same.chi2_reduction, 0.0);
  EXPECT_EQ(same.rms_before, same.rms_after);
  EXPECT_FALSE(same.is_better() || same.is_worse());
  EXPECT_TRUE(std::isnan(comparison_of(flights, 0, 1, true).rms_before)) << "nothing is held out";
}

TEST(Trials, TrueModelIsBetterAndWrongModelIsWorse) {
  const std::vector<TrialFlight> flights = tried({{law()}, {with("static-mach", 0.02)}}, {lams_reference()});
  const TrialComparison there = comparison_of(flights, 1, 0, false);
  EXPECT_TRUE(there.is_better());
  EXPECT_GT(there.rms_before, there.rms_after);
  EXPECT_TRUE(comparison_of(flights, 0, 1, false).is_worse());
}

TEST(Trials, NoisyFurtherReferencesAreIgnored) {
  TrialComparison comparison;
  comparison.chi2_reduction = 97.0;
  comparison.chi2_reduction_error = 141.0;
  EXPECT_FALSE(comparison.is_better() || comparison.is_worse());
  comparison.first_chi2_reduction = 60.0;
  comparison.first_chi2_reduction_error = 12.0;
  EXPECT_TRUE(comparison.is_better());
  comparison.chi2_reduction = -400.0;
  EXPECT_TRUE(comparison.is_worse());
  EXPECT_FALSE(comparison.is_better());
}

TEST(Trials, EverySampleIsFittedOrHeldOut) {
  RefitOptions options;
  options.training_share = 0.6;
  options.holdout = {test::short_flight()};
  const std::vector<TrialFlight> flights = tried({{law()}}, {lams_reference()}, options);
  ASSERT_EQ(flights.size(), 2U);
  const std::size_t all = flights[0].fitted.size() + flights[0].held_out.size();
  EXPECT_NEAR(static_cast<double>(flights[0].fitted.size()), 0.6 * static_cast<double>(all), 1.0);
  EXPECT_TRUE(flights[1].fitted.empty());
  EXPECT_EQ(flights[1].held_out.size(), all);
}

TEST(Trials, StaticPressuresDifferByTheEffect) {
  // static-constant adds a0 * p to delta-p: 0.001 of it is 0.9 hPa at 900 hPa.
  ModelDefinition more = law();
  more.model.effects[0].parameters[0] += 0.001;
  const std::vector<TrialFlight> flights = tried({{law()}, {more}}, {lams_reference()});
  const TrialFlight& flight = flights.front();
  const std::vector<double> changes = static_changes_of(flights, 0, 1);
  ASSERT_EQ(changes.size(), flight.fitted.size());
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const double pressure = flight.static_pressures[0][flight.fitted[i]];
    ASSERT_GT(changes[i], 0.0008 * pressure);
    ASSERT_LT(changes[i], 0.0012 * pressure);
  }
}

TEST(Trials, CommonErrorsCancelInTotalPressureDifference) {
  const ModelEffect loss{"pitot-angle", {0.0004, 2.0}};
  const References total{
      total_pressure_reference(read_model(data_directory / "models" / "c130-psfrd-eq18.toml"))};
  const ModelDefinition with_loss = add_effects(law(), {loss});
  const std::vector<TrialFlight> flights = tried({{law()}, {with_loss}, {with_loss, {loss.id}}}, total);
  const TrialFlight& only = flights.front();
  const double alone = rms_between(only.residuals[0], only.residuals[1], only.fitted);
  const double shared = rms_between(only.residuals[0], only.residuals[2], only.fitted);
  EXPECT_GT(alone, 0.1);
  EXPECT_EQ(shared, 0.0);
}

}  // namespace
}  // namespace pcor::internal
