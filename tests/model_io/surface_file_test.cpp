#include <gmock/gmock.h>

#include <cmath>
#include <string>

#include <pcor/base/error.hpp>
#include <pcor/model_io/model_definition.hpp>

namespace pcor {
namespace {

ModelDefinition with_surface() {
  ModelDefinition file;
  file.model.name = "surface";
  file.variables = {{Quantity::static_pressure, "PSFD"},
                    {Quantity::dynamic_pressure, "QCF"},
                    {Quantity::radome_dynamic_pressure, "QCR"},
                    {Quantity::attack_differential_pressure, "ADIFR"}};
  ModelEffect effect = surface_effect(
      "static-surface", {{{Quantity::attack_ratio, -0.1, 0.3 / 7.0, 5}, {Quantity::mach, 0.2, 0.5, 4}}});
  EffectFit fit(effect.parameters.size());
  for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
    effect.parameters[i] = 0.01 * std::sin(static_cast<double>(i));
    fit[i].standard_error = 0.001;
  }
  file.covariance.parameters = {"static-surface.c1_1", "static-surface.c5_4"};
  file.covariance.matrix = {{1e-6, 5e-7}, {5e-7, 1e-6}};
  file.model.effects.push_back(effect);
  file.fits.push_back(fit);
  return file;
}

}  // namespace

TEST(SurfaceFile, RestoresKnotsCoefficientsAndErrors) {
  const ModelDefinition written = with_surface();
  const ModelDefinition read = parse_model(write_model(written), "test");
  const ModelEffect& before = written.model.effects.front();
  const ModelEffect& after = read.model.effects.front();
  ASSERT_TRUE(after.is_surface());
  EXPECT_EQ(after.parameters, before.parameters);
  EXPECT_EQ(after.parameter_names, before.parameter_names);
  EXPECT_EQ(after.formula, before.formula);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(after.surface->axes[k].quantity, before.surface->axes[k].quantity);
    EXPECT_EQ(after.surface->axes[k].lower, before.surface->axes[k].lower);
    EXPECT_EQ(after.surface->axes[k].upper, before.surface->axes[k].upper);
    EXPECT_EQ(after.surface->axes[k].count, before.surface->axes[k].count);
  }
  EXPECT_EQ(uncertainty_of(read).covariance, uncertainty_of(written).covariance);
  EXPECT_EQ(write_model(read), write_model(written));
}

TEST(SurfaceFile, InvalidSurfaceIsRefused) {
  const auto parse = [](const std::string& effect) {
    parse_model(
        "format = \"pcor-model/1\"\n[variables]\nstatic_pressure = \"P\"\ndynamic_pressure = \"Q\"\n"
        "[[effect]]\n" +
            effect,
        "test");
  };
  const std::string axes = "axes = { attack_ratio = [0.0, 1.0], mach = [0.2, 0.5] }\n";
  const std::string row = "[0, 0, 0, 0]";
  const std::string four = "coefficients = [" + row + "," + row + "," + row + "," + row + "]\n";
  const std::string id = "id = \"static-surface\"\n";
  EXPECT_NO_THROW(parse(id + axes + four));
  EXPECT_THROW(parse(id), Error);
  EXPECT_THROW(parse(id + axes), Error);
  EXPECT_THROW(parse(id + four), Error);
  EXPECT_THROW(parse(id + axes + "coefficients = [" + row + "]\n"), Error);
  EXPECT_THROW(parse(id + axes + "coefficients = []\n"), Error);
  EXPECT_THROW(parse(id + axes + "coefficients = [[1], [1, 2]]\n"), Error);
  EXPECT_THROW(parse(id + axes + "coefficients = 3\n"), Error);
  EXPECT_THROW(parse(id + "axes = { mach = [0.2, 0.5] }\n" + four), Error);
  EXPECT_THROW(parse(id + "axes = { attack_ratio = [1.0, 0.0], mach = [0.2, 0.5] }\n" + four), Error);
  EXPECT_THROW(parse(id + "axes = { attack_angle = [0.0, 1.0], mach = [0.2, 0.5] }\n" + four), Error);
  EXPECT_THROW(parse(id + axes + four + "formula = \"2\"\n"), Error);
  EXPECT_THROW(parse("id = \"static-qp\"\n" + axes + four), Error);
}

}  // namespace pcor
