#include "roles/usual_variables.hpp"

#include <gmock/gmock.h>

namespace pcor::internal {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsSupersetOf;
using testing::Not;

TEST(UsualVariables, ExistForOptionalRolesOnly) {
  const VariableNaming& ncar = naming_by_name("ncar");
  EXPECT_THAT(usual_variables(ncar, Quantity::attack), ElementsAre("ATTACK", "AKRD"));
  EXPECT_THAT(usual_variables(ncar, Quantity::cabin_pressure), ElementsAre("PCAB"));
  EXPECT_THAT(usual_variables(Quantity::attack), IsSupersetOf({"ATTACK", "AOA", "alpha", "ALPHA"}));
  for (const Quantity role :
       {Quantity::static_pressure, Quantity::dynamic_pressure, Quantity::lams_airspeed, Quantity::mach,
        Quantity::vapor_pressure, Quantity::dew_point, Quantity::recovery_temperature,
        Quantity::ambient_temperature, Quantity::corrected_mach})
    EXPECT_TRUE(usual_variables(role).empty()) << info_of(role).name;
}

TEST(UsualVariables, UsualAltitudesAreGpsHeights) {
  // Against the height that a pressure makes, no pressure could be tested.
  const VariableNaming& ncar = naming_by_name("ncar");
  EXPECT_THAT(usual_variables(ncar, Quantity::altitude), Not(Contains("PALT")));
  EXPECT_THAT(usual_heights(ncar), IsSupersetOf(usual_variables(ncar, Quantity::altitude)));
  EXPECT_EQ(usual_heights(ncar).back(), "PALT");
}

TEST(UsualVariables, SeriesOutsideModelsHaveUnits) {
  ASSERT_NE(series_named("longitude"), nullptr);
  EXPECT_EQ(series_named("longitude")->unit, "deg");
  EXPECT_EQ(series_named("roll"), &info_of(Quantity::roll));
  EXPECT_EQ(series_named("ground_speed_up"), nullptr);
  EXPECT_EQ(series_named("corrected_mach"), nullptr) << "it is a result";
}

TEST(NamesOfSeries, MeasuredSeriesHaveLimits) {
  for (const std::string& series : pcor::internal::names_of_series()) {
    const pcor::QuantityInfo& info = *pcor::internal::series_named(series);
    if (info.quantity == pcor::Quantity::date) continue;
    EXPECT_GT(info.minimum, -1e6) << series;
    EXPECT_LT(info.maximum, 1e6) << series;
  }
}

}  // namespace
}  // namespace pcor::internal
