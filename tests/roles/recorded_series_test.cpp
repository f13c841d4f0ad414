#include "roles/recorded_series.hpp"

#include <gmock/gmock.h>

#include <optional>
#include <string>
#include <vector>

#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

namespace pcor::internal {
namespace {

/// Its second pair, its altitude and its thermometer have no unit in the file.
const VariableNaming& aircraft() {
  static const VariableNaming naming = parse_naming(R"(
format = "pcor-aircraft/1"
name = "mine"
title = "my aircraft"
[pressures]
measured = [["P1", "Q1"], ["P2", "Q2"]]
processed = [["P1", "Q1"], ["P2", "Q1"]]
[series]
altitude = ["H1", "H2", "H3"]
[[thermometer]]
variable = "T1"
recovery_factor = "rosemount-boom-2004"
[[thermometer]]
variable = "T2"
recovery_factor = "harco-heated-2022"
[units]
P2 = "hPa"
Q2 = "hPa"
H2 = "ft"
T2 = "degC"
)",
                                                    "mine.toml");
  return naming;
}

class WithValues : public testing::Test {
 protected:
  const Flight& flight() {
    const auto path = folder_ / "flight.nc";
    test::make_flight(path, test::sequence(0, 3), [](test::NetcdfMaker& maker) {
      maker.series("P1", "hPa", {700, 701, 702});
      maker.series("Q1", "hPa", {-32767, -32767, -32767});
      for (const char* const name : {"P2", "Q2", "H2", "T2"}) maker.series(name, "", {1, 2, 3});
      maker.series("H1", "K", {1, 2, 3});
      maker.series("H3", "m", {1, 2, 3});
    });
    return flight_.emplace(path);
  }

 private:
  test::TemporaryDirectory folder_;
  std::optional<Flight> flight_;
};

TEST_F(WithValues, UnitMayBeStatedByTheAircraft) {
  const Flight& file = flight();
  const PressurePair* const pair = first_with_values(file, aircraft(), aircraft().measured);
  ASSERT_NE(pair, nullptr);
  EXPECT_EQ(pair->name(), "P2/Q2");
  EXPECT_EQ(first_with_values(file, aircraft(), "altitude"), "H2");
  const Thermometer* const thermometer = first_with_values(file, aircraft(), aircraft().thermometers);
  ASSERT_NE(thermometer, nullptr);
  EXPECT_EQ(thermometer->variable, "T2");
}

TEST_F(WithValues, NothingIsFoundWithoutValues) {
  const Flight& file = flight();
  EXPECT_EQ(first_with_values(file, aircraft(), aircraft().processed), nullptr) << "Q1 is missing";
  EXPECT_EQ(first_with_values(file, aircraft(), "roll"), "") << "the aircraft names no variable of that role";
  EXPECT_EQ(first_with_values(file, aircraft(), VariableNaming().thermometers), nullptr);
  EXPECT_EQ(processed_static_pressure(file, aircraft()), "P1") << "has values without its dynamic pressure";
}

}  // namespace
}  // namespace pcor::internal
