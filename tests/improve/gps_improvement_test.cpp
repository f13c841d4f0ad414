#include <gmock/gmock.h>
#include <pcor/improve/improve.hpp>
#include <pcor/improve/improvement_report.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

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

  // Pictures of the steps show the residuals of the refitted models, not of a linear fit without a prior.
  const Report report = improvement_report(improvement, law, nullptr);
  const auto column = [&report](const char* name) {
    const auto found = std::find_if(report.columns.begin(), report.columns.end(),
                                    [name](const ReportColumn& each) { return each.name == name; });
    return found == report.columns.end() ? std::vector<double>() : found->values;
  };
  for (const auto& [step, model] : {std::pair("step1", "model-refitted"), std::pair("step2", "model-best")}) {
    const std::vector<double> shown = column(step);
    const std::vector<double> residual = column(model);
    ASSERT_EQ(shown.size(), residual.size()) << step;
    std::size_t known = 0;
    for (std::size_t i = 0; i < shown.size(); ++i) {
      if (std::isnan(shown[i]) || std::isnan(residual[i])) continue;
      ++known;
      EXPECT_NEAR(shown[i], residual[i], 1e-5) << step;  // columns of pictures have six digits
    }
    EXPECT_GT(known, 100U) << step;
  }
}
