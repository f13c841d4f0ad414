#include "model_io/sensor_uncertainty.hpp"

#include <gmock/gmock.h>

#include <string>

#include <pcor/base/error.hpp>

using namespace pcor::internal;

namespace pcor {
namespace {

using testing::ElementsAre;

std::string model_text(const std::string& more) {
  return R"(
format = "pcor-model/1"
name = "one term"
[variables]
static_pressure = "PSFD"
dynamic_pressure = "QCF"
recovery_temperature = "TTRR"
[temperature]
recovery_factor = 0.95
[[effect]]
id = "static-constant"
)" + more;
}

std::vector<std::string> parameters_of(const std::vector<SensorUncertainty>& uncertainties) {
  std::vector<std::string> names;
  for (const SensorUncertainty& uncertainty : uncertainties) names.push_back(uncertainty.name());
  return names;
}

std::vector<SensorUncertainty> thermometer_of(const std::string& more) {
  return uncertainties_of(parse_model(model_text(more), "m.toml"), thermometer_calibration);
}

TEST(SensorUncertainty, ModelPriorOverridesTheCatalogue) {
  const auto usual = thermometer_of("");
  EXPECT_THAT(parameters_of(usual), ElementsAre("temp-offset.offset", "recovery-factor.da"));
  EXPECT_DOUBLE_EQ(usual[0].size, 0.3);
  EXPECT_DOUBLE_EQ(usual[1].size, 0.005);
  const auto stated =
      thermometer_of("[uncertainty]\n\"temp-offset.offset\" = 0.05\n\"recovery-factor.da\" = 0\n");
  EXPECT_THAT(parameters_of(stated), ElementsAre("temp-offset.offset"));
  EXPECT_DOUBLE_EQ(stated[0].size, 0.05);
  // An effect of the model defines the uncertainty of the sensor.
  EXPECT_THAT(parameters_of(thermometer_of("[[effect]]\nid = \"temp-offset\"\n")),
              ElementsAre("recovery-factor.da"));
  EXPECT_THAT(parameters_of(thermometer_of("[[effect]]\nid = \"temp-calibration\"\n")),
              ElementsAre("recovery-factor.da"));
  EXPECT_THROW(thermometer_of("[uncertainty]\n\"static-constant.a0\" = 0.05\n"), Error);
}

TEST(SensorUncertainty, ModelAndItsErrorStayUnchanged) {
  const ModelDefinition given = parse_model(model_text(""), "m.toml");
  const ModelDefinition extended =
      with_uncertain_sensors(given, uncertainties_of(given, thermometer_calibration));
  ASSERT_EQ(extended.model.effects.size(), 3U);
  EXPECT_THAT(extended.model.effects[1].parameters, ElementsAre(0.0, 0.0));
  EXPECT_TRUE(extended.fit(1, 0).fixed);
  const ModelUncertainty uncertainty = uncertainty_of(extended);
  // a0, offset, slope, da
  EXPECT_DOUBLE_EQ(uncertainty.covariance[1 * 4 + 1], 0.09);
  EXPECT_DOUBLE_EQ(uncertainty.covariance[2 * 4 + 2], 0.0);
  EXPECT_DOUBLE_EQ(uncertainty.covariance[3 * 4 + 3], 0.005 * 0.005);
}

TEST(SensorUncertainty, CovarianceRoundTripsAndFollowsItsEffect) {
  ModelDefinition file = parse_model(model_text(""), "m.toml");
  file.covariance = {{"static-constant.a0", "temp-offset.offset"}, {{1e-6, 1e-4}, {1e-4, 0.04}}};
  const ModelDefinition read = parse_model(write_model(file), "m.toml");
  EXPECT_EQ(read.covariance.parameters, file.covariance.parameters);
  EXPECT_EQ(read.covariance.matrix, file.covariance.matrix);
  EXPECT_THAT(stated_uncertainty(read).covariance, ElementsAre(1e-6));
  const ModelDefinition extended =
      with_uncertain_sensors(read, uncertainties_of(read, thermometer_calibration));
  const ModelUncertainty uncertainty = uncertainty_of(extended);
  EXPECT_DOUBLE_EQ(uncertainty.covariance[0 * 4 + 1], 1e-4);
  EXPECT_DOUBLE_EQ(uncertainty.covariance[1 * 4 + 1], 0.04);
  EXPECT_EQ(uncertainty_of(read).covariance, uncertainty.covariance);
}

// Without it the temperature of a loop would have the small error of the pressures.
TEST(SensorUncertainty, StatedUncertaintyIncludesTheThermometer) {
  const auto calibration_of = [](const std::string& text) {
    std::vector<std::string> ids;
    for (const ModelEffect& effect : uncertainty_of(parse_model(text, "m.toml")).calibration)
      ids.push_back(effect.id);
    return ids;
  };
  const std::string stated = model_text("stderr = { a0 = 1e-4 }\n");
  EXPECT_THAT(calibration_of(stated), ElementsAre("temp-offset", "recovery-factor"));
  EXPECT_THAT(calibration_of(stated + "[[effect]]\nid = \"temp-offset\"\n"), ElementsAre("recovery-factor"));
  EXPECT_THAT(calibration_of(model_text("")), ElementsAre()) << "no uncertainty is stated";
  EXPECT_TRUE(uncertainty_of(parse_model(stated, "m.toml")).random_part().calibration.empty());
}

}  // namespace
}  // namespace pcor
