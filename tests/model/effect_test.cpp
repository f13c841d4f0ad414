#include <gtest/gtest.h>
#include <pcor/model/effect.hpp>

#include <set>
#include <string>

using pcor::EffectFacts;
using pcor::Quantity;
using pcor::Where;
using pcor::where_count;
using pcor::where_facts;
using pcor::where_named;

TEST(Where, NamesResolveToTheirPlace) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < where_count; ++i) {
    EXPECT_EQ(where_named(where_facts[i].name), static_cast<Where>(i)) << where_facts[i].name;
    EXPECT_TRUE(names.emplace(where_facts[i].name).second) << where_facts[i].name;
    EXPECT_FALSE(where_facts[i].unit.empty());
    EXPECT_FALSE(where_facts[i].adds_to.empty());
    EXPECT_FALSE(where_facts[i].place.empty());
    EXPECT_EQ(&facts_of(static_cast<Where>(i)), &where_facts[i]);
  }
  EXPECT_EQ(where_named("wing"), Where::count);
}

TEST(Where, StaticIsThePlaceOfDeltaP) {
  // The name that users' model files hold.
  EXPECT_EQ(where_named("static"), Where::static_defect);
  EXPECT_EQ(facts_of(Where::static_defect).unit, "hPa");
}

TEST(Where, UnitsAreThoseOfWhatTheyAddTo) {
  for (const Where where :
       {Where::static_transducer, Where::dynamic_transducer, Where::static_line, Where::total_line,
        Where::static_defect, Where::pitot, Where::humidity, Where::radome})
    EXPECT_EQ(facts_of(where).unit, "hPa");
  for (const Where where : {Where::attack, Where::sideslip, Where::beam_elevation, Where::beam_azimuth})
    EXPECT_EQ(facts_of(where).unit, "deg");
  EXPECT_EQ(facts_of(Where::temperature).unit, facts_of(Quantity::recovery_temperature).unit);
  EXPECT_EQ(facts_of(Where::ambient_temperature).unit, facts_of(Quantity::ambient_temperature).unit);
  EXPECT_EQ(facts_of(Where::beam_speed).unit, facts_of(Quantity::lams_airspeed).unit);
  EXPECT_EQ(facts_of(Where::recovery).unit, "1");
  EXPECT_EQ(facts_of(Where::attack_ratio).unit, facts_of(Quantity::attack_ratio).unit);
}

TEST(EffectFacts, ClockIsAPlaceOfItsOwn) {
  EffectFacts facts;
  facts.family = "lag";
  facts.where = Where::beam_speed;
  EXPECT_EQ(place_of(facts), "laser");
  facts.family = "clock";
  EXPECT_EQ(place_of(facts), "clock");
}

TEST(EffectFacts, CountsWhatIsNamed) {
  EffectFacts facts;
  EXPECT_EQ(facts.parameter_count(), 0U);
  EXPECT_EQ(facts.need_count(), 0U);
  facts.parameters[0].name = "a";
  facts.parameters[1].name = "b";
  facts.needs[0] = Quantity::attack;
  EXPECT_EQ(facts.parameter_count(), 2U);
  EXPECT_EQ(facts.need_count(), 1U);
  facts.parameters[2].name = "c";
  for (Quantity& need : facts.needs) need = Quantity::mach;
  EXPECT_EQ(facts.parameter_count(), pcor::parameter_capacity);
  EXPECT_EQ(facts.need_count(), pcor::need_capacity);
}
