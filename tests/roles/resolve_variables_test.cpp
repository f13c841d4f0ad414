#include <pcor/roles/resolve_variables.hpp>

#include <gmock/gmock.h>

#include <fstream>
#include <string>
#include <vector>

#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

namespace pcor {
namespace {

// The frost points of an aircraft file were read, but never used.
TEST(ResolveVariables, FrostPointIsTheLastHumidity) {
  const test::TemporaryDirectory folder;
  std::ofstream(folder / "mine.toml") << R"(
format = "pcor-aircraft/1"
name = "mine"
title = "my aircraft"
[pressures]
measured = [["P", "Q"]]
[series]
dew_point = ["DP"]
frost_point = ["FP"]
)";
  ModelDefinition model;
  model.roles_from = (folder / "mine.toml").string();
  std::vector<std::string> variables{"P", "Q", "FP"};
  const auto humidities = [&] {
    const auto path = folder / "flight.nc";
    test::make_flight(path, test::sequence(0, 3), [&](test::NetcdfMaker& maker) {
      for (const std::string& name : variables)
        maker.series(name, name.size() == 1 ? "hPa" : "degC", {1, 2, 3});
    });
    Notes notes;
    const ModelDefinition resolved = resolve_variables(model, Flight(path), notes);
    return resolved.variable_of(Quantity::dew_point) + "+" + resolved.variable_of(Quantity::frost_point);
  };
  EXPECT_EQ(humidities(), "+FP");
  variables.emplace_back("DP");
  EXPECT_EQ(humidities(), "DP+");
}

// The model could not be written after a fit.
TEST(ResolveVariables, SensorNoiseOfAnAbsentRoleIsRemoved) {
  const test::TemporaryDirectory folder;
  const auto path = folder / "flight.nc";
  test::make_flight(path, test::sequence(0, 3), [&](test::NetcdfMaker& maker) {
    maker.text(NC_GLOBAL, "Aircraft", "N130AR");
    for (const char* const name : {"PSFD", "QCF"}) maker.series(name, "hPa", {1, 2, 3});
  });
  ModelDefinition model;
  model.uncertainty.roles = {{Quantity::static_pressure, 0.05}, {Quantity::attack, 0.1}};
  Notes notes;
  const ModelDefinition resolved = resolve_variables(model, Flight(path), notes);
  EXPECT_THAT(resolved.uncertainty.roles,
              testing::ElementsAre(testing::Pair(Quantity::static_pressure, 0.05)));
  EXPECT_NO_THROW(write_model(resolved));
}

}  // namespace
}  // namespace pcor
