#include "words/toml_reader.hpp"

#include <gtest/gtest.h>

#include <string>

namespace pcor::internal {
namespace {

TEST(MomentIn, TakesADateOfTheCalendar) {
  EXPECT_EQ(moment_in<toml::date>("2012-02-29"), (toml::date{2012, 2, 29}));
  for (const char* text :
       {"2011-02-29", "2011-13-01", "2011-11-00", "2011-11-2", " 2011-11-02", "2011-11-02 ",
        "2011-11-02T20:00:00", "2011-11-02\nx = 1", "2011-11-02 # day", "2011", "-", ""}) {
    EXPECT_FALSE(moment_in<toml::date>(text)) << text;
  }
}

TEST(MomentIn, TakesATimeOfTheDay) {
  EXPECT_EQ(moment_in<toml::time>("20:10:00.5"), (toml::time{20, 10, 0, 500000000}));
  for (const char* text :
       {"24:00:00", "20:60:00", "20:10:61", "8:00:00", "20:10:00.", "2011-11-02", "20.10"}) {
    EXPECT_FALSE(moment_in<toml::time>(text)) << text;
  }
}

TEST(Seconds, GoOnFromDayToDay) {
  toml::date_time moment{toml::date{1970, 1, 1}, toml::time{0, 0, 0}};
  EXPECT_EQ(seconds_of(moment), 0.0);
  moment.date = {2000, 2, 29};
  const double leap_day = seconds_of(moment);
  moment.date = {2000, 3, 1};
  EXPECT_EQ(seconds_of(moment) - leap_day, 86400.0);
  moment.time = {1, 2, 3, 500000000};
  EXPECT_EQ(seconds_of(moment) - leap_day, 86400.0 + 3723.5);
}

}  // namespace
}  // namespace pcor::internal
