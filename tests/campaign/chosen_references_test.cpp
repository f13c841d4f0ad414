#include <gmock/gmock.h>
#include <netcdf.h>
#include <pcor/base/error.hpp>
#include <pcor/campaign/chosen_references.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/residuals/reference.hpp>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/error_of.hpp"
#include "support/short_flight.hpp"
#include "support/temporary_directory.hpp"

using pcor::ChosenReferences;
using pcor::ModelDefinition;
using pcor::Quantity;
using pcor::test::laser_model;
using pcor::test::short_flight;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

namespace {

std::vector<std::string> names(const ChosenReferences& references) {
  std::vector<std::string> names;
  for (const auto& reference : references.used) names.push_back(reference->name());
  return names;
}

}  // namespace

TEST(ChosenReferences, OrderIsThatOfTheForms) {
  EXPECT_THAT(pcor::in_order({"wind", "total:a.toml", "pressure:PS", "static:b.toml", "lams"}),
              ElementsAre("lams", "static:b.toml", "pressure:PS", "total:a.toml", "wind"));
}

TEST(ChosenReferences, RequestedReferencesAreUsed) {
  const ChosenReferences chosen = pcor::read_references({"height", "pressure:PS_A"}, laser_model(), {});
  EXPECT_THAT(names(chosen), ElementsAre("height", "pressure:PS_A"));
  EXPECT_THAT(chosen.not_used, IsEmpty());
}

TEST(ChosenReferences, DefaultIsEveryPossibleReference) {
  const ChosenReferences chosen = pcor::read_references({}, laser_model(), {short_flight()});
  EXPECT_THAT(names(chosen), ElementsAre("lams", "total:PSFRD+QCFR", "height", "wind"));
}

TEST(ChosenReferences, ExcludedReferenceHasAReason) {
  ModelDefinition model = laser_model();
  model.variables.erase(Quantity::recovery_temperature);
  model.variables.erase(Quantity::ambient_temperature);
  const ChosenReferences chosen = pcor::read_references({}, model, {short_flight()});
  EXPECT_THAT(names(chosen), ElementsAre("lams", "total:PSFRD+QCFR"));
  EXPECT_THAT(chosen.not_used, ElementsAre(HasSubstr("height: the model names no temperature"),
                                           HasSubstr("wind: the model names no temperature")));
}

// A pair whose unit the aircraft states, and the file does not, was passed over.
TEST(ChosenReferences, DataOfTheAircraftStateTheUnit) {
  const pcor::test::TemporaryDirectory folder;
  const std::filesystem::path flight = folder / "flight.nc";
  std::filesystem::copy_file(short_flight(), flight);
  int file = 0, variable = 0;
  ASSERT_EQ(nc_open(flight.c_str(), NC_WRITE, &file), NC_NOERR);
  ASSERT_EQ(nc_inq_varid(file, "PSFRD", &variable), NC_NOERR);
  ASSERT_EQ(nc_del_att(file, variable, "units"), NC_NOERR);
  ASSERT_EQ(nc_close(file), NC_NOERR);
  std::ofstream(folder / "mine.toml") << R"(
format = "pcor-aircraft/1"
name = "mine"
title = "my aircraft"
[pressures]
measured = [["PSFD", "QCF"], ["PSFRD", "QCFR"]]
[units]
PSFRD = "hPa"
)";
  ModelDefinition model = laser_model();
  model.roles_from = (folder / "mine.toml").string();
  const ChosenReferences chosen = pcor::read_references({}, model, {flight});
  ASSERT_THAT(names(chosen), ElementsAre("lams", "total:PSFRD+QCFR"));
  pcor::Notes notes;
  EXPECT_NO_THROW(chosen.used.back()->read(pcor::Flight(flight), {}, notes));
}

TEST(ChosenReferences, NoLaserAndNoNameIsAnError) {
  // The other references are sensitive to static-pressure changes, or insensitive.
  ModelDefinition model = laser_model();
  model.variables.erase(Quantity::lams_airspeed);
  EXPECT_THROW(pcor::read_references({}, model, {}), pcor::Error);
  // The message did not name the laser that the flight records.
  using References = std::vector<std::string>;
  for (const References& texts : {References{}, References{"lams"}}) {
    EXPECT_THAT(pcor::test::error_of([&] { pcor::read_references(texts, model, {short_flight()}); }),
                pcor::test::IsError(pcor::Error::Code::model, "short", "VLAMS", "[variables]", "static:"));
  }
}

TEST(ChosenReferences, LaserOfAnyFlightIsNamed) {
  ModelDefinition model = laser_model();
  model.variables.erase(Quantity::lams_airspeed);
  const pcor::test::TemporaryDirectory folder;
  const std::filesystem::path without = folder / "without.nc";
  std::filesystem::copy_file(short_flight(), without);
  int file = 0, variable = 0;
  ASSERT_EQ(nc_open(without.c_str(), NC_WRITE, &file), NC_NOERR);
  ASSERT_EQ(nc_inq_varid(file, "VLAMS", &variable), NC_NOERR);
  ASSERT_EQ(nc_redef(file), NC_NOERR);
  ASSERT_EQ(nc_rename_var(file, variable, "OTHER"), NC_NOERR);
  ASSERT_EQ(nc_close(file), NC_NOERR);
  EXPECT_THAT(pcor::test::error_of([&] {
                pcor::read_references({}, model, {without, short_flight()});
              }),
              pcor::test::IsError(pcor::Error::Code::model, short_flight().filename().string(), "VLAMS"));
}
