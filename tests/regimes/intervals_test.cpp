// The user's intervals: valid contents of the file, refusals, and the effect on the found regimes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/base/utc.hpp>
#include <pcor/regimes/regimes.hpp>

#include "support/error_of.hpp"
#include "support/temporary_directory.hpp"

namespace pcor {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double day = 86400.0;
constexpr double midnight = 1321488000.0;  // 2011-11-17 00:00:00 UTC
constexpr double hour = 3600.0;

const std::string format = "format = \"pcor-intervals/1\"\n";

UserIntervals parse(const std::string& text) { return read_intervals_text(format + text, "own.toml"); }

std::optional<Error> refusal_of_whole(const std::string& text) {
  return test::error_of([&] { read_intervals_text(text, "own.toml"); });
}

// Position in the file, line and column, and names.
template <class... Names>
auto IsRefusal(const std::string& position, const Names&... names) {
  return test::IsError(Error::Code::definition, "own.toml:" + position, names...);
}

std::optional<Error> refusal(const std::string& text) { return refusal_of_whole(format + text); }

TEST(UserIntervals, NamesThoseOutsideTheFlight) {
  const UserIntervals user = parse(R"([[exclude]]
begin = "20:10:00"
end = "20:11:00"
reason = "iced"
[[exclude]]
begin = "23:30:00"
end = "23:31:00"
reason = "iced"
[[veto]]
begin = "20:59:00"
end = "21:30:00"
)");
  const auto outside = intervals_outside(user, midnight + 20.0 * hour, midnight + 21.0 * hour);
  ASSERT_EQ(outside.size(), 1U);
  EXPECT_THAT(outside[0].text, testing::HasSubstr("23:30:00 to 23:31:00"));
  EXPECT_TRUE(outside[0].is_time_of_day);
  EXPECT_TRUE(intervals_outside(user, midnight + 20.0 * hour, midnight + 24.0 * hour).empty());
}

TEST(UserIntervals, EndOnAnotherDayHasItsDate) {
  const UserIntervals user = parse(R"([[veto]]
begin = 2004-02-17T10:00:00
end = 2004-02-18T09:00:00
)");
  const auto outside = intervals_outside(user, midnight, midnight + hour);
  ASSERT_EQ(outside.size(), 1U);
  EXPECT_EQ(outside[0].text, "[[veto]] 2004-02-17 10:00:00 to 2004-02-18 09:00:00");
}

// "level 1-3" and the like, in seconds.
std::vector<std::string> in_words(const std::vector<Interval>& intervals) {
  std::vector<std::string> words;
  for (const Interval& interval : intervals) {
    words.push_back(std::string(info_of(interval.regime).name) + " " +
                    std::to_string(static_cast<long>(interval.begin - midnight)) + "-" +
                    std::to_string(static_cast<long>(interval.end - midnight)));
  }
  return words;
}

// Regimes of a flight of `last` seconds after the user's changes.
std::vector<std::string> applied(const UserIntervals& user, const std::vector<Interval>& regimes,
                                 double last = 99.0) {
  return in_words(apply(user, regimes, midnight, midnight + last));
}

Interval found(Regime regime, double begin, double end, int pair = 0) {
  return {regime, midnight + begin, midnight + end, pair};
}

UserIntervals veto(std::optional<Regime> regime, double begin, double end) {
  UserIntervals user;
  user.veto.push_back({regime, midnight + begin, midnight + end});
  return user;
}

UserIntervals add(Regime regime, double begin, double end, int pair = 0) {
  UserIntervals user;
  user.add.push_back({regime, midnight + begin, midnight + end, pair});
  return user;
}

TEST(IntervalsFile, ContentsAreReadExactly) {
  const UserIntervals user = parse(R"(
flight = "DC3-TEST-rf01.nc"
[[add]]
regime = "pitch manoeuvre"
begin = 2011-11-17T20:10:00Z
end = 2011-11-17T20:13:00
note = "seen in VSPD"
[[add]]
regime = "reverse heading"
begin = "21:00:00"
end = 21:04:00
pair = 2
[[veto]]
regime = "turn"
begin = 2011-11-17T13:20:00.5-07:00
end = 2011-11-17T20:25:00Z
[[veto]]
begin = "22:00"
end = "22:01:00.25"
[[exclude]]
begin = "20:30:00"
end = "20:31:00"
reason = "PSXC iced"
)");
  EXPECT_EQ(user.flight, "DC3-TEST-rf01.nc");
  ASSERT_THAT(user.add, SizeIs(2));
  EXPECT_EQ(user.add[0].regime, Regime::pitch_manoeuvre);
  EXPECT_EQ(utc_text(user.add[0].begin), "2011-11-17 20:10:00");
  EXPECT_EQ(utc_text(user.add[0].end), "2011-11-17 20:13:00");
  EXPECT_EQ(user.add[0].note, "seen in VSPD");
  EXPECT_EQ(user.add[1].pair, 2);
  EXPECT_EQ(user.add[1].begin, 21 * hour);
  EXPECT_EQ(user.add[1].end, 21 * hour + 240);
  ASSERT_THAT(user.veto, SizeIs(2));
  EXPECT_EQ(user.veto[0].regime, Regime::turn);
  EXPECT_EQ(user.veto[0].begin, midnight + 20 * hour + 1200.5);
  EXPECT_FALSE(user.veto[1].regime.has_value());
  EXPECT_EQ(user.veto[1].end, 22 * hour + 60.25);
  ASSERT_THAT(user.exclude, SizeIs(1));
  EXPECT_EQ(user.exclude[0].reason, "PSXC iced");
}

TEST(IntervalsFile, EmptyFileIsValid) {
  const UserIntervals user = parse("");
  EXPECT_THAT(user.add, IsEmpty());
  EXPECT_THAT(user.veto, IsEmpty());
  EXPECT_THAT(user.exclude, IsEmpty());
}

TEST(IntervalsFile, LeapYearDatesAreAccepted) {
  const UserIntervals user = parse(R"(
[[veto]]
begin = 2004-02-29T23:59:59Z
end = 2004-03-01T00:00:00Z
[[veto]]
begin = 1999-12-31T23:59:59Z
end = 2000-02-29T12:00:00Z
)");
  EXPECT_EQ(utc_text(user.veto[0].begin), "2004-02-29 23:59:59");
  EXPECT_EQ(user.veto[0].end - user.veto[0].begin, 1.0);
  EXPECT_EQ(utc_text(user.veto[1].begin), "1999-12-31 23:59:59");
  EXPECT_EQ(utc_text(user.veto[1].end), "2000-02-29 12:00:00");
}

TEST(IntervalsFile, MayNameOneFlightOrNone) {
  UserIntervals user;
  EXPECT_TRUE(user.is_for("flights/rf01.nc"));
  user.flight = "rf01.nc";
  EXPECT_TRUE(user.is_for("flights/rf01.nc"));
  EXPECT_FALSE(user.is_for("flights/rf02.nc"));
}

TEST(IntervalsFile, FileIsReadFromDisk) {
  const test::TemporaryDirectory directory;
  const auto path = directory / "own.toml";
  std::ofstream(path) << format << "[[exclude]]\nbegin = \"10:00\"\nend = \"10:01\"\nreason = \"ice\"\n";
  EXPECT_THAT(read_intervals(path).exclude, SizeIs(1));
  EXPECT_THROW(read_intervals(directory / "absent.toml"), Error);
  EXPECT_THROW(read_intervals(directory.path()), Error);
}

TEST(IntervalsFile, ErrorStatesPositionAndRemedy) {
  EXPECT_THAT(refusal_of_whole("[[add]]\n"), IsRefusal("1:1", "pcor-intervals/1"));
  EXPECT_THAT(refusal_of_whole("format = \"pcor-model/1\"\n"), IsRefusal("1:10", "pcor-intervals/1"));
  EXPECT_THAT(refusal_of_whole("format = 1\n"), IsRefusal("1:10", "pcor-intervals/1"));
  EXPECT_THAT(refusal("[[add]\n"), IsRefusal("2"));
  EXPECT_THAT(refusal("[ = \"x"), IsRefusal("2"));
  EXPECT_THAT(refusal("[[veta]]\n"), IsRefusal("2:3", "veta", "veto"));
  EXPECT_THAT(refusal("add = 1\n"), IsRefusal("2:7", "[[add]]"));
  EXPECT_THAT(refusal("add = [1]\n"), IsRefusal("2:8", "[[add]]"));
  EXPECT_THAT(refusal("flight = 7\n"), IsRefusal("2:10", "flight"));
}

TEST(IntervalsFile, RefusesWrongKeysAndValues) {
  const std::string times = "begin = \"10:00\"\nend = \"10:01\"\n";
  EXPECT_THAT(refusal("[[exclude]]\nbegin = \"10:00\"\n"), IsRefusal("2", "'end'"));
  EXPECT_THAT(refusal("[[exclude]]\n" + times), IsRefusal("2", "'reason'"));
  EXPECT_THAT(refusal("[[add]]\n" + times), IsRefusal("2", "'regime'"));
  EXPECT_THAT(refusal("[[add]]\n" + times + "regime = \"pich manoeuvre\"\n"),
              IsRefusal("5:10", "pitch manoeuvre"));
  EXPECT_THAT(refusal("[[veto]]\n" + times + "resaon = \"x\"\n"), IsRefusal("5:1", "'resaon'", "[[veto]]"));
  EXPECT_THAT(refusal("[[add]]\n" + times + "regime = \"turn\"\npair = 1\n"),
              IsRefusal("6:8", "'reverse heading'"));
  EXPECT_THAT(refusal("[[add]]\n" + times + "regime = \"reverse heading\"\npair = 0\n"),
              IsRefusal("6:8", "pair"));
}

TEST(IntervalsFile, RefusesWrongTimes) {
  const auto times = [](const std::string& begin, const std::string& end) {
    return refusal("[[veto]]\nbegin = " + begin + "\nend = " + end + "\n");
  };
  EXPECT_THAT(times("2011-11-17T20:10:00Z", "2011-11-17T20:10:00Z"), IsRefusal("4:7", "'end'"));
  EXPECT_THAT(times("2011-11-17T20:10:00Z", "2011-11-17T20:09:00Z"), IsRefusal("4:7", "'end'", "'begin'"));
  EXPECT_THAT(times("\"20:10\"", "\"20:09\""), IsRefusal("4:7", "'end'", "'begin'"));
  EXPECT_THAT(times("\"20:10\"", "\"20:10\""), IsRefusal("4:7", "'end'", "'begin'"));
  EXPECT_EQ(times("\"23:50\"", "\"00:10\""), std::nullopt);
  EXPECT_EQ(times("\"2011-11-17T20:10:00Z\"", "2011-11-17T20:11:00Z"), std::nullopt);
  EXPECT_THAT(times("2011-11-17T20:10:00Z", "\"2011-11-17T21:10:00+01:00\""), IsRefusal("4:7", "'end'"));
  EXPECT_THAT(times("\"20:10\"", "2011-11-17T20:11:00Z"), IsRefusal("4:7", "'end'", "'begin'"));
  EXPECT_THAT(times("\"25:00\"", "\"20:09\""), IsRefusal("3:9"));
  EXPECT_THAT(times("\"8:00\"", "\"20:09\""), IsRefusal("3:9"));
  EXPECT_THAT(times("2011-11-17", "\"20:09\""), IsRefusal("3:9"));
  EXPECT_THAT(times("12", "\"20:09\""), IsRefusal("3:9"));
  EXPECT_THAT(times("1969-11-17T20:10:00Z", "2011-11-17T20:10:00Z"), IsRefusal("3:9", "1970"));
}

TEST(TimesOfTheDay, ArePlacedOnTheDateOfTheFlight) {
  UserIntervals user;
  user.exclude = {
      {20 * hour, 20 * hour + 60, "a"}, {23.9 * hour, 0.1 * hour, "b"}, {1 * hour, 2 * hour, "c"}};
  const UserIntervals moments = placed(user, midnight + 19 * hour, midnight + day + 3 * hour);
  EXPECT_EQ(moments.exclude[0].begin, midnight + 20 * hour);
  EXPECT_EQ(moments.exclude[0].end, midnight + 20 * hour + 60);
  EXPECT_EQ(moments.exclude[1].begin, midnight + 23.9 * hour);
  EXPECT_EQ(moments.exclude[1].end, midnight + day + 0.1 * hour);
  EXPECT_EQ(moments.exclude[2].begin, midnight + day + 1 * hour);
  EXPECT_EQ(moments.exclude[2].end, midnight + day + 2 * hour);
}

TEST(TimesOfTheDay, AreNearestIfOutsideTheFlight) {
  UserIntervals user;
  user.exclude = {{13.9 * hour, 14.1 * hour, "before"}, {19.1 * hour, 19.2 * hour, "after"}};
  const UserIntervals moments = placed(user, midnight + 14 * hour, midnight + 19 * hour);
  EXPECT_EQ(moments.exclude[0].begin, midnight + 13.9 * hour);
  EXPECT_EQ(moments.exclude[1].begin, midnight + 19.1 * hour);
}

TEST(Applied, EmptyIntervalsChangeNoRegime) {
  const std::vector<Interval> regimes{found(Regime::level, 0, 100), found(Regime::turn, 20, 30)};
  EXPECT_THAT(applied({}, regimes), ElementsAre("level 0-100", "turn 20-30"));
}

TEST(Applied, VetoRemovesOnlyTheOverlap) {
  const std::vector<Interval> regimes{found(Regime::level, 0, 100), found(Regime::turn, 20, 40)};
  EXPECT_THAT(applied(veto(Regime::turn, 30, 50), regimes), ElementsAre("level 0-100", "turn 20-30"));
  EXPECT_THAT(applied(veto(Regime::turn, 25, 35), regimes),
              ElementsAre("level 0-100", "turn 20-25", "turn 35-40"));
  EXPECT_THAT(applied(veto(std::nullopt, 10, 50), regimes), ElementsAre("level 0-10", "level 50-100"));
  EXPECT_THAT(applied(veto(Regime::turn, 40, 50), regimes), SizeIs(2));
}

TEST(Applied, VetoRemovesWholeManoeuvresAndBothLegs) {
  const std::vector<Interval> regimes{
      found(Regime::pitch_manoeuvre, 0, 100), found(Regime::reverse_heading, 200, 300, 1),
      found(Regime::reverse_heading, 400, 500, 1), found(Regime::reverse_heading, 600, 700, 2)};
  EXPECT_THAT(applied(veto(Regime::pitch_manoeuvre, 90, 110), regimes, 999), SizeIs(3));
  EXPECT_THAT(applied(veto(Regime::reverse_heading, 450, 460), regimes, 999),
              ElementsAre("pitch manoeuvre 0-100", "reverse heading 600-700"));
}

TEST(Applied, AdditionReplacesDetectedInterval) {
  const std::vector<Interval> regimes{found(Regime::level, 0, 100), found(Regime::climb, 100, 200),
                                      found(Regime::yaw_manoeuvre, 20, 40)};
  EXPECT_THAT(applied(add(Regime::yaw_manoeuvre, 10, 45), regimes, 199),
              ElementsAre("level 0-100", "yaw manoeuvre 10-45", "climb 100-200"));
  EXPECT_THAT(applied(add(Regime::descent, 90, 120), regimes, 199),
              ElementsAre("level 0-90", "yaw manoeuvre 20-40", "descent 90-120", "climb 120-200"));
}

TEST(Applied, AdditionIsLimitedToTheFlight) {
  const std::vector<Interval> regimes{found(Regime::level, 0, 100)};
  EXPECT_THAT(applied(add(Regime::climb, -50, 500), regimes), ElementsAre("climb 0-100"));
  EXPECT_THAT(applied(add(Regime::climb, 500, 600), regimes), ElementsAre("level 0-100"));
}

TEST(Applied, AddedPairsGetNewNumbers) {
  const std::vector<Interval> regimes{found(Regime::reverse_heading, 200, 300, 1),
                                      found(Regime::reverse_heading, 400, 500, 1)};
  UserIntervals user = add(Regime::reverse_heading, 600, 700, 1);
  user.add.push_back(add(Regime::reverse_heading, 800, 900, 1).add[0]);
  const std::vector<Interval> all = apply(user, regimes, midnight, midnight + 999);
  ASSERT_THAT(all, SizeIs(4));
  EXPECT_EQ(all[0].pair, 1);
  EXPECT_EQ(all[2].pair, 2);
  EXPECT_EQ(all[3].pair, 2);
}

TEST(Applied, VetoByTimeOfDayIsApplied) {
  UserIntervals user;
  user.veto.push_back({Regime::turn, 20.0, 30.0});
  const std::vector<Interval> regimes{found(Regime::turn, 0, 100)};
  EXPECT_THAT(applied(user, regimes), ElementsAre("turn 0-20", "turn 30-100"));
}

}  // namespace
}  // namespace pcor
