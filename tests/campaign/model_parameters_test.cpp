#include "campaign/model_parameters.hpp"

#include <gtest/gtest.h>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {
namespace {

// Coefficients of a surface and fixed parameters keep their numbers but are not free.
TEST(ModelParameters, NumbersCountAllEffectsAndFreeOnesOmitSurfacesAndFixedParameters) {
  ModelDefinition model;
  const ModelEffect surface = surface_effect(
      "static-surface",
      {SurfaceAxis{Quantity::mach, 0.2, 0.6, 4}, SurfaceAxis{Quantity::attack_ratio, -0.3, 0.1, 5}});
  model.model.effects = {neutral_effect("qcf-gain"), surface, neutral_effect("aircraft-step")};
  const std::size_t gain = model.model.effects[0].parameters.size();
  EXPECT_EQ(first_parameter_of(model, "qcf-gain"), 0u);
  EXPECT_EQ(first_parameter_of(model, "static-surface"), gain);
  EXPECT_EQ(first_parameter_of(model, "aircraft-step"), gain + 20);
  EXPECT_EQ(first_parameter_of(model, "static-mach"), std::nullopt);
  EXPECT_EQ(parameter_count(model.model), gain + 20 + model.model.effects[2].parameters.size());
  model.fits = {{}, {}, EffectFit(2)};
  model.fits[2][1].fixed = true;
  EXPECT_EQ(free_parameters(model), (std::vector<std::size_t>{0, gain + 20}));
}

}  // namespace
}  // namespace pcor::internal
