#include "roles/model_inputs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include <pcor/flight/flight.hpp>
#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

namespace pcor::internal {
namespace {

bool is_of_same_aircraft(const std::string& model, const std::string& platform) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path path = folder.path() / "flight.nc";
  {
    test::NetcdfMaker maker(path);
    maker.time({100, 101});
    maker.series("PSFD", "hPa", {850, 851});
    maker.text(NC_GLOBAL, "platform", platform);
  }
  ModelDefinition file;
  file.model.aircraft = model;
  return is_of_aircraft(file, Flight(path));
}

// A part of the name was enough: the law of N130AR corrected any C-130, without a warning.
TEST(ModelInputs, AircraftIsRecognisedByItsRegistration) {
  EXPECT_TRUE(is_of_same_aircraft("C-130 N130AR", "N130AR"));
  EXPECT_TRUE(is_of_same_aircraft("C-130 N130AR", "NSF/NCAR C-130 (N130AR)"));
  EXPECT_TRUE(is_of_same_aircraft("C-130H, 4X-FBB", "4X-FBB"));
  EXPECT_TRUE(is_of_same_aircraft("my aircraft", "my aircraft"));
  EXPECT_TRUE(is_of_same_aircraft("King Air JA8570", "JA8570"));
  EXPECT_FALSE(is_of_same_aircraft("King Air JA8570", "King Air"));
  for (const char* const platform : {"C-130", "N130", "N", "N130A", "N677F", ""})
    EXPECT_FALSE(is_of_same_aircraft("C-130 N130AR", platform)) << platform;
}

// The recovery correction was applied to a temperature that had it, without a word.
TEST(ModelInputs, AmbientTemperatureAsRecoveryTemperatureGivesAWarning) {
  const auto warnings = [](const std::string& long_name, const std::string& standard_name) {
    const test::TemporaryDirectory folder;
    const std::filesystem::path path = folder.path() / "flight.nc";
    {
      test::NetcdfMaker maker(path);
      maker.time({100, 101});
      maker.series("PSFD", "hPa", {850, 851});
      maker.series("QCF", "hPa", {60, 61});
      const int variable = maker.series("T", "K", {280, 281});
      if (!long_name.empty()) maker.text(variable, "long_name", long_name);
      if (!standard_name.empty()) maker.text(variable, "standard_name", standard_name);
    }
    ModelDefinition file;
    file.variables = {{Quantity::static_pressure, "PSFD"},
                      {Quantity::dynamic_pressure, "QCF"},
                      {Quantity::recovery_temperature, "T"}};
    Notes notes;
    for (int i = 0; i < 2; ++i)  // a flight with two models of the same variable
      model_inputs(Flight(path), file, chain_of(file.model, file.roles()), file.roles(), notes);
    return std::count_if(notes.begin(), notes.end(),
                         [](const Note& note) { return note.severity == Severity::warning; });
  };
  EXPECT_EQ(warnings("Ambient Temperature, Reference", "air_temperature"), 1);
  EXPECT_EQ(warnings("Static Air Temperature", ""), 1);
  EXPECT_EQ(warnings("", "air_temperature"), 1);
  EXPECT_EQ(warnings("Total Air Temperature, Reverse Flow", "air_temperature"), 0);
  EXPECT_EQ(warnings("Recovery Air Temperature, Deiced Right, HARCO", ""), 0);
  EXPECT_EQ(warnings("", ""), 0);
}

// delta-p was added to a pressure that had it already.
TEST(ModelInputs, CorrectedOrCabinPressureGivesAWarning) {
  const auto warnings = [](const std::string& long_name, double coefficient,
                           const Provenance& provenance = {}) {
    const test::TemporaryDirectory folder;
    const std::filesystem::path path = folder.path() / "flight.nc";
    {
      test::NetcdfMaker maker(path);
      maker.time({100, 101});
      maker.text(maker.series("P", "hPa", {850, 851}), "long_name", long_name);
      maker.series("QCF", "hPa", {60, 61});
    }
    ModelDefinition file;
    file.variables = {{Quantity::static_pressure, "P"}, {Quantity::dynamic_pressure, "QCF"}};
    file.model.effects = {neutral_effect("static-constant")};
    file.model.effects[0].parameters = {coefficient};
    file.provenance = provenance;
    Notes notes;
    model_inputs(Flight(path), file, chain_of(file.model, file.roles()), file.roles(), notes);
    return notes.size();
  };
  EXPECT_EQ(warnings("Corrected Static Pressure, Fuselage Digital", 0.01), 1U);
  EXPECT_EQ(warnings("Corrected Static Pressure, Fuselage Digital", 0.0), 0U);
  const auto fitted_to = [](const char* pressure) {
    return Provenance{{"pressures", ProvenanceList{std::string(pressure), std::string("QCF")}}};
  };
  EXPECT_EQ(warnings("Corrected Static Pressure, Fuselage Digital", 0.01, fitted_to("P")), 0U);
  EXPECT_EQ(warnings("Corrected Static Pressure, Fuselage Digital", 0.01, fitted_to("PSFD")), 1U)
      << "the user exchanged the variables after the fit";
  const Provenance began_without_law{
      {"before", ProvenanceList{Provenance{{"source", std::string(source_without_law)}}}}};
  EXPECT_EQ(warnings("Corrected Static Pressure, Fuselage Digital", 0.01, began_without_law), 0U);
  EXPECT_EQ(warnings("Static Pressure, not corrected for position error", 0.01), 0U);
  EXPECT_EQ(warnings("Interior Cabin Static Pressure", 0.0), 1U);
  EXPECT_EQ(warnings("Raw Static Pressure, Fuselage", 0.01), 0U);
}

}  // namespace
}  // namespace pcor::internal
