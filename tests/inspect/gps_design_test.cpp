#include <pcor/inspect/inspect.hpp>

#include <gmock/gmock.h>
#include <pcor/fit/refit.hpp>
#include <pcor/simulate/simulate.hpp>

#include <netcdf.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "support/temporary_directory.hpp"

namespace {

using pcor::GpsDesign;
using pcor::Quantity;
using testing::AllOf;
using testing::Ge;
using testing::Gt;
using testing::Le;
using testing::Lt;

const std::filesystem::path scenarios = std::filesystem::path(PCOR_SOURCE_DIR) / "data" / "scenarios";

/// A simulated flight, and the model that its inspection proposes.
class Flown {
 public:
  explicit Flown(const std::string& scenario) {
    pcor::simulate_flight(pcor::read_scenario(scenarios / (scenario + ".toml")), path());
    inspection_ = pcor::inspect_flight(path());
  }

  std::filesystem::path path() const { return folder_ / "flight.nc"; }
  const pcor::ModelDefinition& model() const { return inspection_.model.value(); }
  GpsDesign design() const { return inspection_.by_gps.value(); }

  /// The design after all values of some roles are missing.
  std::optional<GpsDesign> design_without(const std::vector<Quantity>& roles) const {
    int file = 0;
    EXPECT_EQ(nc_open(path().c_str(), NC_WRITE, &file), NC_NOERR);
    for (const Quantity role : roles) {
      int variable = 0;
      EXPECT_EQ(nc_inq_varid(file, model().variables.at(role).c_str(), &variable), NC_NOERR);
      const std::vector<float> missing(inspection_.records, -32767.0F);
      const std::size_t first = 0;
      EXPECT_EQ(nc_put_vara_float(file, variable, &first, &inspection_.records, missing.data()), NC_NOERR);
    }
    EXPECT_EQ(nc_close(file), NC_NOERR);
    return pcor::gps_design(pcor::Flight(path()), model());
  }

 private:
  pcor::test::TemporaryDirectory folder_;
  pcor::Inspection inspection_;
};

}  // namespace

TEST(GpsDesign, OnlyCirclesDetermineTheLevel) {
  const GpsDesign circles = Flown("c130-circles").design();
  const GpsDesign one_heading = Flown("c130-one-heading").design();
  // The error of the wind along a single heading is that of delta-p: 1 m/s is about 1 hPa at 100 m/s.
  EXPECT_THAT(circles.level, Lt(0.3));
  EXPECT_THAT(one_heading.level, Gt(1.0));
}

TEST(GpsDesign, LevelErrorAgreesWithRefit) {
  const Flown flown("c130-circles");
  const pcor::RefitResult fit =
      pcor::refit({flown.path()}, flown.model(),
                  {pcor::wind_reference(flown.model()), pcor::height_reference(flown.model())});
  // The fit finds the sizes of the variations of the atmosphere that the design assumes.
  EXPECT_THAT(flown.design().level / fit.defect_error, AllOf(Ge(0.5), Le(2.0)));
}

TEST(GpsDesign, HeightsAddInformationToTheWind) {
  const Flown flown("c130-circles");
  const GpsDesign both = flown.design();
  const GpsDesign by_wind = flown.design_without({Quantity::altitude}).value();
  EXPECT_TRUE(by_wind.by_wind);
  EXPECT_FALSE(by_wind.by_height);
  EXPECT_THAT(both.level, Le(by_wind.level));
  EXPECT_THAT(both.slope, Le(by_wind.slope));
}

TEST(GpsDesign, ModelWithoutAttackTermHasNoErrorOfIt) {
  const Flown flown("c130-circles");
  pcor::ModelDefinition without = flown.model();
  auto& effects = without.model.effects;
  effects.erase(std::remove_if(effects.begin(), effects.end(),
                               [](const pcor::ModelEffect& effect) { return effect.id == "static-alpha"; }),
                effects.end());
  ASSERT_LT(effects.size(), flown.model().model.effects.size());
  EXPECT_TRUE(std::isnan(pcor::gps_design(pcor::Flight(flown.path()), without).value().attack));
}

TEST(GpsDesign, IsAbsentWithoutHeightAndGroundSpeed) {
  const Flown flown("c130-circles");
  EXPECT_FALSE(flown.design_without({Quantity::altitude, Quantity::ground_speed}).has_value());
}
