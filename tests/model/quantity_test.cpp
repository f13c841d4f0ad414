#include <gmock/gmock.h>
#include <pcor/model/plausible.hpp>
#include <pcor/model/quality.hpp>
#include <pcor/model/quantity.hpp>
#include <pcor/model/state.hpp>

#include <cmath>
#include <set>
#include <string>

using pcor::Quality;
using pcor::quality_info;
using pcor::QualityFlags;
using pcor::Quantity;
using pcor::quantity_count;
using pcor::quantity_info;
using pcor::quantity_named;
using testing::MatchesRegex;

TEST(Quantity, NamesResolveToTheirQuantity) {
  for (std::size_t i = 0; i < quantity_count; ++i) {
    const auto& info = quantity_info[i];
    EXPECT_EQ(quantity_named(info.name), static_cast<Quantity>(i)) << info.name;
    EXPECT_EQ(&info_of(static_cast<Quantity>(i)), &info);
    EXPECT_THAT(std::string(info.name), MatchesRegex("[a-z][a-z_]*"));
    EXPECT_FALSE(info.unit.empty()) << info.name;
    EXPECT_FALSE(info.description.empty()) << info.name;
  }
  EXPECT_EQ(quantity_named("PSFD"), Quantity::count);
  EXPECT_EQ(quantity_named(""), Quantity::count);
}

// The missing value of NCAR's files is not a value of a role.
TEST(Quantity, MissingValueOfFilesIsImplausible) {
  for (std::size_t i = 0; i < pcor::role_count; ++i) {
    const auto role = static_cast<Quantity>(i);
    EXPECT_TRUE(pcor::is_implausible(role, -32767.0)) << info_of(role).name;
  }
}

TEST(Quantity, RolesHaveTheNamesOfTheModelFile) {
  const char* roles[] = {"static_pressure",
                         "dynamic_pressure",
                         "recovery_temperature",
                         "ambient_temperature",
                         "vapor_pressure",
                         "dew_point",
                         "frost_point",
                         "radome_dynamic_pressure",
                         "attack_differential_pressure",
                         "sideslip_differential_pressure",
                         "attack",
                         "sideslip",
                         "lams_airspeed",
                         "mach",
                         "true_airspeed",
                         "altitude",
                         "vertical_speed",
                         "latitude",
                         "pitch",
                         "roll",
                         "heading",
                         "ground_speed",
                         "ground_track",
                         "normal_acceleration",
                         "longitudinal_acceleration",
                         "flaps",
                         "engine_torque",
                         "height_above_ground",
                         "liquid_water",
                         "transducer_temperature",
                         "cabin_pressure",
                         "date"};
  for (const char* role : roles) {
    ASSERT_NE(quantity_named(role), Quantity::count) << role;
    EXPECT_TRUE(is_role(quantity_named(role))) << role;
  }
  EXPECT_FALSE(is_role(Quantity::time));
  EXPECT_FALSE(is_role(Quantity::static_defect));
  EXPECT_FALSE(is_role(Quantity::dynamic_ratio));
}

TEST(Quantity, RatesHaveTheUnitOfTheirQuantityPerSecond) {
  for (const auto& each : pcor::rates) {
    EXPECT_EQ(std::string(info_of(each.rate).unit), std::string(info_of(each.quantity).unit) + "/s");
    EXPECT_EQ(std::string(info_of(each.rate).name), std::string(info_of(each.quantity).name) + "_rate");
    EXPECT_FALSE(is_role(each.rate));
  }
}

TEST(State, ValuesAreMissingInitially) {
  pcor::State<double> state;
  for (std::size_t i = 0; i < pcor::state_capacity; ++i)
    EXPECT_TRUE(std::isnan(state[static_cast<Quantity>(i)])) << i;
}

TEST(State, FurtherVariablesFollowTheQuantities) {
  pcor::State<double> state;
  for (std::size_t i = 0; i < pcor::state_capacity; ++i)
    state[static_cast<Quantity>(i)] = static_cast<double>(i);
  for (std::size_t i = 0; i < quantity_count; ++i)
    EXPECT_EQ(state[static_cast<Quantity>(i)], static_cast<double>(i));
  for (std::size_t i = 0; i < pcor::extra_capacity; ++i) {
    const Quantity extra = pcor::extra_quantity(i);
    EXPECT_EQ(state[extra], static_cast<double>(quantity_count + 1 + i));
    EXPECT_EQ(pcor::extra_number(extra), i);
    EXPECT_NE(extra, Quantity::count) << "number of quantities, not a variable";
  }
}

TEST(Quality, BitsAreDistinctAndExplained) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < quality_info.size(); ++i) {
    EXPECT_EQ(static_cast<std::uint32_t>(quality_info[i].bit), 1U << i);
    EXPECT_TRUE(names.emplace(quality_info[i].name).second) << quality_info[i].name;
    EXPECT_FALSE(quality_info[i].meaning.empty());
  }
}

TEST(QualityFlags, SetBitsRemainSet) {
  QualityFlags flags;
  EXPECT_EQ(flags.bits(), 0U);
  flags.set(Quality::tapered);
  flags.set(false, Quality::lams_missing);
  flags.set(true, Quality::after_gap);
  flags.set(false, Quality::after_gap);
  EXPECT_TRUE(flags.has(Quality::tapered));
  EXPECT_TRUE(flags.has(Quality::after_gap)) << "a later sample of a condition takes nothing back";
  EXPECT_FALSE(flags.has(Quality::lams_missing));
  EXPECT_EQ(flags.bits(), (1U << 10) | (1U << 13));
  flags.clear();
  EXPECT_EQ(flags.bits(), 0U);
}
