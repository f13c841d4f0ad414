#include <gmock/gmock.h>
#include <pcor/improve/improve.hpp>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>

#include "support/short_flight.hpp"

using namespace pcor;

// The prior of a fit by GPS alone is about the start. Started at the estimate of a diagnosis, an effect
// stayed there.
TEST(GpsImprovement, FitsAnAddedEffectFromTheGivenModel) {
  std::ifstream file(test::scenarios / "c130-eq18.toml");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const test::TemporaryDirectory directory;
  simulate_flight(parse_scenario(text + "\n[[effect]]\nid = \"static-beta-odd\"\nb1 = 0.01\n", "test"),
                  directory / "flight.nc");
  const ModelDefinition law = test::laser_model();
  const Improvement improvement = improve(FlightSet({directory / "flight.nc"}), law, {wind_reference(law)});
  ASSERT_EQ(improvement.steps.size(), 2U);
  EXPECT_EQ(improvement.steps[1].added, "static-beta-odd");
  const auto fitted =
      std::find_if(improvement.fit.parameters.begin(), improvement.fit.parameters.end(),
                   [](const FittedParameter& parameter) { return parameter.name == "static-beta-odd.b1"; });
  ASSERT_NE(fitted, improvement.fit.parameters.end());
  EXPECT_EQ(fitted->start, 0.0);
  EXPECT_NEAR(fitted->value, 0.01, 4.0 * fitted->standard_error);
}
