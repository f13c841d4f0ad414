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

}  // namespace
}  // namespace pcor
