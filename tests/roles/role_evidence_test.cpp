#include "roles/role_evidence.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

namespace pcor::internal {
namespace {

using testing::ElementsAre;

struct Described {
  std::string name, unit, long_name;
  double value;
};

class RoleEvidence : public testing::Test {
 protected:
  std::map<std::string, std::vector<RoleCandidate>> candidates(const std::vector<Described>& variables) {
    const auto path = folder_.path() / "flight.nc";
    {
      test::NetcdfMaker maker(path);
      maker.time(test::sequence(0, 30));
      for (const Described& each : variables) {
        const int number = maker.series(each.name, each.unit, std::vector<double>(30, each.value));
        if (!each.long_name.empty()) maker.text(number, "long_name", each.long_name);
      }
    }
    return role_candidates(Flight(path));
  }

  test::TemporaryDirectory folder_;
};

TEST(PlainWords, AbbreviationsAreExpanded) {
  EXPECT_THAT(plain_words("wgs_alt"), ElementsAre("wgs", "altitude"));
  EXPECT_THAT(plain_words("trueAirspeed"), ElementsAre("true", "airspeed"));
  EXPECT_THAT(plain_words("dewpoint_temperature"), ElementsAre("dew", "point", "temperature"));
}

TEST_F(RoleEvidence, FindsRolesByNamesAndLongNames) {
  auto found = candidates({{"static_pressure", "hPa", "", 850},
                           {"cabin_pressure", "hPa", "", 900},
                           {"ENGTRQ", "percent", "Engine Torque", 60},
                           {"potential_temperature", "degC", "", 30},
                           {"ambient_temp", "degC", "", 10}});
  ASSERT_TRUE(is_sure(found["static_pressure"]));
  EXPECT_EQ(found["static_pressure"].front().variable, "static_pressure");
  ASSERT_TRUE(is_sure(found["engine_torque"]));
  EXPECT_EQ(found["engine_torque"].front().variable, "ENGTRQ");
  EXPECT_THAT(found["engine_torque"].front().why, testing::HasSubstr("it is called 'Engine Torque'"));
  ASSERT_EQ(found["ambient_temperature"].size(), 1U);
  EXPECT_EQ(found["ambient_temperature"].front().variable, "ambient_temp");
}

TEST_F(RoleEvidence, RequiresAMatchingUnitAndPlausibleValues) {
  auto found = candidates(
      {{"static_pressure", "m/s", "", 850}, {"dynamic_pressure", "hPa", "", -300}, {"roll", "", "", 3}});
  EXPECT_TRUE(found["static_pressure"].empty()) << "another dimension";
  EXPECT_TRUE(found["dynamic_pressure"].empty()) << "no such values in flight";
  ASSERT_EQ(found["roll"].size(), 1U);
  EXPECT_FALSE(is_sure(found["roll"])) << "no unit";
}

// "Dew/Frost Point Temperature" of NCAR's files is the reading of a mirror or a dew point computed from it.
TEST_F(RoleEvidence, FrostPointIsNamedWithoutADewPoint) {
  auto found = candidates({{"FP", "degC", "Frost Point Temperature", -20},
                           {"DPT", "degC", "Dew/Frost Point Temperature, Top", -20},
                           {"frost_point_depression", "K", "", 200}});
  ASSERT_EQ(found["frost_point"].size(), 1U);
  EXPECT_EQ(found["frost_point"].front().variable, "FP");
  EXPECT_TRUE(is_sure(found["frost_point"]));
  EXPECT_TRUE(found["dew_point"].empty());
}

TEST_F(RoleEvidence, SimulatedTruthIsNotACandidate) {
  const auto path = folder_.path() / "flight.nc";
  {
    test::NetcdfMaker maker(path);
    maker.time(test::sequence(0, 30));
    maker.text(maker.series("ambient_temperature", "degC", std::vector<double>(30, 5.0)), "Category",
               "Truth");
  }
  EXPECT_TRUE(role_candidates(Flight(path)).empty());
}

TEST_F(RoleEvidence, TwoEqualCandidatesAreUncertain) {
  auto found = candidates(
      {{"heading_1", "degree", "true heading", 100}, {"heading_2", "degree", "true heading", 101}});
  ASSERT_EQ(found["heading"].size(), 2U);
  EXPECT_FALSE(is_sure(found["heading"]));
}

}  // namespace
}  // namespace pcor::internal
