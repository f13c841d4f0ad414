#include "roles/plausible_pressure.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include <pcor/base/error.hpp>
#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

namespace pcor::internal {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class PlausiblePressure : public testing::Test {
 protected:
  Flight flight(const char* unit, double pressure, const char* other = "", double value = 0.0) {
    const auto path = folder_.path() / "flight.nc";
    {
      test::NetcdfMaker maker(path);
      maker.time(test::sequence(0, 50));
      maker.series("PSFD", unit, std::vector<double>(50, pressure));
      if (*other != '\0') maker.series(other, *other == 'G' ? "m" : "hPa", std::vector<double>(50, value));
    }
    return Flight(path);
  }

  static ModelDefinition model() {
    ModelDefinition model;
    model.variables[Quantity::static_pressure] = "PSFD";
    return model;
  }

  test::TemporaryDirectory folder_;
};

TEST_F(PlausiblePressure, HectopascalsThatAreCalledPascalsAreRefusedWithTheirUnit) {
  const Flight wrong = flight("Pa", 700.0, "GGALT", 3000.0);
  EXPECT_THAT(test::message_of<Error>([&] { require_possible_pressure(wrong, model()); }),
              AllOf(HasSubstr("PSFD in 'Pa'"), HasSubstr("the height GGALT"),
                    HasSubstr("static_pressure = \"hPa\"")));
  ModelDefinition stated = model();
  stated.units[Quantity::static_pressure] = "Pa";
  EXPECT_FALSE(impossible_pressure(wrong, stated)) << "what a model states is believed";
}

TEST_F(PlausiblePressure, WeatherIsNoError) {
  for (const double pressure : {660.0, 700.0, 740.0})
    EXPECT_FALSE(impossible_pressure(flight("hPa", pressure, "GGALT", 3000.0), model())) << pressure;
}

TEST_F(PlausiblePressure, AnotherSystemContradictsAboveFivePercent) {
  EXPECT_TRUE(impossible_pressure(flight("hPa", 700.0, "PSFRD", 760.0), model()));
  EXPECT_FALSE(impossible_pressure(flight("hPa", 700.0, "PSFRD", 710.0), model()));
  EXPECT_FALSE(impossible_pressure(flight("hPa", 700.0), model())) << "nothing to hold it against";
}

}  // namespace
}  // namespace pcor::internal
