#include <gmock/gmock.h>
#include <pcor/campaign/chosen_references.hpp>
#include <pcor/effects/catalogue.hpp>
#include <pcor/fit/refit.hpp>
#include <pcor/roles/add_effects.hpp>
#include <pcor/simulate/simulate.hpp>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "support/says.hpp"
#include "support/short_flight.hpp"

using pcor::FittedParameter;
using pcor::ModelDefinition;
using pcor::RefitResult;
using pcor::test::laser_model;
using pcor::test::scenario_text;
using pcor::test::simulated;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

namespace {

const std::string warm_thermometer = "\n[noise]\nTTRR = { rms = 0.03, bias = 0.3 }\n";
const std::string hot_thermometer = "\n[noise]\nTTRR = { rms = 0.03, bias = 2.0 }\n";

ModelDefinition no_law() {
  ModelDefinition model = laser_model();
  for (auto& effect : model.model.effects) effect.parameters[0] = 0.0;
  return model;
}

RefitResult fit_of_file(const std::filesystem::path& path, const ModelDefinition& model,
                        const std::vector<std::string>& references, const pcor::RefitOptions& options = {}) {
  return pcor::refit({path}, model, pcor::read_references(references, model, {}).used, options);
}

constexpr double usual_pressure = 700.0, usual_dynamic = 60.0, usual_ratio = -0.18;  // values of usual flight

/// Error of the fitted delta-p in usual flight, hPa.
double error_of(const RefitResult& fit) {
  const std::vector<ModelDefinition> models{fit.model, laser_model()};
  std::vector<double> defects;
  for (const ModelDefinition& each : models) {
    const auto& effects = each.model.effects;
    defects.push_back(effects[0].parameters[0] * usual_pressure +
                      effects[1].parameters[0] * usual_pressure * usual_ratio +
                      effects[2].parameters[0] * usual_dynamic);
  }
  return defects[0] - defects[1];
}

/// Its standard error, as stated.
double stated_by(const RefitResult& fit) {
  const std::vector<double> by{usual_pressure, usual_pressure * usual_ratio, usual_dynamic};
  double square = 0.0;
  for (std::size_t i = 0; i < by.size(); ++i) {
    for (std::size_t j = 0; j < by.size(); ++j) square += by[i] * fit.covariance[i][j] * by[j];
  }
  return std::sqrt(square);
}

constexpr double error_of_qp = 0.01;  // stated for static-qp.a2

/// Fit of static-constant only, with static-qp fixed at its true value plus `change`.
RefitResult fit_of_constant(double change, const std::vector<std::string>& references) {
  ModelDefinition model = laser_model();
  model.model.effects[2].parameters[0] += change;
  model.fits.resize(model.model.effects.size());
  for (auto& each : model.fits) each.resize(1);
  model.fits[2][0].standard_error = error_of_qp;
  pcor::RefitOptions options;
  options.fix = {"static-alpha", "static-qp"};
  return fit_of_file(simulated("c130-eight-circles"), model, references, options);
}

/// Change of static-constant.a0 by one standard error of static-qp.a2, from two fits.
double change_by_qp(const std::vector<std::string>& references) {
  return 0.5 * (fit_of_constant(error_of_qp, references).parameters[0].value -
                fit_of_constant(-error_of_qp, references).parameters[0].value);
}

}  // namespace

TEST(GpsFit, WindDeterminesTheLaw) {
  const RefitResult result = fit_of_file(simulated("c130-eq18"), no_law(), {"wind"});
  EXPECT_LT(std::abs(error_of(result)), 0.4);
  EXPECT_LT(std::abs(error_of(result)), 3.0 * stated_by(result));
  EXPECT_LT(stated_by(result), 0.25);
}

TEST(GpsFit, WindAndHeightDetermineLawAndThermometer) {
  const RefitResult result =
      fit_of_file(simulated("c130-eq18", warm_thermometer), no_law(), {"wind", "height"});
  EXPECT_LT(std::abs(error_of(result)), 0.3);
  EXPECT_LT(std::abs(error_of(result)), 3.0 * stated_by(result));
  EXPECT_THAT(result.notes, Contains(pcor::test::Says("the thermometer reads high by 0.")));
}

// Shared with the nuisance, the offset was 0.3 K too small.
TEST(GpsFit, ThermometerOffsetOfTheModelReplacesTheNuisance) {
  const ModelDefinition model = pcor::add_effects(laser_model(), {pcor::neutral_effect("temp-offset")});
  const RefitResult result = fit_of_file(simulated("c130-eq18", hot_thermometer), model, {"wind", "height"});
  const FittedParameter& offset = result.parameters[3];
  ASSERT_EQ(offset.name, "temp-offset.offset");
  EXPECT_NEAR(offset.value, 2.0, 3.0 * offset.standard_error);
  EXPECT_LT(offset.standard_error, 0.1);
}

// The constant of the calibration shared its error with the nuisance: it was a fifth too small, its error
// five times too large.
TEST(GpsFit, ThermometerCalibrationEqualsThermometerOffset) {
  const auto fit_with = [&](const char* effect, const std::vector<std::string>& fixed) {
    const ModelDefinition model = pcor::add_effects(laser_model(), {pcor::neutral_effect(effect)});
    pcor::RefitOptions options;
    options.fix = fixed;
    return fit_of_file(simulated("c130-eq18", hot_thermometer), model, {"wind", "height"}, options)
        .parameters[3];
  };
  const FittedParameter offset = fit_with("temp-offset", {"temp-offset.slope"});
  const FittedParameter constant =
      fit_with("temp-calibration", {"temp-calibration.a1", "temp-calibration.a2"});
  ASSERT_EQ(offset.name, "temp-offset.offset");
  ASSERT_EQ(constant.name, "temp-calibration.a0");
  // An offset of the recovery temperature changes the ambient temperature by 1/(1 + 0.95 M^2/5) of it: 0.95
  // to 0.99 at Mach numbers of 0.25 to 0.5.
  EXPECT_NEAR(-constant.value / offset.value, 0.97, 0.02);
  EXPECT_NEAR(constant.standard_error / offset.standard_error, 0.97, 0.02);
}

// An effect without coefficients cannot be fixed by its id.
TEST(GpsFit, LevelCountsAFormulaWithoutCoefficients) {
  const auto level_of = [](const ModelDefinition& model) {
    return pcor::level_by_gps({simulated("c130-eight-circles")}, model, {pcor::wind_reference(model)});
  };
  ModelDefinition moved = laser_model();
  moved.model.effects[0].parameters[0] += 0.001;
  ModelDefinition with_formula = laser_model();
  pcor::ModelEffect& formula = with_formula.model.effects.emplace_back();
  formula.id = "own";
  formula.formula = "0.001 * static_pressure";
  ASSERT_EQ(moved.model.effects[0].id, "static-constant");
  const auto expected = level_of(moved);
  const auto found = level_of(with_formula);
  ASSERT_TRUE(expected && found);
  // The same law; rounding alone differs, through all steps of the search for the noise.
  EXPECT_NEAR(found->missing, expected->missing, 1e-6);
  EXPECT_NEAR(found->standard_error, expected->standard_error, 1e-6);
  EXPECT_GT(std::abs(found->missing), 2.0 * found->standard_error) << "0.7 hPa too high";
}

TEST(GpsFit, HoldsCoefficientsUndeterminedByOneHeading) {
  const RefitResult result = fit_of_file(simulated("c130-one-heading"), laser_model(), {"wind"});
  EXPECT_LT(std::abs(error_of(result)), 0.3) << "the law was right";
  EXPECT_GT(stated_by(result), 1.0);
  EXPECT_THAT(result.warnings, Contains(HasSubstr("circles")));
}

TEST(GpsFit, HeightAloneDoesNotDetermineTheLevel) {
  const RefitResult result = fit_of_file(simulated("c130-eq18", warm_thermometer), laser_model(), {"height"});
  EXPECT_LT(std::abs(error_of(result)), 0.1) << "the law was right";
  EXPECT_GT(stated_by(result), 1.0);
  EXPECT_THAT(result.notes, testing::Not(Contains(pcor::test::Says("thermometer"))));
  EXPECT_TRUE(result.rejection_reason.empty());
}

TEST(GpsFit, CombinesWithALaser) {
  const RefitResult laser = fit_of_file(simulated("c130-circles"), no_law(), {"lams"});
  const RefitResult all = fit_of_file(simulated("c130-circles"), no_law(), {"wind", "lams"});
  EXPECT_LT(std::abs(error_of(all)), 3.0 * stated_by(all));
  EXPECT_LE(stated_by(all), stated_by(laser));
  EXPECT_EQ(all.flights.front().reference, "lams") << "single figures are those of the laser";
}

TEST(GpsFit, RefusesStages) {
  pcor::RefitOptions options;
  options.stages.push_back({{pcor::Regime::speed_run}, {"static-qp"}});
  EXPECT_ANY_THROW(fit_of_file(simulated("c130-circles"), laser_model(), {"wind"}, options));
}

TEST(GpsFit, GpsAloneRefusesAPriorAndALoss) {
  pcor::RefitOptions with_prior;
  with_prior.use_prior = true;
  EXPECT_ANY_THROW(fit_of_file(simulated("c130-circles"), laser_model(), {"wind"}, with_prior));
  pcor::RefitOptions with_loss;
  with_loss.loss = pcor::Loss::none;
  EXPECT_ANY_THROW(fit_of_file(simulated("c130-circles"), laser_model(), {"wind"}, with_loss));
}

TEST(GpsFit, CoefficientAtItsBoundIsReported) {
  ModelDefinition model = no_law();
  // A third below what the flight wants.
  model.fits.resize(model.model.effects.size());
  for (auto& each : model.fits) each.resize(1);
  model.fits[1][0].bounds = pcor::Bounds{0.0, 0.014};
  const RefitResult result = fit_of_file(simulated("c130-eq18"), model, {"wind"});
  EXPECT_TRUE(result.parameters[1].at_bound);
  EXPECT_DOUBLE_EQ(result.parameters[1].value, 0.014);
  EXPECT_FALSE(result.parameters[0].at_bound);
  EXPECT_THAT(result.notes, Contains(pcor::test::Says("static-alpha.a1 is at its bound")));
  // The others make up for it: delta-p changes by less than the attack term that is missing.
  EXPECT_LT(std::abs(error_of(result)), 0.9 * usual_pressure * -usual_ratio * (0.021279816 - 0.014));
}

// The columns of the fit contain half of an oscillation of 3 s, so its steps are twice too long.
TEST(GpsFit, WarnsIfItDoesNotConverge) {
  const std::string effect = "\n[[effect]]\nid = \"static-beta-odd\"\nb1 = 0.01\n";
  const std::string yaw = "kind = \"yaw\"";
  ModelDefinition model = laser_model();
  model = pcor::add_effects(model, {pcor::neutral_effect("static-beta-odd")});
  for (const bool is_fast : {false, true}) {
    std::string text = scenario_text("c130-eq18") + effect;
    for (std::size_t at = text.find(yaw); is_fast && at != std::string::npos; at = text.find(yaw, at + 1))
      text.insert(at + yaw.size(), "\nperiod = 3\ncycles = 40");
    const pcor::test::TemporaryDirectory directory;
    pcor::simulate_flight(pcor::parse_scenario(text, "yaw"), directory / "yaw.nc");
    const RefitResult result = fit_of_file(directory / "yaw.nc", model, {"wind"});
    const auto warned = Contains(HasSubstr("did not converge"));
    if (is_fast)
      EXPECT_THAT(result.warnings, warned);
    else
      EXPECT_THAT(result.warnings, testing::Not(warned));
  }
}

TEST(GpsFit, GustsAreNotExcluded) {
  const RefitResult result = fit_of_file(simulated("c130-eq18"), laser_model(), {"wind"});
  EXPECT_EQ(result.masks[static_cast<std::size_t>(pcor::Mask::burst)], 0U);
}

TEST(GpsFit, JackknifeUsesAllReferences) {
  const RefitResult laser = fit_of_file(simulated("c130-circles"), no_law(), {"lams"});
  const RefitResult all = fit_of_file(simulated("c130-circles"), no_law(), {"wind", "lams"});
  EXPECT_NE(all.parameters[0].jackknife_error, laser.parameters[0].jackknife_error);
  EXPECT_GT(all.parameters[0].jackknife_error, 0.0);
}

TEST(GpsFit, GpsAloneKeepsTheStatedMisfit) {
  ModelDefinition model = laser_model();
  model.uncertainty.static_defect = 0.3;
  model.uncertainty.static_defect_ratio = 0.001;
  const RefitResult result = fit_of_file(simulated("c130-eq18"), model, {"wind"});
  EXPECT_EQ(result.model.uncertainty.static_defect, 0.3);
  EXPECT_EQ(result.model.uncertainty.static_defect_ratio, 0.001);
  // A fit by GPS alone does not compute these.
  for (const double value :
       {result.misfit_rms, result.between_flights, result.least_squares_rms, result.autocorrelation_time})
    EXPECT_TRUE(std::isnan(value)) << value;
}

TEST(GpsFit, FixedCoefficientsKeepTheirCovariance) {
  const RefitResult laser = fit_of_file(simulated("c130-eq18"), laser_model(), {"lams"});
  ASSERT_NE(laser.covariance[0][1], 0.0);
  pcor::RefitOptions options;
  options.fix = {laser.model.model.effects[0].id, laser.model.model.effects[1].id};
  const RefitResult result = fit_of_file(simulated("c130-eq18"), laser.model, {"wind"}, options);
  ASSERT_EQ(result.covariance.size(), 3U);  // the fitted coefficient, and the fixed ones
  EXPECT_EQ(result.covariance[1][2], laser.covariance[0][1]);
  EXPECT_EQ(result.covariance[1][1], laser.covariance[0][0]);
  EXPECT_NE(result.covariance[0][1], 0.0) << "their errors change the fitted coefficient";
  EXPECT_EQ(result.covariance[0][1], result.covariance[1][0]);
}

TEST(GpsFit, ErrorOfAFixedCoefficientIsCarriedThroughTheFit) {
  // Each fit estimates noise and outliers again, and the laser and the wind differ by 6 % in this change.
  constexpr double tolerance = 0.1;
  const std::vector<std::vector<std::string>> choices{{"wind"}, {"lams", "wind"}};
  for (const std::vector<std::string>& references : choices) {
    SCOPED_TRACE(references.front());
    const RefitResult result = fit_of_constant(0.0, references);
    ASSERT_GE(result.covariance_names.size(), 2U);
    EXPECT_EQ(result.covariance_names[0], "static-constant.a0");
    EXPECT_EQ(result.covariance_names[1], "static-qp.a2");
    EXPECT_DOUBLE_EQ(result.covariance[1][1], error_of_qp * error_of_qp);
    const double change = change_by_qp(references);
    // A dynamic pressure of 50 hPa at 700 hPa: delta-p stays if a0 changes by 0.07 times as much as a2.
    EXPECT_LT(change, -0.03 * error_of_qp);
    EXPECT_NEAR(result.covariance[0][1] / error_of_qp, change, tolerance * std::abs(change));
    EXPECT_GT(result.parameters[0].standard_error, (1.0 - tolerance) * std::abs(change));
    EXPECT_GT(result.parameters[0].noise_error, (1.0 - tolerance) * std::abs(change));
  }
}

// Each flight agrees with its noise: only the comparison of the flights shows that one law is wrong for both.
TEST(GpsFit, StatedErrorContainsTheDisagreementOfFlights) {
  const auto fit_beside_a_flight_with = [](const std::string& a0) {
    const std::string effect = "\n[[effect]]\nid = \"static-constant\"\na0 = " + a0 + "\n";
    const ModelDefinition model = no_law();
    return pcor::refit({simulated("c130-eight-circles"), simulated("c130-eight-circles", effect)}, model,
                       pcor::read_references({"wind"}, model, {}).used, {});
  };
  const RefitResult equal = fit_beside_a_flight_with("0.0");
  const RefitResult different = fit_beside_a_flight_with("0.003");
  EXPECT_GT(stated_by(different), 2.0 * stated_by(equal));
  EXPECT_THAT(different.warnings, Contains(HasSubstr("disagree")));
  EXPECT_THAT(equal.warnings, Not(Contains(HasSubstr("disagree"))));
}
