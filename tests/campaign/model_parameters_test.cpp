#include "campaign/model_parameters.hpp"

#include <gtest/gtest.h>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {
namespace {

// A surface is not in the catalogue: its location was read through a null pointer.
TEST(ModelParameters, EveryKindOfEffectHasALocation) {
  const ModelEffect surface = surface_effect(
      "static-surface",
      {SurfaceAxis{Quantity::mach, 0.2, 0.6, 4}, SurfaceAxis{Quantity::attack_ratio, -0.3, 0.1, 4}});
  EXPECT_EQ(location_of(surface), EffectLocation::static_defect);
  EXPECT_EQ(location_of(neutral_effect("qcf-gain")), EffectLocation::dynamic_transducer);
  ModelEffect formula;
  formula.id = "mine";
  formula.formula = "k * altitude";
  formula.location = EffectLocation::pitot;
  EXPECT_EQ(location_of(formula), EffectLocation::pitot);
}

}  // namespace
}  // namespace pcor::internal
