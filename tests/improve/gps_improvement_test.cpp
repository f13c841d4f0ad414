#include <gmock/gmock.h>
#include <pcor/improve/improve.hpp>
#include <pcor/simulate/simulate.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "support/temporary_directory.hpp"

// The prior of a fit by GPS alone is about the start. Started at the estimate of a diagnosis, an effect
// stayed there.
TEST(GpsImprovement, FitsAnAddedEffectFromTheGivenModel) {
  const std::filesystem::path scenarios = std::filesystem::path(PCOR_SOURCE_DIR) / "data" / "scenarios";
  std::ifstream file(scenarios / "c130-eq18.toml");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const pcor::test::TemporaryDirectory directory;
  pcor::simulate_flight(
      pcor::parse_scenario(text + "\n[[effect]]\nid = \"static-beta-odd\"\nb1 = 0.01\n", "test"),
      directory / "flight.nc");
  const pcor::ModelDefinition law = pcor::read_model(scenarios / "models" / "c130-psfd-eq18.toml");
  const pcor::Improvement improvement =
      pcor::improve(pcor::FlightSet({directory / "flight.nc"}), law, {pcor::wind_reference(law)});
  ASSERT_EQ(improvement.steps.size(), 2U);
  EXPECT_EQ(improvement.steps[1].added, "static-beta-odd");
  const auto fitted = std::find_if(
      improvement.fit.parameters.begin(), improvement.fit.parameters.end(),
      [](const pcor::FittedParameter& parameter) { return parameter.name == "static-beta-odd.b1"; });
  ASSERT_NE(fitted, improvement.fit.parameters.end());
  EXPECT_EQ(fitted->start, 0.0);
  EXPECT_NEAR(fitted->value, 0.01, 4.0 * fitted->standard_error);
}
