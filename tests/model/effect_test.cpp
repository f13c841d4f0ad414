#include <gtest/gtest.h>
#include <pcor/model/effect.hpp>

#include <set>
#include <string>

using pcor::effect_location_info;
using pcor::EffectInfo;
using pcor::EffectLocation;
using pcor::location_count;
using pcor::location_named;
using pcor::Quantity;

TEST(EffectLocation, NamesResolveToTheirPlace) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < location_count; ++i) {
    EXPECT_EQ(location_named(effect_location_info[i].name), static_cast<EffectLocation>(i))
        << effect_location_info[i].name;
    EXPECT_TRUE(names.emplace(effect_location_info[i].name).second) << effect_location_info[i].name;
    EXPECT_FALSE(effect_location_info[i].unit.empty());
    EXPECT_FALSE(effect_location_info[i].adds_to.empty());
    EXPECT_FALSE(effect_location_info[i].component.empty());
    EXPECT_EQ(&info_of(static_cast<EffectLocation>(i)), &effect_location_info[i]);
  }
  EXPECT_EQ(location_named("wing"), EffectLocation::count);
}

TEST(EffectLocation, StaticIsTheLocationOfDeltaP) {
  // The name that users' model files hold.
  EXPECT_EQ(location_named("static"), EffectLocation::static_defect);
  EXPECT_EQ(info_of(EffectLocation::static_defect).unit, "hPa");
}

TEST(EffectLocation, UnitsEqualThoseOfTheCorrectedQuantity) {
  for (const EffectLocation location :
       {EffectLocation::static_transducer, EffectLocation::dynamic_transducer, EffectLocation::static_line,
        EffectLocation::total_line, EffectLocation::static_defect, EffectLocation::pitot,
        EffectLocation::humidity, EffectLocation::radome})
    EXPECT_EQ(info_of(location).unit, "hPa");
  for (const EffectLocation location : {EffectLocation::attack, EffectLocation::sideslip,
                                        EffectLocation::beam_elevation, EffectLocation::beam_azimuth})
    EXPECT_EQ(info_of(location).unit, "deg");
  EXPECT_EQ(info_of(EffectLocation::temperature).unit, info_of(Quantity::recovery_temperature).unit);
  EXPECT_EQ(info_of(EffectLocation::ambient_temperature).unit, info_of(Quantity::ambient_temperature).unit);
  EXPECT_EQ(info_of(EffectLocation::beam_speed).unit, info_of(Quantity::lams_airspeed).unit);
  EXPECT_EQ(info_of(EffectLocation::recovery).unit, "1");
  EXPECT_EQ(info_of(EffectLocation::attack_ratio).unit, info_of(Quantity::attack_ratio).unit);
}

TEST(EffectInfo, ClockIsASeparatePlace) {
  EffectInfo info;
  info.family = "lag";
  info.location = EffectLocation::beam_speed;
  EXPECT_EQ(component_of(info), "laser");
  info.family = "clock";
  EXPECT_EQ(component_of(info), "clock");
}

TEST(EffectInfo, CountsNamedParametersAndInputs) {
  EffectInfo info;
  EXPECT_EQ(info.parameter_count(), 0U);
  EXPECT_EQ(info.need_count(), 0U);
  info.parameters[0].name = "a";
  info.parameters[1].name = "b";
  info.needs[0] = Quantity::attack;
  EXPECT_EQ(info.parameter_count(), 2U);
  EXPECT_EQ(info.need_count(), 1U);
  info.parameters[2].name = "c";
  for (Quantity& need : info.needs) need = Quantity::mach;
  EXPECT_EQ(info.parameter_count(), pcor::parameter_capacity);
  EXPECT_EQ(info.need_count(), pcor::need_capacity);
}
