#include "roles/variable_naming.hpp"

#include <gmock/gmock.h>

#include <set>
#include <string>

#include <pcor/base/error.hpp>
#include <pcor/units/units.hpp>
#include "model_io/model_names.hpp"
#include "roles/usual_variables.hpp"
#include "support/error_of.hpp"
#include "support/netcdf_file.hpp"

namespace pcor::internal {
namespace {

using testing::Contains;

std::optional<Error> rejection_reason_of(const std::string& text) {
  return test::error_of([&] { parse_naming(text, "mine.toml"); });
}

const std::string head = "format = \"pcor-aircraft/1\"\nname = \"mine\"\ntitle = \"my aircraft\"\n";

TEST(VariableNaming, DataAreComplete) {
  std::set<std::string> names;
  for (const VariableNaming& naming : known_namings()) {
    SCOPED_TRACE(naming.name);
    EXPECT_TRUE(names.insert(naming.name).second);
    EXPECT_FALSE(naming.title.empty());
    EXPECT_FALSE(naming.source.empty()) << "names without a source are rumours";
    EXPECT_FALSE(naming.measured.empty());
    EXPECT_FALSE(naming.attributes.empty()) << "no file would be known";
    for (const Thermometer& thermometer : naming.thermometers)
      EXPECT_NE(published_recovery_factor(thermometer.recovery), nullptr) << thermometer.variable;
    std::set<std::string> known;
    for (const auto& [series, variables] : naming.series) {
      ASSERT_NE(series_named(series), nullptr) << series;
      known.insert(variables.begin(), variables.end());
    }
    for (const auto* pairs : {&naming.measured, &naming.processed}) {
      for (const PressurePair& pair : *pairs) known.insert({pair.static_pressure, pair.dynamic_pressure});
    }
    for (const Thermometer& thermometer : naming.thermometers) known.insert(thermometer.variable);
    for (const auto& [variable, trap] : naming.caveats) EXPECT_THAT(known, Contains(variable));
    for (const auto& [variable, unit] : naming.units) {
      EXPECT_THAT(known, Contains(variable));
      EXPECT_TRUE(is_known_unit(unit)) << unit;
    }
  }
  EXPECT_EQ(known_namings().front().name, "ncar") << "whose names are used for a file of an unknown family";
}

TEST(VariableNaming, InvalidFilesAreRefused) {
  EXPECT_THAT(rejection_reason_of("name = \"mine\""),
              test::IsError(Error::Code::definition, "pcor-aircraft/1"));
  EXPECT_THAT(rejection_reason_of("format = \"pcor-aircraft/2\"\nname = \"mine\""),
              test::IsError(Error::Code::definition, "pcor-aircraft/1"));
  EXPECT_THAT(rejection_reason_of("format = \"pcor-aircraft/1\"\nname = \"mine\""),
              test::IsError(Error::Code::definition, "title"));
  EXPECT_THAT(rejection_reason_of(head + "[series]\nheigth = [\"ALT\"]"),
              test::IsError(Error::Code::definition, "heigth"));
  EXPECT_THAT(rejection_reason_of(head + "[series]\naltitude = \"ALT\""),
              test::IsError(Error::Code::definition, "mine.toml:5"));
  EXPECT_THAT(rejection_reason_of(head + "[series]\naltitude = [7]"),
              test::IsError(Error::Code::definition, "mine.toml:5"));
  EXPECT_THAT(rejection_reason_of(head + "[pressures]\nmeasured = [[\"PS\"]]"),
              test::IsError(Error::Code::definition, "mine.toml:5"));
  EXPECT_THAT(rejection_reason_of(head + "[pressures]\nboth = []"),
              test::IsError(Error::Code::definition, "both"));
  EXPECT_THAT(rejection_reason_of(head + "[[thermometer]]\nvariable = \"T\""),
              test::IsError(Error::Code::definition, "mine.toml:4"));
  EXPECT_THAT(rejection_reason_of(head + "[[thermometer]]\nvariable = \"T\"\nrecovery_factor = \"mine\""),
              test::IsError(Error::Code::definition, "mine.toml:6"));
}

TEST(VariableNaming, IsFoundByName) {
  EXPECT_EQ(naming_by_name("faam-core").unit_of("VELD_GIN"), "-1 m s-1");
  EXPECT_EQ(naming_by_name("faam-core").unit_of("ALT_GIN"), "") << "unit of the file";
  EXPECT_THAT(test::error_of([] { naming_by_name("fam-core"); }),
              test::IsError(Error::Code::model, "fam-core", "faam-core"));
  EXPECT_THAT(test::error_of([] { naming_by_name("/nowhere/mine.toml"); }),
              test::IsError(Error::Code::file, "/nowhere/mine.toml"));
}

}  // namespace
}  // namespace pcor::internal
