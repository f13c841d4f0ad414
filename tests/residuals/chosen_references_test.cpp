#include <gmock/gmock.h>
#include <pcor/residuals/reference.hpp>
#include <pcor/simulate/simulate.hpp>
#include <pcor/words/error.hpp>

#include <filesystem>
#include <string>
#include <vector>

#include "support/temporary_directory.hpp"

using pcor::ChosenReferences;
using pcor::ModelFile;
using pcor::Quantity;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

namespace {

const std::filesystem::path data = std::filesystem::path(PCOR_SOURCE_DIR) / "data";

const std::filesystem::path& flight_file() {
  static const pcor::test::TemporaryDirectory directory;
  static const std::filesystem::path path = [] {
    pcor::simulate_flight(pcor::read_scenario(data / "scenarios" / "c130-short.toml"),
                          directory / "short.nc");
    return directory / "short.nc";
  }();
  return path;
}

ModelFile laser_model() { return pcor::read_model(data / "scenarios" / "models" / "c130-psfd-eq18.toml"); }

std::vector<std::string> names(const ChosenReferences& references) {
  std::vector<std::string> names;
  for (const auto& reference : references.used) names.push_back(reference->name());
  return names;
}

}  // namespace

TEST(ChosenReferences, AreThoseThatAreNamed) {
  const ChosenReferences chosen = pcor::read_references({"height", "pressure:PS_A"}, laser_model(), {});
  EXPECT_THAT(names(chosen), ElementsAre("height", "pressure:PS_A"));
  EXPECT_THAT(chosen.not_used, IsEmpty());
}

TEST(ChosenReferences, WithoutANameAreAllThatModelAndFlightAllow) {
  const ChosenReferences chosen = pcor::read_references({}, laser_model(), {flight_file()});
  EXPECT_THAT(names(chosen), ElementsAre("lams", "total:PSFRD+QCFR", "height", "wind"));
}

TEST(ChosenReferences, SayWhyOneIsNotAmongThem) {
  ModelFile model = laser_model();
  model.variables.erase(Quantity::recovery_temperature);
  model.variables.erase(Quantity::ambient_temperature);
  const ChosenReferences chosen = pcor::read_references({}, model, {flight_file()});
  EXPECT_THAT(names(chosen), ElementsAre("lams", "total:PSFRD+QCFR"));
  EXPECT_THAT(chosen.not_used, ElementsAre(HasSubstr("height: the model names no temperature"),
                                           HasSubstr("wind: the model names no temperature")));
}

TEST(ChosenReferences, WithoutALaserAreLeftToTheUser) {
  // The others see changes of the static pressure, or nothing of it.
  ModelFile model = laser_model();
  model.variables.erase(Quantity::lams_airspeed);
  EXPECT_THROW(pcor::read_references({}, model, {flight_file()}), pcor::Error);
}
