// The search for regimes on motions made here, of which begin and end are known, and on a real flight.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <ostream>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/regimes/regimes.hpp>

namespace pcor {

void PrintTo(const Interval& interval, std::ostream* stream) {
  *stream << info_of(interval.regime).name << " " << std::fixed << interval.begin << " to " << interval.end
          << " (" << interval.note << ")";
}

namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double pi = 3.14159265358979323846;
constexpr double degrees = 180.0 / pi;
constexpr double gravity = 9.80665;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

double wrapped(double heading) { return heading - 360.0 * std::floor(heading / 360.0); }

// Noise with a correlation time of `memory` seconds.
class Gusts {
 public:
  Gusts(double deviation, double memory, double step, unsigned seed)
      : keep_(std::exp(-step / memory)), kick_(deviation * std::sqrt(1.0 - keep_ * keep_)), random_(seed) {}

  double next() { return value_ = keep_ * value_ + kick_ * normal_(random_); }

 private:
  double keep_, kick_, value_ = 0.0;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

struct Weather {
  double turbulence = 0.3;  // m/s rms of each component of the wind
  unsigned seed = 1;
};

struct Start {
  double time = 1321560000.0;  // 2011-11-17 20:00:00 UTC
  double heading = 355.0;
  double airspeed = 125.0;
  double altitude = 4000.0;
};

// Time range of a part of the flight, s.
struct Flown {
  double begin = 0.0, end = 0.0;
};

// Flies one manoeuvre after the other and records what the aircraft does.
class Pilot {
 public:
  explicit Pilot(double rate = 1.0, Weather weather = {}, Start start = {})
      : step_(1.0 / rate),
        start_(start),
        airspeed_(start.airspeed),
        altitude_(start.altitude),
        heading_(start.heading),
        vertical_gust_(weather.turbulence, 3.0, step_, weather.seed),
        lateral_gust_(weather.turbulence, 3.0, step_, weather.seed + 1),
        head_gust_(weather.turbulence, 3.0, step_, weather.seed + 2),
        rocking_(2.0 * weather.turbulence, 2.0, step_, weather.seed + 3) {}

  double now() const { return start_.time + static_cast<double>(motion_.time.size()) * step_; }
  const FlightMotion& motion() const { return motion_; }

  Flown level(double seconds) {
    return fly(seconds, [](double) { return Moment{}; });
  }

  Flown climb(double rate, double seconds) {
    return fly(seconds, [&](double) { return Moment{0, rate}; });
  }

  Flown turn(double change, double roll) {
    const double rate = gravity * std::tan(roll / degrees) / airspeed_ * degrees;
    return fly(std::abs(change / rate), [&](double) {
      return Moment{0, 0, std::copysign(roll, change), std::copysign(rate, change)};
    });
  }

  Flown pitch_manoeuvre(int cycles, double period, double height) {
    return fly(cycles * period, [&](double t) {
      return Moment{0, height * 2.0 * pi / period * std::sin(2.0 * pi * t / period)};
    });
  }

  Flown yaw_manoeuvre(int cycles, double period, double amplitude) {
    return fly(cycles * period, [&](double t) {
      Moment moment;
      moment.yaw = amplitude * std::sin(2.0 * pi * t / period);
      return moment;
    });
  }

  Flown accelerate(double to, double rate) {
    const double sign = to > airspeed_ ? 1.0 : -1.0;
    return fly(std::abs(to - airspeed_) / rate, [&](double) { return Moment{sign * rate}; });
  }

  void stand(double seconds) {
    airspeed_ = 0.0;
    level(seconds);
  }

  Flown cloud(double seconds) {
    water_ = 0.3;
    const Flown flown = level(seconds);
    water_ = 0.0;
    return flown;
  }

 private:
  struct Moment {
    double acceleration = 0, vertical_speed = 0, roll = 0, heading_rate = 0, yaw = 0;
  };

  template <class Motion>
  Flown fly(double seconds, Motion motion) {
    const double begin = now();
    const auto samples = static_cast<int>(std::lround(seconds / step_));
    for (int i = 0; i < samples; ++i) {
      const Moment moment = motion((i + 0.5) * step_);
      airspeed_ += moment.acceleration * step_;
      altitude_ += moment.vertical_speed * step_;
      heading_ += moment.heading_rate * step_;
      record(moment);
    }
    return {begin, now()};
  }

  void record(const Moment& moment) {
    const bool flying = airspeed_ > 50.0;
    const double up = flying ? vertical_gust_.next() : 0.0, side = flying ? lateral_gust_.next() : 0.0;
    const double ahead = flying ? head_gust_.next() : 0.0, rocking = flying ? rocking_.next() : 0.0;
    const double divisor = std::max(airspeed_, 50.0);
    motion_.time.push_back(now());
    motion_.airspeed.push_back(airspeed_ + ahead);
    motion_.altitude.push_back(altitude_);
    motion_.vertical_speed.push_back(moment.vertical_speed + 0.3 * up);
    motion_.roll.push_back(moment.roll + rocking);
    motion_.pitch.push_back(2.0 + moment.vertical_speed / divisor * degrees + 0.3 * up / divisor * degrees);
    motion_.attack.push_back(2.0 + up / divisor * degrees);
    motion_.heading.push_back(wrapped(heading_ - moment.yaw + 0.2 * side / divisor * degrees));
    motion_.sideslip.push_back(moment.yaw + side / divisor * degrees);
    motion_.liquid_water.push_back(water_);
  }

  double step_;
  Start start_;
  double airspeed_, altitude_, heading_;
  double water_ = 0.0;
  Gusts vertical_gust_, lateral_gust_, head_gust_, rocking_;
  FlightMotion motion_;
};

std::vector<Interval> of(Regime regime, const std::vector<Interval>& intervals) {
  std::vector<Interval> found;
  for (const Interval& interval : intervals) {
    if (interval.regime == regime) found.push_back(interval);
  }
  return found;
}

std::vector<Interval> manoeuvres(const std::vector<Interval>& intervals) {
  std::vector<Interval> found;
  for (const Interval& interval : intervals) {
    if (is_manoeuvre(interval.regime)) found.push_back(interval);
  }
  return found;
}

void expect_one(Regime regime, const std::vector<Interval>& intervals, Flown flown, double tolerance) {
  const std::vector<Interval> found = of(regime, intervals);
  ASSERT_THAT(found, SizeIs(1)) << info_of(regime).name;
  EXPECT_NEAR(found[0].begin, flown.begin, tolerance) << info_of(regime).name << ": " << found[0].note;
  EXPECT_NEAR(found[0].end, flown.end, tolerance) << info_of(regime).name << ": " << found[0].note;
}

void expect_phases_cover(const FlightMotion& motion, const std::vector<Interval>& intervals) {
  double reached = motion.time.front();
  for (const Interval& interval : intervals) {
    if (!is_phase(interval.regime)) continue;
    EXPECT_DOUBLE_EQ(interval.begin, reached);
    EXPECT_LT(interval.begin, interval.end);
    reached = interval.end;
  }
  EXPECT_GT(reached, motion.time.back());
  EXPECT_LE(reached, motion.time.back() + 1.001);
}

// Flown regimes of one flight with several kinds of manoeuvres.
struct Story {
  FlightMotion motion;
  Flown roll, climb, pitch, yaw, run, first_leg, second_leg, circle, cloud, descent;
  double landing;
};

Story tell(double rate = 1.0, Weather weather = {}, double heading = 355.0, double shift = 0.0) {
  Pilot pilot(rate, weather, {Start().time + shift, heading, 0.0, 1500.0});
  Story story;
  pilot.stand(300);
  story.roll = pilot.accelerate(70.0, 2.0);
  pilot.climb(7.0, 30);
  pilot.accelerate(110.0, 1.0);
  story.climb = pilot.climb(7.0, 500);
  pilot.level(400);
  story.pitch = pilot.pitch_manoeuvre(6, 24.0, 40.0);
  pilot.level(300);
  story.yaw = pilot.yaw_manoeuvre(15, 10.0, 3.0);
  pilot.level(300);
  story.run = pilot.accelerate(100.0, 0.25);
  pilot.level(30);
  pilot.accelerate(150.0, 0.25);
  pilot.level(30);
  story.run.end = pilot.accelerate(110.0, 0.25).end;
  story.first_leg = pilot.level(400);
  pilot.turn(90.0, 25.0);
  pilot.turn(-270.0, 25.0);
  story.second_leg = pilot.level(240);
  pilot.turn(30.0, 20.0);
  pilot.level(200);
  story.circle = pilot.turn(360.0, 26.7);
  pilot.level(100);
  story.cloud = pilot.cloud(90);
  pilot.level(100);
  story.descent = pilot.climb(-5.0, 600);
  pilot.level(120);
  pilot.accelerate(75.0, 1.0);
  pilot.climb(-3.0, 70);
  story.landing = pilot.accelerate(60.0, 1.0).end;
  pilot.accelerate(10.0, 2.0);
  pilot.stand(200);
  story.motion = pilot.motion();
  return story;
}

void expect_told(const Story& story, const std::vector<Interval>& found) {
  expect_one(Regime::pitch_manoeuvre, found, story.pitch, 6.0);
  expect_one(Regime::yaw_manoeuvre, found, story.yaw, 8.0);
  expect_one(Regime::speed_run, found, story.run, 10.0);
  expect_one(Regime::circle, found, story.circle, 4.0);
  expect_one(Regime::cloud, found, story.cloud, 1.0);
  expect_one(Regime::take_off, found, {story.roll.begin + 7.5, story.roll.end + 42.0}, 14.0);

  const std::vector<Interval> legs = of(Regime::reverse_heading, found);
  ASSERT_THAT(legs, SizeIs(2));
  EXPECT_EQ(legs[0].pair, 1);
  EXPECT_EQ(legs[1].pair, 1);
  EXPECT_NEAR(legs[0].end, story.first_leg.end, 6.0);
  EXPECT_NEAR(legs[0].end - legs[0].begin, 300.0, 6.0);
  EXPECT_NEAR(legs[1].begin, story.second_leg.begin, 6.0);
  EXPECT_NEAR(legs[1].end, story.second_leg.end, 6.0);

  const std::vector<Interval> ground = of(Regime::ground, found);
  ASSERT_THAT(ground, SizeIs(2));
  EXPECT_NEAR(ground[0].end, story.roll.begin + 7.5, 3.0);
  EXPECT_NEAR(ground[1].begin, story.landing, 3.0);

  const std::vector<Interval> climbs = of(Regime::climb, found);
  ASSERT_THAT(climbs, SizeIs(1));
  EXPECT_NEAR(climbs[0].end, story.climb.end, 3.0);

  const std::vector<Interval> descents = of(Regime::descent, found);
  ASSERT_FALSE(descents.empty());
  EXPECT_NEAR(descents[0].begin, story.descent.begin, 3.0);
  EXPECT_NEAR(descents[0].end, story.descent.end, 3.0);

  EXPECT_THAT(of(Regime::turn, found), SizeIs(4));
  expect_phases_cover(story.motion, found);
}

// The same regimes, `shift` seconds later.
void expect_shifted(const std::vector<Interval>& found, const std::vector<Interval>& reference,
                    double shift) {
  ASSERT_EQ(found.size(), reference.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].regime, reference[i].regime);
    EXPECT_EQ(found[i].begin, reference[i].begin + shift);
    EXPECT_EQ(found[i].end, reference[i].end + shift);
  }
}

TEST(Regimes, HaveNames) {
  for (std::size_t i = 0; i < regime_count; ++i) {
    const auto regime = static_cast<Regime>(i);
    EXPECT_EQ(regime_named(info_of(regime).name), regime);
  }
  EXPECT_EQ(regime_named("loop"), Regime::count);
}

TEST(Regimes, CriteriaDependOnTheAircraftRegistration) {
  EXPECT_GT(pcor::RegimeCriteria::of("N677F")->acceleration,
            pcor::RegimeCriteria::of("N130AR")->acceleration);
  EXPECT_GT(pcor::max_flap_speed("GV N677F"), pcor::max_flap_speed("C-130 N130AR"));
  for (const char* unknown : {"", "N677", "G-LUXE", "Boeing 677"}) {
    EXPECT_FALSE(pcor::RegimeCriteria::of(unknown)) << unknown;
    EXPECT_EQ(pcor::max_flap_speed(unknown), pcor::max_flap_speed("N130AR")) << unknown;
  }
}

TEST(Regimes, CriterionTextHasTheLimits) {
  EXPECT_THAT(pcor::criterion_of(Regime::turn), HasSubstr("roll beyond 10 deg to one side for 10 s"));
  EXPECT_THAT(pcor::criterion_of(Regime::descent), HasSubstr("vertical speed below -1.5 m/s"));
  EXPECT_THAT(pcor::criterion_of(Regime::reverse_heading), HasSubstr("2 to 5 min"));
  EXPECT_THAT(pcor::criterion_of(Regime::speed_run, RegimeCriteria::gv()), HasSubstr("0.3 m/s2"));
}

// Every number of the search criteria appears in the words for some regime: another number gives other
// words.
TEST(Regimes, CriteriaTextHasAllNumbers) {
  static_assert(std::is_trivially_copyable_v<RegimeCriteria>);
  for (std::size_t number = 0; number < sizeof(RegimeCriteria) / sizeof(double); ++number) {
    RegimeCriteria criteria;
    const double other = 123.5;
    std::memcpy(reinterpret_cast<char*>(&criteria) + number * sizeof(double), &other, sizeof(double));
    bool told = false;
    for (std::size_t i = 0; i < regime_count; ++i) {
      const auto regime = static_cast<Regime>(i);
      told = told || pcor::criterion_of(regime, criteria) != pcor::criterion_of(regime);
    }
    EXPECT_TRUE(told) << "number " << number << " of the criteria";
  }
}

TEST(Regimes, AreFoundInAFlightWithAllOfThem) {
  const Story story = tell();
  expect_told(story, find_regimes(story.motion));
}

TEST(Regimes, AreFoundInTurbulence) {
  for (const unsigned seed : {1U, 20U, 300U}) {
    const Story story = tell(1.0, {1.0, seed});
    SCOPED_TRACE(seed);
    expect_told(story, find_regimes(story.motion));
  }
}

TEST(Regimes, AreFoundAtOtherRates) {
  for (const double rate : {0.5, 5.0, 25.0}) {
    SCOPED_TRACE(rate);
    const Story story = tell(rate);
    expect_told(story, find_regimes(story.motion));
  }
}

TEST(Regimes, AreIndependentOfTheHeading) {
  const std::vector<Interval> reference = find_regimes(tell().motion);
  for (const double heading : {0.0, 90.0, 177.0, 359.9}) {
    SCOPED_TRACE(heading);
    expect_shifted(find_regimes(tell(1.0, {}, heading).motion), reference, 0.0);
  }
}

TEST(Regimes, ShiftWithTheTimeAxis) {
  expect_shifted(find_regimes(tell(1.0, {}, 355.0, 4321.0).motion), find_regimes(tell().motion), 4321.0);
}

TEST(Regimes, AreFoundDespiteMissingValuesAndSamples) {
  Story story = tell();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> chance(0.0, 1.0);
  FlightMotion& all = story.motion;
  for (std::vector<double>* series : {&all.airspeed, &all.altitude, &all.vertical_speed, &all.roll,
                                      &all.pitch, &all.heading, &all.sideslip, &all.liquid_water}) {
    for (double& value : *series) {
      if (chance(random) < 0.1) value = missing;
    }
  }
  expect_told(story, find_regimes(all));
}

TEST(Regimes, PhasesCoverAFlightWithLongGaps) {
  Story story = tell();
  FlightMotion& all = story.motion;
  for (std::size_t i = 0; i < all.time.size(); ++i) {
    if (i > 1000) all.time[i] += 200.0;
    if (i > 2000) all.time[i] += 1e8;
  }
  std::fill(all.vertical_speed.begin() + 900, all.vertical_speed.begin() + 1500, missing);
  std::fill(all.pitch.begin() + 900, all.pitch.begin() + 1500, missing);
  std::fill(all.airspeed.begin() + 3000, all.airspeed.begin() + 3100, missing);
  expect_phases_cover(all, find_regimes(all));
}

TEST(Regimes, VerticalSpeedIsNotRequired) {
  Story story = tell();
  story.motion.vertical_speed.clear();
  expect_told(story, find_regimes(story.motion));
}

TEST(Regimes, RollIsNotRequired) {
  Story story = tell();
  story.motion.roll.clear();
  const std::vector<Interval> found = find_regimes(story.motion);
  expect_one(Regime::circle, found, story.circle, 5.0);
  EXPECT_THAT(of(Regime::reverse_heading, found), SizeIs(2));
}

TEST(Regimes, UndeterminedRegimesAreAbsent) {
  Story story = tell();
  FlightMotion motion = story.motion;
  motion.sideslip.clear();
  motion.liquid_water.clear();
  std::vector<Interval> found = find_regimes(motion);
  EXPECT_THAT(of(Regime::yaw_manoeuvre, found), IsEmpty());
  EXPECT_THAT(of(Regime::cloud, found), IsEmpty());
  EXPECT_THAT(of(Regime::pitch_manoeuvre, found), SizeIs(1));

  FlightMotion only_time;
  only_time.time = story.motion.time;
  EXPECT_THAT(find_regimes(only_time), IsEmpty());
  EXPECT_THAT(find_regimes({}), IsEmpty());

  motion = {};
  motion.time = {0.0};
  motion.airspeed = {120.0};
  motion.altitude = {1000.0};
  EXPECT_NO_THROW(find_regimes(motion));
}

TEST(Regimes, TurbulentLevelFlightHasNoManoeuvres) {
  for (const double turbulence : {0.1, 0.5, 1.0, 1.5}) {
    for (const unsigned seed : {11U, 12U, 13U, 14U, 15U}) {
      SCOPED_TRACE(testing::Message() << turbulence << " m/s, seed " << seed);
      Pilot pilot(1.0, {turbulence, seed});
      pilot.level(7200);
      const std::vector<Interval> found = find_regimes(pilot.motion());
      EXPECT_THAT(manoeuvres(found), IsEmpty());
      EXPECT_THAT(of(Regime::level, found), SizeIs(1));
      EXPECT_THAT(of(Regime::turn, found), IsEmpty());
    }
  }
}

TEST(Regimes, OrdinaryFlightsHaveNoManoeuvres) {
  for (unsigned seed = 0; seed < 25; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto between = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    Pilot pilot(1.0, {between(0.1, 1.5), seed});
    for (int leg = 0; leg < 20; ++leg) {
      pilot.level(between(60.0, 900.0));
      const double next = between(0.0, 3.0);
      if (next < 1.0) pilot.turn(between(-120.0, 120.0), between(15.0, 30.0));
      if (next > 2.0) pilot.climb(between(-8.0, 8.0), between(60.0, 400.0));
      if (next > 1.0 && next < 2.0) pilot.accelerate(between(110.0, 140.0), between(0.2, 0.6));
    }
    EXPECT_THAT(manoeuvres(find_regimes(pilot.motion())), IsEmpty());
  }
}

TEST(Regimes, ArbitraryDataGiveOrderedRegimes) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto between = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    FlightMotion motion;
    const double step = std::pow(10.0, between(-1.4, 1.0));
    double time = between(0.0, 2e9);
    for (int i = 0; i < 3000; ++i)
      motion.time.push_back(time += step * (between(0.0, 1.0) < 0.002 ? 500.0 : 1.0));
    for (std::vector<double>* series :
         {&motion.airspeed, &motion.altitude, &motion.vertical_speed, &motion.roll, &motion.pitch,
          &motion.heading, &motion.sideslip, &motion.liquid_water}) {
      if (between(0.0, 1.0) < 0.2) continue;
      const double size = std::pow(10.0, between(-1.0, 2.5));
      Gusts gusts(size, between(1.0, 100.0), step, seed + 100);
      const double often = between(0.0, 0.3);
      for (int i = 0; i < 3000; ++i) {
        const bool absent = between(0.0, 1.0) < often;
        series->push_back(absent ? (i % 7 == 0 ? infinity : missing) : size / 2.0 + gusts.next());
      }
    }
    const std::vector<Interval> found = find_regimes(motion);
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_LT(found[i].begin, found[i].end);
      EXPECT_GE(found[i].begin, motion.time.front());
      EXPECT_LE(found[i].end, motion.time.back() + 1.001);
      EXPECT_GE(found[i].begin, found[i - std::min<std::size_t>(i, 1)].begin);
    }
    const bool tells_phases =
        !motion.airspeed.empty() && !(motion.vertical_speed.empty() && motion.altitude.empty());
    if (tells_phases) expect_phases_cover(motion, found);
  }
}

TEST(Regimes, ClimbHasNoManoeuvres) {
  Pilot pilot;
  pilot.climb(6.0, 600);
  pilot.level(300);
  pilot.climb(-6.0, 600);
  const std::vector<Interval> found = find_regimes(pilot.motion());
  EXPECT_THAT(manoeuvres(found), IsEmpty());
  EXPECT_THAT(found, SizeIs(3));
}

TEST(Regimes, HalfTurnWithClimbIsNotReverseHeading) {
  Pilot pilot;
  pilot.level(300);
  pilot.turn(180.0, 20.0);
  pilot.climb(5.0, 60);
  pilot.level(300);
  EXPECT_THAT(of(Regime::reverse_heading, find_regimes(pilot.motion())), IsEmpty());
}

TEST(Regimes, QuarterTurnIsNotReverseHeading) {
  Pilot pilot;
  pilot.level(300);
  pilot.turn(90.0, 20.0);
  pilot.level(300);
  EXPECT_THAT(of(Regime::reverse_heading, find_regimes(pilot.motion())), IsEmpty());
}

TEST(Regimes, PitchManoeuvreReportsItsPeriod) {
  for (const double period : {20.0, 24.0, 30.0}) {
    Pilot pilot;
    pilot.level(300);
    const Flown flown = pilot.pitch_manoeuvre(7, period, 40.0);
    pilot.level(300);
    const std::vector<Interval> found = find_regimes(pilot.motion());
    expect_one(Regime::pitch_manoeuvre, found, flown, 6.0);
    EXPECT_THAT(of(Regime::pitch_manoeuvre, found)[0].note,
                HasSubstr("7 cycles of " + std::to_string(static_cast<int>(period)).substr(0, 1)));
    EXPECT_THAT(of(Regime::level, found), SizeIs(1)) << "not chopped into climbs and descents";
  }
}

TEST(Regimes, YawManoeuvreIsFoundAtItsPeriods) {
  for (const double period : {5.0, 8.0, 15.0}) {
    SCOPED_TRACE(period);
    Pilot pilot(25.0, {0.8, 5});
    pilot.level(300);
    const Flown flown = pilot.yaw_manoeuvre(static_cast<int>(150.0 / period), period, 3.0);
    pilot.level(300);
    expect_one(Regime::yaw_manoeuvre, find_regimes(pilot.motion()), flown, 8.0);
  }
}

TEST(Regimes, GvCriteriaRequireMoreAcceleration) {
  Pilot pilot(1.0, {}, {Start().time, 355.0, 200.0, 12000.0});
  pilot.level(300);
  pilot.accelerate(250.0, 0.25);
  pilot.level(300);
  EXPECT_THAT(of(Regime::speed_run, find_regimes(pilot.motion(), RegimeCriteria::c130())), SizeIs(1));
  EXPECT_THAT(of(Regime::speed_run, find_regimes(pilot.motion(), RegimeCriteria::gv())), IsEmpty());
}

TEST(Regimes, InputWithoutMotionIsRefused) {
  FlightMotion motion;
  motion.time = {1.0, 2.0, 2.0};
  EXPECT_THROW(find_regimes(motion), Error);
  motion.time = {1.0, 2.0, 3.0};
  motion.roll = {0.0, 0.0};
  EXPECT_THROW(find_regimes(motion), Error);
}

TEST(Regimes, SampleRegimesUseHalfOpenIntervals) {
  const std::vector<Interval> intervals{{Regime::level, 1.0, 3.0}, {Regime::turn, 2.0, 10.0}};
  const std::vector<RegimeSet> regimes = regimes_of_samples({0.0, 1.0, 2.0, 3.0}, intervals);
  const auto has = [&](std::size_t sample, Regime regime) {
    return regimes[sample].test(static_cast<std::size_t>(regime));
  };
  EXPECT_TRUE(regimes[0].none());
  EXPECT_TRUE(has(1, Regime::level));
  EXPECT_FALSE(has(1, Regime::turn));
  EXPECT_TRUE(has(2, Regime::level) && has(2, Regime::turn));
  EXPECT_FALSE(has(3, Regime::level));
}

TEST(Regimes, LongFlightTakesLittleTime) {
  Pilot pilot(25.0);
  pilot.level(5 * 3600);
  const auto before = std::chrono::steady_clock::now();
  find_regimes(pilot.motion());
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - before;
  RecordProperty("seconds", std::to_string(taken.count()));
  EXPECT_LT(taken.count(), 5.0) << "generous, for a busy machine and sanitizers";
}

std::vector<double> read_all(const Flight& flight, const std::string& name, const std::string& unit) {
  std::vector<double> values(flight.records());
  flight.read(name, {0, flight.records()}, flight.conversion(name, unit), values.data());
  return values;
}

TEST(Regimes, FlightOf2004HasPlausibleRegimes) {
  const char* folder = std::getenv("PCOR_FLIGHTS");
  if (folder == nullptr) GTEST_SKIP() << "PCOR_FLIGHTS does not name a folder of flights";
  const auto path = std::filesystem::path(folder) / "GOTEX-rf06-C130-2004.nc";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const Flight flight(path);
  FlightMotion motion;
  motion.time.resize(flight.records());
  flight.read_sample_times({0, flight.records()}, 1, motion.time.data());
  motion.airspeed = read_all(flight, "TASX", "m/s");
  motion.altitude = read_all(flight, "PALT", "m");
  motion.roll = read_all(flight, "ROLL", "degree");
  motion.pitch = read_all(flight, "PITCH", "degree");
  motion.heading = read_all(flight, "THDG", "degree");
  motion.sideslip = read_all(flight, "SSLIP", "degree");
  motion.liquid_water = read_all(flight, "PLWCC", "gram/m3");
  const std::vector<Interval> found = find_regimes(motion);
  expect_phases_cover(motion, found);
  EXPECT_THAT(manoeuvres(found), IsEmpty()) << "none was flown";
  EXPECT_THAT(of(Regime::cloud, found), IsEmpty()) << "PLWCC stays below 0.06 g/m3";

  // Read off the series: 15 m/s at 44 s, VSPD above 1 m/s from 90 s, PALT 300 m higher at 137 s, wheels down
  // at 2990 s.
  const double first = motion.time.front();
  expect_one(Regime::take_off, found, {first + 45.0, first + 137.0}, 10.0);
  const std::vector<Interval> ground = of(Regime::ground, found);
  ASSERT_THAT(ground, SizeIs(2));
  EXPECT_NEAR(ground[1].begin, first + 2990.0, 10.0);
  EXPECT_GE(of(Regime::climb, found).size(), 2U) << "2400 m and 2900 m";
  EXPECT_GE(of(Regime::descent, found).size(), 2U);
  EXPECT_GE(of(Regime::level, found).size(), 2U);
  EXPECT_GE(of(Regime::turn, found).size(), 3U);
}

}  // namespace
}  // namespace pcor
