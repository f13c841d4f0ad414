// The correction of the temperature in a model: added, removed, written, read, applied, and fixed in a
// refit.
#include "model_io/calibration.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <pcor/fit/refit.hpp>
#include <pcor/realtime/loop.hpp>
#include "support/synthetic_samples.hpp"

using namespace pcor::internal;

namespace pcor {
namespace {

using testing::Contains;
using testing::ElementsAre;

const std::filesystem::path published_file = PCOR_SOURCE_DIR "/data/models/c130-psfd-eq18.toml";

/// The published model as a refit leaves it, with errors and covariance of its pressure law.
ModelDefinition fitted_model() {
  ModelDefinition file = read_model(published_file);
  file.fits = {{{false, 1e-4, {}}}, {{true, 2e-4, {}}}, {{false, 3e-4, Bounds{0.0, 0.1}}}};
  file.covariance = {{"static-constant.a0", "static-qp.a2"}, {{1e-8, 2e-9}, {2e-9, 9e-8}}};
  file.provenance.emplace_back("rms_hpa", ProvenanceValue{0.3});
  return file;
}

const std::vector<double> curve{0.5, -0.01, 1e-4};

TEST(Calibration, CorrectionAtATemperature) {
  EXPECT_EQ(correction_at(-40.0, {}), 0.0);
  EXPECT_EQ(correction_at(-40.0, {0.5}), 0.5);
  // 0.5 + 0.4 + 0.16 by hand.
  EXPECT_NEAR(correction_at(-40.0, {0.5, -0.01, 1e-4}), 1.06, 1e-14);
}
const std::vector<double> its_errors{0.02, 1e-3, 2e-5};
const std::vector<std::vector<double>> its_covariance{
    {4e-4, -1e-5, 1e-7}, {-1e-5, 1e-6, -5e-9}, {1e-7, -5e-9, 4e-10}};

ModelDefinition with_curve(ModelDefinition file) {
  return with_calibration(std::move(file), curve, its_errors, its_covariance);
}

/// Ambient temperature that a loop of the model computes from a recorded one, K.
double applied(const ModelDefinition& file, double celsius) {
  Model model = file.model;
  std::string error;
  std::optional<Loop> loop = Loop::build(
      model,
      {Quantity::static_pressure, Quantity::dynamic_pressure, Quantity::radome_dynamic_pressure,
       Quantity::attack_differential_pressure, Quantity::ambient_temperature, Quantity::vapor_pressure},
      1.0, &error);
  if (!loop) ADD_FAILURE() << error;
  State<double>& state = loop->state();
  state[Quantity::static_pressure] = 500.0;
  state[Quantity::dynamic_pressure] = 50.0;
  state[Quantity::radome_dynamic_pressure] = 50.0;
  state[Quantity::attack_differential_pressure] = -10.0;
  state[Quantity::ambient_temperature] = celsius + constants::ice_point;
  state[Quantity::vapor_pressure] = 0.1;
  loop->run(0.0);
  return state[Quantity::ambient_temperature] - (celsius + constants::ice_point);
}

// `write_model` restores a model to the last bit, so models with the same text are the same.

TEST(Calibration, RemovalRestoresTheModel) {
  for (const ModelDefinition& file : {read_model(published_file), fitted_model()}) {
    EXPECT_EQ(write_model(without_calibration(file)), write_model(file));
    EXPECT_EQ(write_model(without_calibration(with_curve(file))), write_model(file));
  }
}

TEST(Calibration, ReplacesAnEarlierCalibration) {
  const ModelDefinition once = with_calibration(fitted_model(), {-0.3}, {0.01}, {{1e-4}});
  EXPECT_EQ(write_model(with_calibration(with_curve(fitted_model()), {-0.3}, {0.01}, {{1e-4}})),
            write_model(once));
  EXPECT_EQ(write_model(with_curve(once)), write_model(with_curve(fitted_model())));
}

TEST(Calibration, ReplacesACalibrationAmongOtherEffects) {
  ModelDefinition file = fitted_model();
  ModelEffect before = neutral_effect(calibration_id);
  before.parameters = {1.0, 0.0, 0.0};
  file.model.effects.insert(file.model.effects.begin() + 1, before);
  file.fits.insert(file.fits.begin() + 1, EffectFit(3));
  file.covariance = {{"static-constant.a0", "temp-calibration.a0", "static-qp.a2"},
                     {{1e-8, 1e-6, 2e-9}, {1e-6, 1e-2, 1e-6}, {2e-9, 1e-6, 9e-8}}};
  EXPECT_EQ(write_model(without_calibration(file)), write_model(fitted_model()));
  EXPECT_EQ(write_model(with_curve(file)), write_model(with_curve(fitted_model())));
}

TEST(Calibration, RemovalKeepsAUserFormula) {
  ModelDefinition file = fitted_model();
  ModelEffect effect;
  effect.id = "own-thermometer";
  effect.formula = "k";
  effect.location = EffectLocation::ambient_temperature;
  effect.parameter_names = {"k"};
  effect.parameters = {0.1};
  file.model.effects.push_back(effect);
  EXPECT_EQ(without_calibration(with_curve(file)).model.effects.back().id, "own-thermometer");
  // Both see the temperature as recorded, and add up.
  EXPECT_NEAR(applied(with_curve(file), -40.0), 0.1 + 1.06, 1e-12);
}

TEST(Calibration, WriteAndReadRestoreIt) {
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (std::size_t terms = 1; terms <= 3; ++terms) {
    for (int round = 0; round < 20; ++round) {
      // Numbers with all their digits, within the bounds of the catalogue.
      std::vector<double> coefficients;
      std::vector<double> errors;
      std::vector<std::vector<double>> covariance;
      for (std::size_t k = 0; k < terms; ++k) {
        coefficients.push_back(uniform(engine) * (k == 0 ? 5.0 : k == 1 ? 0.05 : 0.001));
        errors.push_back(std::abs(uniform(engine)));
        covariance.emplace_back(terms);
      }
      for (std::size_t k = 0; k < terms; ++k) {
        for (std::size_t j = 0; j <= k; ++j)
          covariance[k][j] = covariance[j][k] = errors[k] * errors[j] * (j == k ? 1.0 : 0.3);
      }
      const ModelDefinition read = parse_model(
          write_model(with_calibration(fitted_model(), coefficients, errors, covariance)), "made");
      ASSERT_EQ(read.model.effects.size(), 4U);
      EXPECT_EQ(read.model.effects.back().id, "temp-calibration");
      ASSERT_EQ(read.covariance.parameters.size(), 2 + terms);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(read.model.effects.back().parameters[k], k < terms ? coefficients[k] : 0.0);
        EXPECT_TRUE(read.fit(3, k).fixed);
        EXPECT_EQ(read.fit(3, k).standard_error.has_value(), k < terms);
        if (k >= terms) continue;
        EXPECT_EQ(*read.fit(3, k).standard_error, errors[k]);
        EXPECT_EQ(read.covariance.parameters[2 + k], "temp-calibration.a" + std::to_string(k));
        for (std::size_t j = 0; j < terms; ++j)
          EXPECT_EQ(read.covariance.matrix[2 + k][2 + j], covariance[k][j]);
        // Nothing ties the temperature to the pressure, whose own covariance stays.
        EXPECT_EQ(read.covariance.matrix[0][2 + k], 0.0);
        EXPECT_EQ(read.covariance.matrix[2 + k][1], 0.0);
      }
      EXPECT_THAT(read.covariance.matrix[0], Contains(2e-9));
      EXPECT_EQ(read.covariance.matrix[1][1], 9e-8);
    }
  }
}

TEST(Calibration, AppliesThePolynomialInDegreesCelsius) {
  const ModelDefinition file = with_curve(fitted_model());
  // 0.5 - 0.01 t + 0.0001 t^2 by hand; temperatures of 200 to 300 K are rounded to 3e-14 K.
  EXPECT_NEAR(applied(file, -60.0), 1.46, 1e-12);
  EXPECT_NEAR(applied(file, -40.0), 1.06, 1e-12);
  EXPECT_NEAR(applied(file, 0.0), 0.5, 1e-12);
  EXPECT_NEAR(applied(file, 20.0), 0.34, 1e-12);
  EXPECT_NEAR(applied(file, 30.0), 0.29, 1e-12);
  EXPECT_EQ(applied(without_calibration(file), -40.0), 0.0);
  EXPECT_NEAR(applied(with_calibration(file, {-0.25}, {0.1}, {{0.01}}), -40.0), -0.25, 1e-12);
}

/// An hour in memory with a thermometer that no pressure enters.
std::shared_ptr<const FlightSamples> flight_with_thermometer() {
  made::Plan plan;
  plan.defect = made::equation_18;
  FlightSamples samples = made::flight(plan);
  samples.model.roles.push_back(Quantity::ambient_temperature);
  samples.model.columns.emplace_back(Quantity::ambient_temperature,
                                     std::vector<double>(samples.time.size(), 263.15));
  return std::make_shared<const FlightSamples>(std::move(samples));
}

ModelDefinition model_with_thermometer() {
  ModelDefinition file = made::model({"static-constant", "static-alpha", "static-qp"});
  file.variables[Quantity::ambient_temperature] = "ATH1";
  return file;
}

TEST(Calibration, RefitKeepsItUnchanged) {
  const auto flight = flight_with_thermometer();
  const ModelDefinition bare = model_with_thermometer();
  const RefitResult without = refit({flight}, bare, made::pressure_reference());
  const RefitResult with = refit({flight}, with_curve(bare), made::pressure_reference());

  EXPECT_EQ(with.model.model.effects.back().id, "temp-calibration");
  EXPECT_EQ(with.model.model.effects.back().parameters, curve);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_TRUE(with.model.fit(3, k).fixed);
    EXPECT_EQ(with.model.fit(3, k).standard_error, its_errors[k]);
  }
  // A static pressure for reference does not depend on the temperature, so the law is the same with and
  // without.
  for (std::size_t e = 0; e < 3; ++e)
    EXPECT_EQ(with.model.model.effects[e].parameters, without.model.model.effects[e].parameters);
  // The calibration is fixed with a stated error, which here has no effect on other results.
  EXPECT_THAT(with.covariance_names,
              ElementsAre("static-constant.a0", "static-alpha.a1", "static-qp.a2", "temp-calibration.a0",
                          "temp-calibration.a1", "temp-calibration.a2"));
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      EXPECT_EQ(with.covariance[a][b], without.covariance[a][b]);
      EXPECT_EQ(with.covariance[a][3 + b], 0.0);
    }
  }
}

TEST(Calibration, RefitKeepsItsCovariance) {
  const Covariance after =
      refit({flight_with_thermometer()}, with_curve(model_with_thermometer()), made::pressure_reference())
          .model.covariance;
  ASSERT_EQ(after.parameters.size(), 6U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(after.parameters[3 + k], "temp-calibration.a" + std::to_string(k));
    EXPECT_EQ(after.matrix[3 + k][0], 0.0);
    for (std::size_t j = 0; j < 3; ++j) EXPECT_EQ(after.matrix[3 + k][3 + j], its_covariance[k][j]);
  }
}

}  // namespace
}  // namespace pcor
