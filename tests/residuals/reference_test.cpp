#include <pcor/residuals/reference.hpp>

#include <gmock/gmock.h>

#include <map>
#include <string>
#include <vector>

#include <pcor/base/error.hpp>

#include "support/data.hpp"
#include "support/error_of.hpp"
#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

namespace pcor {
namespace {

using test::data_directory;
using testing::ElementsAre;
using testing::HasSubstr;

ModelDefinition with_laser() {
  return read_model(data_directory / "scenarios" / "models" / "c130-psfd-eq18.toml");
}
ModelDefinition without_laser() { return read_model(data_directory / "models" / "c130-psfd-eq18.toml"); }

std::optional<Error> refusal(const std::string& text, const ModelDefinition& model) {
  return test::error_of([&] { read_reference(text, model); });
}

TEST(Reference, IsReadFromItsName) {
  EXPECT_EQ(read_reference("lams", with_laser())->description(), "LAMS");
  EXPECT_THAT(read_reference("pressure:PS_A", without_laser())->variables(), ElementsAre("PS_A"));
  const std::string file = (data_directory / "models" / "c130-psfrd-eq18.toml").string();
  EXPECT_EQ(read_reference("static:" + file, without_laser())->model()->model.name,
            read_model(file).model.name);
}

TEST(Reference, UnknownTextIsRefusedWithTheValidForms) {
  for (const char* form : {"lams (", ", static:OTHER.toml (", ", pressure:VARIABLE (", ", total:OTHER.toml (",
                           ", height (", " or wind ("})
    EXPECT_THAT(reference_forms(), HasSubstr(form));
  for (const char* text :
       {"static:", "pressure:", "lams:", "lams:V", "wind:", "total", "PS_A", ":", "static", "LAMS"})
    EXPECT_THAT(refusal(text, with_laser()), test::IsError(Error::Code::usage, text)) << text;
  for (const char* text : {"static:absent.toml", "static:my+absent.toml", "total:my+absent.toml"})
    EXPECT_THAT(refusal(text, with_laser()), test::IsError(Error::Code::file, "absent.toml")) << text;
  EXPECT_THAT(refusal("psfrd", with_laser()), test::IsError(Error::Code::usage, reference_forms()));
}

TEST(Reference, LaserMissingFromTheModelIsRefused) {
  EXPECT_THAT(refusal("lams", without_laser()),
              test::IsError(Error::Code::model, "lams_airspeed", "static:OTHER.toml"));
}

TEST(Reference, PressureComputedFromThatOfTheModelGivesAWarning) {
  const test::TemporaryDirectory folder;
  {
    test::NetcdfMaker maker(folder.path() / "flight.nc");
    maker.time(test::sequence(0, 50));
    for (const char* const name : {"PSFD", "PSFRD", "PS_A", "PSFDC", "PSXC"}) {
      const int variable = maker.series(name, "hPa", std::vector<double>(50, 700.0));
      if (std::string(name) == "PSFDC") maker.text(variable, "Dependencies", "2 PSFD RATIO");
      if (std::string(name) == "PSXC") maker.text(variable, "Dependencies", "1 PSFDC");
    }
  }
  const Flight flight(folder.path() / "flight.nc");
  for (const auto& [variable, warnings] : std::map<std::string, std::size_t>{
           {"PSXC", 1}, {"PSFDC", 1}, {"PSFD", 1}, {"PS_A", 0}, {"PSFRD", 0}}) {
    Notes notes;
    read_reference("pressure:" + variable, without_laser())->read(flight, {}, notes);
    EXPECT_EQ(notes.size(), warnings) << variable;
    for (const Note& note : notes) EXPECT_EQ(note.severity, Severity::warning);
  }
}

TEST(Reference, PressureThatIsNotStaticIsRefused) {
  const test::TemporaryDirectory folder;
  {
    test::NetcdfMaker maker(folder.path() / "flight.nc");
    maker.time(test::sequence(0, 50));
    maker.text(maker.series("QCF", "hPa", std::vector<double>(50, 70.0)), "long_name",
               "Raw Dynamic Pressure");
    maker.text(maker.series("PCAB", "hPa", std::vector<double>(50, 710.0)), "long_name",
               "Interior Cabin Static Pressure");
    maker.text(maker.series("PSFRD", "hPa", std::vector<double>(50, 700.0)), "long_name",
               "Raw Static Pressure");
    maker.text(maker.series("QCR", "hPa", std::vector<double>(50, 70.0)), "long_name",
               "Raw Dynamic Pressure, Radome");
    maker.text(maker.series("QCA", "hPa", std::vector<double>(50, 70.0)), "long_name", "Pitot air pressure");
    maker.text(maker.series("QC", "hPa", std::vector<double>(50, 250.0)), "long_name",
               "Ambient pressure, quality controlled");
  }
  const Flight flight(folder.path() / "flight.nc");
  Notes notes;
  const auto read = [&](const std::string& variable) {
    return read_reference("pressure:" + variable, without_laser())->read(flight, {}, notes);
  };
  for (const char* const variable : {"QCF", "PCAB", "QCR", "QCA"}) {
    EXPECT_THAT(test::error_of([&] { read(variable); }), test::IsError(Error::Code::variable, variable));
  }
  read("QC");
  // A program that tests the pressure of the model itself reads it without a model to compare it with.
  pressure_reference("PSFRD")->read(flight, {}, notes);
  EXPECT_TRUE(notes.empty());
  read("PSFRD");
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].severity, Severity::warning);
}

TEST(Reference, ListsItsVariables) {
  EXPECT_TRUE(lams_reference()->reads_laser());
  EXPECT_TRUE(lams_reference()->variables().empty());
  EXPECT_EQ(lams_reference()->model(), nullptr);
  const auto system = static_system_reference(with_laser());
  EXPECT_FALSE(system->reads_laser()) << "the laser belongs to the model that is compared with it";
  EXPECT_THAT(system->variables(), testing::IsSupersetOf({"PSFD", "QCF", "ADIFR", "QCR"}));
}

}  // namespace
}  // namespace pcor
