// Part of a model that is archived with the steps of hydrostatic height, so that other models are detected.
#include "model_io/archived_model.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <string>

#include "model_io/calibration.hpp"

using namespace pcor::internal;

namespace pcor {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::filesystem::path models = std::filesystem::path(PCOR_SOURCE_DIR) / "data" / "models";

ModelDefinition published_model() { return read_model(models / "c130-psfd-eq18.toml"); }

std::string archived(const ModelDefinition& model) { return archived_model(model, CorrectWith::model); }

TEST(ArchivedModel, IsEqualForModelsWithEqualPressures) {
  ModelDefinition model = with_calibration(published_model(), {0.5, -0.01, 1e-4}, {0.1, 0.1, 0.1},
                                           {{0.01, 0.0, 0.0}, {0.0, 0.01, 0.0}, {0.0, 0.0, 0.01}});
  model.model.name = "another";
  model.model.aircraft.clear();
  model.model.domain.clear();
  model.law = {};
  model.fits[0] = {{true, 1e-4, {}}};
  model.variables[Quantity::altitude] = "GGALTC";
  model.output["PCOR"] = "DELTA_P";
  model = parse_model(write_model(model) + "\n[provenance]\nrms_hpa = 0.3\n", "made");
  EXPECT_EQ(archived(model), archived(published_model()));
  EXPECT_EQ(archived_difference(archived(model), archived(published_model())), "");
}

TEST(ArchivedModel, DiffersIfPressureOrTemperatureModelDiffers) {
  const std::string here = archived(published_model());
  ModelDefinition model = published_model();
  model.model.effects[0].parameters[0] = 0.005;
  EXPECT_THAT(archived_difference(here, archived(model)),
              AllOf(HasSubstr("static-constant"), HasSubstr("a0 = 0.004127875 } in the file"),
                    HasSubstr("a0 = 0.005 } in the model")));
  model = published_model();
  model.variables[Quantity::recovery_temperature] = "TTRL";
  EXPECT_THAT(archived_difference(here, archived(model)), AllOf(HasSubstr("TTRR"), HasSubstr("TTRL")));
  model = published_model();
  model.units[Quantity::static_pressure] = "mbar";
  EXPECT_NE(archived(model), here);
  model = published_model();
  model.model.moist = false;
  EXPECT_NE(archived(model), here);
  model = published_model();
  model.model.effects.pop_back();
  EXPECT_THAT(archived_difference(here, archived(model)), HasSubstr("nothing in the model"));
  EXPECT_NE(archived(read_model(models / "c130-psfd-eq19.toml")), here);
}

TEST(ArchivedModel, IncludesLaserOnlyIfItCorrects) {
  ModelDefinition model = published_model();
  model.variables[Quantity::lams_airspeed] = "VLAMS";
  model.variables[Quantity::attack] = "ATTACK";
  model.variables[Quantity::sideslip] = "SSLIP";
  model.model.lams.elevation = 1.0;
  EXPECT_EQ(archived(model), archived(published_model()));
  const std::string by_laser = archived_model(model, CorrectWith::lams);
  EXPECT_THAT(by_laser, AllOf(HasSubstr("VLAMS"), HasSubstr("ATTACK")));
  EXPECT_THAT(archived_difference(by_laser, archived(model)), HasSubstr("LAMS"));
}

}  // namespace
}  // namespace pcor
