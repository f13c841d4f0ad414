#include "roles/usual_variables.hpp"

#include <gmock/gmock.h>

#include <pcor/units/units.hpp>
#include "laws/model_names.hpp"

namespace pcor::internal {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsSupersetOf;
using testing::Not;

TEST(UsualVariables, BelongToRolesThatAModelNeedNotName) {
  EXPECT_THAT(usual_variables(Quantity::attack), ElementsAre("ATTACK", "AKRD"));
  EXPECT_THAT(usual_variables(Quantity::cabin_pressure), ElementsAre("PCAB"));
  for (const Quantity role :
       {Quantity::static_pressure, Quantity::dynamic_pressure, Quantity::lams_airspeed, Quantity::mach,
        Quantity::vapor_pressure, Quantity::dew_point, Quantity::recovery_temperature,
        Quantity::ambient_temperature, Quantity::corrected_mach})
    EXPECT_TRUE(usual_variables(role).empty()) << facts_of(role).name;
}

TEST(UsualVariables, OfTheAltitudeAreHeightsByGps) {
  // Against the height that a pressure makes, no pressure could be tested.
  EXPECT_THAT(usual_variables(Quantity::altitude), Not(Contains("PALT")));
  EXPECT_THAT(usual_heights(), IsSupersetOf(usual_variables(Quantity::altitude)));
  EXPECT_EQ(usual_heights().back(), "PALT");
}

TEST(UsualVariables, AreConvertedToUnitsThatThereAre) {
  for (const char* series : {"other_altitude", "longitude", "ground_speed_east", "ground_speed_north"}) {
    const std::string unit(usual_series(series).series.unit);
    EXPECT_NO_THROW(UnitConversion::between(unit, unit, {series, "", ""})) << series;
  }
  EXPECT_THROW(usual_series("ground_speed_up"), std::out_of_range);
}

TEST(UsualThermometers, HaveAPublishedRecoveryFactorEach) {
  for (const Thermometer& thermometer : usual_thermometers())
    EXPECT_NE(published_recovery_factor(thermometer.recovery), nullptr) << thermometer.variable;
}

}  // namespace
}  // namespace pcor::internal
