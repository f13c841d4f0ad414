// Every published law through compare, refit, diagnose and improve, on a flight that has all variables.
#include <gmock/gmock.h>
#include <pcor/compare/compare.hpp>
#include <pcor/diagnose/diagnose.hpp>
#include <pcor/improve/improve.hpp>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "support/data.hpp"
#include "support/short_flight.hpp"
#include "support/test_name.hpp"

using testing::Gt;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

namespace pcor {
namespace {

using test::data_directory;

/// The law on the variables of the flight: those that only other aircraft have get their like, and the laser
/// and its angle of attack join.
ModelDefinition read_law(const std::filesystem::path& path) {
  const std::map<std::string, std::string> equivalent{
      {"PSF", "PSFD"}, {"PSTF", "PSFRD"}, {"QCTF", "QCFR"}, {"TTHR1", "TTRR"}, {"RTH1", "RTF1"}};
  ModelDefinition file = read_model(path);
  for (auto& [role, variable] : file.variables) {
    if (const auto found = equivalent.find(variable); found != equivalent.end()) variable = found->second;
  }
  file.variables.emplace(Quantity::attack, "ATTACK");
  file.variables.emplace(Quantity::lams_airspeed, "VLAMS");
  return file;
}

class PublishedLaw : public testing::TestWithParam<std::filesystem::path> {};

std::vector<std::filesystem::path> laws() {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(data_directory / "models")) {
    if (entry.path().extension() == ".toml") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

TEST(PublishedLaws, ThereAreTwentyFive) { EXPECT_THAT(laws(), SizeIs(25)); }

TEST_P(PublishedLaw, EveryCommandAcceptsAFlightWithAllVariables) {
  const ModelDefinition file = read_law(GetParam());
  const FlightSet flight{test::short_flight()};
  const std::shared_ptr<const Reference> laser = lams_reference();
  const std::shared_ptr<const Reference> pressure = read_reference("pressure:PS_A", file);
  for (const auto& reference : {laser, pressure}) {
    const Comparison comparison = compare(flight, {{"law", file, {reference}}});
    EXPECT_THAT(comparison.models.front().all.samples, Gt(500U)) << reference->name();
  }
  EXPECT_THAT(refit(flight, file, {pressure}).samples, Gt(500U));
  EXPECT_THAT(diagnose(flight, file, {laser}).candidates, Gt(10U));
}

class PublishedLawStudy : public PublishedLaw {};

TEST_P(PublishedLawStudy, ImproveAcceptsAFlightWithAllVariables) {
  ImproveOptions once;
  once.max_steps = 1;
  const Improvement improvement =
      improve(FlightSet{test::short_flight()}, read_law(GetParam()), {lams_reference()}, once);
  EXPECT_THAT(improvement.fit.samples, Gt(500U));
  ASSERT_THAT(improvement.steps, Not(IsEmpty()));
  EXPECT_THAT(improvement.steps.front().diagnosis.candidates, Gt(10U));
}

TEST(Laws, PressureReferenceRequiresNoThermometer) {
  ModelDefinition file = read_law(data_directory / "models" / "c130-psfd-eq18.toml");
  for (const Quantity role : {Quantity::recovery_temperature, Quantity::ambient_temperature,
                              Quantity::vapor_pressure, Quantity::dew_point, Quantity::lams_airspeed})
    file.variables.erase(role);
  const std::shared_ptr<const Reference> reference = read_reference("pressure:PS_A", file);
  EXPECT_THAT(diagnose({test::short_flight()}, file, {reference}).candidates, Gt(10U));
}

std::string name_of(const testing::TestParamInfo<std::filesystem::path>& law) {
  return test::test_name(law.param.stem().string());
}

INSTANTIATE_TEST_SUITE_P(Data, PublishedLaw, testing::ValuesIn(laws()), name_of);
INSTANTIATE_TEST_SUITE_P(Data, PublishedLawStudy, testing::ValuesIn(laws()), name_of);

}  // namespace
}  // namespace pcor
