// Manoeuvres made from flights, against laws of nature, against what their names promise, and against the
// aircraft that flew the flights.
#include "diagnose/manoeuvres.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <pcor/physics/air_data.hpp>
#include <pcor/physics/humidity.hpp>
#include <pcor/physics/recovery_factor.hpp>
#include <pcor/simulate/simulate.hpp>
#include "simulate/aircraft.hpp"
#include "support/made_samples.hpp"
#include "support/short_flight.hpp"

using namespace pcor::internal;

namespace {

using pcor::FlightSamples;
using pcor::Quantity;
using pcor::internal::Manoeuvre;
using Series = std::vector<double>;

constexpr double pi = 3.14159265358979323846;
constexpr double gravity = 9.80665;        // m/s2
constexpr double gas_constant = 287.0649;  // of dry air, J/(kg K)
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

// A made-up aircraft in a made-up atmosphere.

double temperature_at(double height) { return 290.0 - 0.0065 * height; }
double pressure_at(double height) {
  return 1000.0 * std::pow(temperature_at(height) / 290.0, gravity / (0.0065 * gas_constant));
}
double attack_of(double load, double mach, double q) {
  return -2.0 + 300.0 * load * std::sqrt(1.0 - mach * mach) / q;
}
double attack_ratio_of(double attack) { return -0.3 + 0.05 * attack; }
double sideslip_ratio_of(double sideslip) { return 0.01 + 0.08 * sideslip; }
double thermometer_of(double temperature, double mach) {
  return temperature * (1.0 + 0.95 * 0.2 * mach * mach);
}

struct Made {
  std::vector<double> heights{800.0, 2500.0, 5000.0};  // of the levels, m
  double disturbed = 0.0;                              // share of the samples with an outlier or a gap
};

/// Quarters of an hour at some heights with speeds from 90 to 140 m/s, and climbs between.
FlightSamples flight(const Made& made = {}) {
  FlightSamples samples;
  samples.name = "made";
  samples.aircraft = "N130AR";
  Series height(900, made.heights.front());
  for (std::size_t i = 1; i < made.heights.size(); ++i) {
    while (height.back() < made.heights[i]) height.push_back(height.back() + 5.0);
    height.insert(height.end(), 900, made.heights[i]);
  }
  Series p, q, recovery, dew, laser, qcr, adifr, bdifr, attack, sideslip, cabin, bay, zero, other;
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> uniform;
  for (std::size_t i = 0; i < height.size(); ++i) {
    const auto t = static_cast<double>(i);
    const double z = height[i];
    const double v = 115.0 + 25.0 * std::sin(2.0 * pi * t / 500.0);
    const double roll = 20.0 * std::max(0.0, std::sin(2.0 * pi * t / 700.0));
    const double mach = pcor::mach_number(
        1.0, pcor::dynamic_pressure_from_airspeed(1.0, v, temperature_at(z), pcor::dry_air<double>()),
        pcor::dry_air<double>());
    const double beta = 1.5 * std::sin(t / 3.0);
    p.push_back(pressure_at(z));
    q.push_back(pcor::dynamic_pressure_from_mach(p.back(), mach, pcor::dry_air<double>()));
    recovery.push_back(thermometer_of(temperature_at(z), mach));
    dew.push_back(temperature_at(z) - 10.0);
    laser.push_back(v);
    attack.push_back(attack_of(1.0 / std::cos(roll * pi / 180.0), mach, q.back()));
    sideslip.push_back(beta);
    qcr.push_back(1.03 * q.back());
    adifr.push_back(attack_ratio_of(attack.back()) * qcr.back());
    bdifr.push_back(sideslip_ratio_of(beta) * qcr.back());
    cabin.push_back(std::max(p.back(), 900.0 - 0.02 * z));
    bay.push_back(290.0 - 0.002 * z);
    zero.push_back(0.0);
    other.push_back(0.01 * z);
    for (Series* series : {&attack, &adifr, &qcr, &recovery}) {
      const double fate = uniform(engine);
      if (fate < made.disturbed) series->back() *= 3.0;
      if (fate < 0.5 * made.disturbed) series->back() = missing;
    }
    samples.time.push_back(1321560000.0 + t);
    samples.motion.roll.push_back(roll);
    samples.motion.airspeed.push_back(v);
  }
  samples.motion.time = samples.time;
  samples.motion.altitude = height;
  samples.motion.vertical_speed = Series(height.size(), 0.0);
  samples.flaps = zero;
  samples.model.columns = {{Quantity::static_pressure, p},
                           {Quantity::dynamic_pressure, q},
                           {Quantity::recovery_temperature, recovery},
                           {Quantity::dew_point, dew},
                           {Quantity::lams_airspeed, laser},
                           {Quantity::radome_dynamic_pressure, qcr},
                           {Quantity::attack_differential_pressure, adifr},
                           {Quantity::sideslip_differential_pressure, bdifr},
                           {Quantity::attack, attack},
                           {Quantity::sideslip, sideslip},
                           {Quantity::cabin_pressure, cabin},
                           {Quantity::transducer_temperature, bay},
                           {Quantity::liquid_water, zero},
                           {Quantity::flaps, zero},
                           {Quantity::time, zero},
                           {Quantity::static_pressure_rate, zero},
                           {Quantity::dynamic_pressure_rate, zero},
                           {pcor::extra_quantity(0), other}};
  for (const auto& [quantity, values] : samples.model.columns) {
    if (pcor::index(quantity) < pcor::quantity_count) samples.model.roles.push_back(quantity);
  }
  samples.reference.roles = {Quantity::static_pressure, Quantity::dynamic_pressure};
  samples.reference.columns = {{Quantity::static_pressure, p},
                               {Quantity::dynamic_pressure, q},
                               {Quantity::corrected_static_pressure, p}};
  return samples;
}

std::vector<Manoeuvre> manoeuvres_of(FlightSamples samples) {
  return pcor::internal::standard_manoeuvres({std::make_shared<const FlightSamples>(std::move(samples))});
}

/// Those of the flight that has everything.
const std::vector<Manoeuvre>& manoeuvres() {
  static const std::vector<Manoeuvre> all = manoeuvres_of(flight());
  return all;
}

void erase(FlightSamples& samples, Quantity quantity) {
  auto& columns = samples.model.columns;
  columns.erase(std::remove_if(columns.begin(), columns.end(),
                               [quantity](const auto& column) { return column.first == quantity; }),
                columns.end());
  auto& roles = samples.model.roles;
  roles.erase(std::remove(roles.begin(), roles.end(), quantity), roles.end());
}

std::vector<const Manoeuvre*> named(const std::vector<Manoeuvre>& all, const std::string& begin) {
  std::vector<const Manoeuvre*> found;
  for (const Manoeuvre& each : all) {
    if (each.name.rfind(begin, 0) == 0) found.push_back(&each);
  }
  return found;
}

const Manoeuvre& first_named(const std::string& begin) { return *named(manoeuvres(), begin).at(0); }

const Series& column(const Manoeuvre& manoeuvre, Quantity quantity) {
  return *manoeuvre.samples->model.find(quantity);
}

double greatest(const Series& values) { return *std::max_element(values.begin(), values.end()); }
double least(const Series& values) { return *std::min_element(values.begin(), values.end()); }

/// How often the values go from below to above their middle.
int upward_crossings(const Series& values, double middle) {
  int count = 0;
  for (std::size_t i = 1; i < values.size(); ++i) count += values[i - 1] <= middle && values[i] > middle;
  return count;
}

Series differences(const Series& values) {
  Series result;
  for (std::size_t i = 1; i < values.size(); ++i) result.push_back(values[i] - values[i - 1]);
  return result;
}

void expect_complete(const std::vector<Manoeuvre>& all, const FlightSamples& flown) {
  for (const Manoeuvre& each : all) {
    const FlightSamples& samples = *each.samples;
    const std::size_t count = samples.time.size();
    const auto expect_finite = [&](const Series& values, const std::string& what) {
      EXPECT_EQ(values.size(), count) << each.name << ": " << what;
      EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); }))
          << each.name << ": " << what;
    };
    const std::array<std::pair<const pcor::ModelSamples*, const pcor::ModelSamples*>, 2> pairs{
        {{&samples.model, &flown.model}, {&samples.reference, &flown.reference}}};
    for (const auto& [made, recorded] : pairs) {
      EXPECT_EQ(made->roles, recorded->roles) << each.name;
      ASSERT_EQ(made->columns.size(), recorded->columns.size()) << each.name;
      for (std::size_t i = 0; i < made->columns.size(); ++i) {
        EXPECT_EQ(made->columns[i].first, recorded->columns[i].first) << each.name;
        expect_finite(made->columns[i].second, "column " + std::to_string(i));
      }
    }
    for (const auto series :
         {&pcor::FlightMotion::time, &pcor::FlightMotion::airspeed, &pcor::FlightMotion::altitude,
          &pcor::FlightMotion::vertical_speed, &pcor::FlightMotion::roll, &pcor::FlightMotion::pitch,
          &pcor::FlightMotion::heading, &pcor::FlightMotion::attack, &pcor::FlightMotion::sideslip})
      expect_finite(samples.motion.*series, "motion");
    EXPECT_GT(least(samples.motion.airspeed), 60.0) << each.name;
    EXPECT_EQ(samples.flaps, Series(flown.flaps.empty() ? 0 : count, 0.0)) << each.name;
    EXPECT_GT(each.duration, 0.0) << each.name;
    EXPECT_FALSE(each.how.empty()) << each.name;
    EXPECT_FALSE(samples.intervals.empty()) << each.name;
    EXPECT_GT(samples.intervals.back().end, samples.intervals.back().begin) << each.name;
  }
}

}  // namespace

TEST(Manoeuvres, AreAboutFifteenWithNamesOfTheirOwn) {
  std::vector<std::string> names;
  for (const Manoeuvre& each : manoeuvres()) names.push_back(each.name);
  EXPECT_GE(names.size(), 15U);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
  for (const char* name :
       {"level leg at 800 m", "level leg at 5000 m", "pitch manoeuvre", "yaw manoeuvre at 800 m",
        "yaw manoeuvre at 5000 m", "speed run at 800 m", "speed run at 5000 m", "fast level leg",
        "climb and descent", "circles", "steady sideslips", "level leg repeated", "level legs with flaps",
        "cloud passes", "cabin pressure change"})
    EXPECT_FALSE(named(manoeuvres(), name).empty()) << name;
}

TEST(Manoeuvres, FillEveryColumnThatTheFlightsHave) { expect_complete(manoeuvres(), flight()); }

TEST(Manoeuvres, KeepTheAirInHydrostaticBalance) {
  for (const Manoeuvre& each : manoeuvres()) {
    const Series& p = column(each, Quantity::static_pressure);
    const Series& z = each.samples->motion.altitude;
    for (std::size_t i = 1; i < p.size(); ++i) {
      // Vapour, at ten degrees below the temperature, makes the air lighter by 0.4 % at most.
      const double middle = 0.5 * (z[i] + z[i - 1]);
      const double fall = gravity * (z[i] - z[i - 1]) / (gas_constant * temperature_at(middle));
      EXPECT_NEAR(std::log(p[i - 1] / p[i]), fall, 0.01 * std::abs(fall) + 1e-12) << each.name << " " << i;
    }
    // And the heights are those of the flights.
    EXPECT_NEAR(p.front() / pressure_at(z.front()), 1.0, 0.002) << each.name;
  }
}

TEST(Manoeuvres, HaveTheAirspeedOfTheirPressuresAndTemperature) {
  for (const Manoeuvre& each : manoeuvres()) {
    const Series& p = column(each, Quantity::static_pressure);
    const Series& q = column(each, Quantity::dynamic_pressure);
    const Series& recovery = column(each, Quantity::recovery_temperature);
    const Series& dew = column(each, Quantity::dew_point);
    for (std::size_t i = 0; i < p.size(); ++i) {
      const double vapor = pcor::vapor_pressure_from_dew_point(dew[i], p[i]);
      const auto air = pcor::moist_air(vapor / p[i]);
      const double mach = pcor::mach_number(p[i], q[i], air);
      const double temperature = pcor::ambient_temperature(recovery[i], mach, 1.0, air);
      const double v = each.samples->motion.airspeed[i];
      EXPECT_NEAR(pcor::true_airspeed(mach, temperature, air) / v, 1.0, 2e-5) << each.name << " " << i;
    }
  }
}

TEST(Manoeuvres, HaveTheAirspeedOfTheirPressuresExactlyInDryAir) {
  FlightSamples dry = flight();
  erase(dry, Quantity::dew_point);
  for (const Manoeuvre& each : manoeuvres_of(dry)) {
    const Series& p = column(each, Quantity::static_pressure);
    const Series& recovery = column(each, Quantity::recovery_temperature);
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto air = pcor::dry_air<double>();
      const double mach = pcor::mach_number(p[i], column(each, Quantity::dynamic_pressure)[i], air);
      const double temperature = pcor::ambient_temperature(recovery[i], mach, 1.0, air);
      const double v = each.samples->motion.airspeed[i];
      EXPECT_NEAR(pcor::true_airspeed(mach, temperature, air) / v, 1.0, 1e-9) << each.name << " " << i;
      const double z = each.samples->motion.altitude[i];
      const double heating = 0.5 * v * v / (3.5 * gas_constant);
      EXPECT_NEAR(recovery[i], temperature_at(z) + 0.95 * heating, 0.5) << each.name << " " << i;
    }
  }
}

TEST(Manoeuvres, HaveRatesThatAreDifferencesOfTheirColumns) {
  for (const Manoeuvre& each : manoeuvres()) {
    const Series& time = each.samples->time;
    for (const auto& [quantity, rate] :
         {std::pair{Quantity::static_pressure, Quantity::static_pressure_rate},
          std::pair{Quantity::dynamic_pressure, Quantity::dynamic_pressure_rate}}) {
      const Series& values = column(each, quantity);
      for (std::size_t i = 1; i + 1 < time.size(); ++i) {
        if (time[i + 1] - time[i - 1] > 2.5) continue;
        EXPECT_NEAR(column(each, rate)[i], 0.5 * (values[i + 1] - values[i - 1]), 1e-12) << each.name;
      }
    }
    EXPECT_LT(greatest(column(each, Quantity::static_pressure_rate)), 2.0) << each.name;
  }
}

TEST(Manoeuvres, HaveRatesOfTemperatureAndAirspeedAndTheAxialAcceleration) {
  FlightSamples samples = flight();
  for (const Quantity quantity :
       {Quantity::recovery_temperature_rate, Quantity::airspeed_rate, Quantity::longitudinal_acceleration}) {
    samples.model.roles.push_back(quantity);
    samples.model.columns.emplace_back(quantity, Series(samples.time.size(), 0.0));
  }
  const std::vector<Manoeuvre> all = manoeuvres_of(samples);
  expect_complete(all, samples);
  for (const Manoeuvre& each : all) {
    const FlightSamples& made = *each.samples;
    const Series& recovery = column(each, Quantity::recovery_temperature);
    const Series& v = made.motion.airspeed;
    for (std::size_t i = 1; i + 1 < v.size(); ++i) {
      if (made.time[i + 1] - made.time[i - 1] > 2.5 || made.motion.roll[i] != 0.0) continue;
      const double rate = 0.5 * (v[i + 1] - v[i - 1]);
      EXPECT_NEAR(column(each, Quantity::recovery_temperature_rate)[i],
                  0.5 * (recovery[i + 1] - recovery[i - 1]), 1e-12)
          << each.name;
      EXPECT_NEAR(column(each, Quantity::airspeed_rate)[i], rate, 1e-12) << each.name;
      // Gravity, and the acceleration of the path, along an axis that is pitched up.
      const auto forward = [&](std::size_t k) {
        return std::sqrt(v[k] * v[k] - made.motion.vertical_speed[k] * made.motion.vertical_speed[k]);
      };
      const double ahead = 0.5 * (forward(i + 1) - forward(i - 1));
      const double pitch = made.motion.pitch[i] * pi / 180.0;
      const double up =
          made.motion.altitude[i + 1] - 2.0 * made.motion.altitude[i] + made.motion.altitude[i - 1];
      EXPECT_NEAR(column(each, Quantity::longitudinal_acceleration)[i],
                  ahead * std::cos(pitch) + (gravity + up) * std::sin(pitch), 0.15)
          << each.name;
    }
  }
}

TEST(Manoeuvres, PitchAsNamedAndComeBackToWhereTheyBegan) {
  const std::vector<const Manoeuvre*> all = named(manoeuvres(), "pitch manoeuvre");
  ASSERT_EQ(all.size(), 2U);
  for (const Manoeuvre* each : all) {
    const FlightSamples& samples = *each->samples;
    const Series& z = samples.motion.altitude;
    const Series& v = samples.motion.airspeed;
    EXPECT_EQ(each->duration, 160.0);
    EXPECT_NEAR(z.back(), z.front(), 1e-9);
    EXPECT_NEAR(v.back(), v.front(), 1e-9);
    EXPECT_EQ(upward_crossings(samples.motion.vertical_speed, 0.0), 8);
    const double energy = gravity * z.front() + 0.5 * v.front() * v.front();
    for (std::size_t i = 0; i < z.size(); ++i)
      EXPECT_NEAR(gravity * z[i] + 0.5 * v[i] * v[i], energy, 1e-6) << "nobody touched the power";
    // The attack follows the load: from the law of the made aircraft, 300 n/q deg.
    const Series& attack = column(*each, Quantity::attack);
    const Series acceleration = differences(differences(z));
    for (std::size_t i = 1; i + 1 < z.size(); ++i) {
      const double q = column(*each, Quantity::dynamic_pressure)[i];
      const double mach = v[i] / std::sqrt(1.4 * gas_constant * temperature_at(z[i]));
      EXPECT_NEAR(attack[i], attack_of(1.0 + acceleration[i - 1] / gravity, mach, q), 0.1);
    }
    EXPECT_LE(greatest(acceleration), 4.2);
    EXPECT_NE(each->how.find("m/s2"), std::string::npos);
  }
  const Series acceleration = differences(differences(all[1]->samples->motion.altitude));
  EXPECT_NEAR(greatest(acceleration), 4.0, 0.2);
  EXPECT_NEAR(least(acceleration), -4.0, 0.2);
}

TEST(Manoeuvres, YawAsNamed) {
  for (const Manoeuvre* each : named(manoeuvres(), "yaw manoeuvre")) {
    const Series& sideslip = column(*each, Quantity::sideslip);
    EXPECT_EQ(each->duration, 144.0);
    EXPECT_NEAR(greatest(sideslip), 4.0, 0.02);
    EXPECT_NEAR(least(sideslip), -4.0, 0.02);
    EXPECT_EQ(upward_crossings(sideslip, 0.0), 12);
    const Series& bdifr = column(*each, Quantity::sideslip_differential_pressure);
    const Series& qcr = column(*each, Quantity::radome_dynamic_pressure);
    for (std::size_t i = 0; i < qcr.size(); ++i)
      EXPECT_NEAR(bdifr[i] / qcr[i], sideslip_ratio_of(sideslip[i]), 1e-6);
  }
}

TEST(Manoeuvres, ChangeSpeedAtTheNamedRateAndReturn) {
  for (const Manoeuvre* each : named(manoeuvres(), "speed run")) {
    const Series& v = each->samples->motion.airspeed;
    EXPECT_EQ(v.front(), v.back());
    EXPECT_GT(greatest(v) - least(v), 40.0);
    for (const double step : differences(v)) EXPECT_LE(std::abs(step), 0.25 + 1e-9);
    EXPECT_EQ(greatest(each->samples->motion.altitude), least(each->samples->motion.altitude));
  }
}

TEST(Manoeuvres, TurnFullCirclesToBothSides) {
  const Manoeuvre& circles = first_named("circles");
  const Series& roll = circles.samples->motion.roll;
  EXPECT_NEAR(greatest(roll), 26.7, 1e-9);
  EXPECT_NEAR(least(roll), -26.7, 1e-9);
  double left = 0.0;
  double right = 0.0;
  for (const double turn : differences(circles.samples->motion.heading)) {
    const double short_way = std::remainder(turn, 360.0);
    (short_way < 0.0 ? left : right) += short_way;
  }
  EXPECT_NEAR(left, -360.0, 5.0);
  EXPECT_NEAR(right, 360.0, 5.0);
}

TEST(Manoeuvres, StayWithinTheSpeedsThatWereFlown) {
  const Series flown = flight().motion.airspeed;
  for (const Manoeuvre& each : manoeuvres()) {
    EXPECT_GE(least(each.samples->motion.airspeed), 1.099 * least(flown)) << each.name;
    EXPECT_LE(greatest(each.samples->motion.airspeed), 1.1 * greatest(flown)) << each.name;
  }
}

TEST(Manoeuvres, AreFoundByTheSearchForRegimes) {
  const std::vector<std::pair<const char*, pcor::Regime>> expected = {
      {"pitch manoeuvre", pcor::Regime::pitch_manoeuvre},
      {"yaw manoeuvre", pcor::Regime::yaw_manoeuvre},
      {"speed run", pcor::Regime::speed_run},
      {"circles", pcor::Regime::circle},
      {"climb and descent", pcor::Regime::descent},
      {"cloud passes", pcor::Regime::cloud}};
  for (const auto& [name, regime] : expected) {
    for (const Manoeuvre* each : named(manoeuvres(), name)) {
      // The search takes the first minute in the air for the take-off.
      pcor::FlightMotion motion = each->samples->motion;
      for (Series pcor::FlightMotion::*series :
           {&pcor::FlightMotion::airspeed, &pcor::FlightMotion::altitude, &pcor::FlightMotion::vertical_speed,
            &pcor::FlightMotion::roll, &pcor::FlightMotion::pitch, &pcor::FlightMotion::heading,
            &pcor::FlightMotion::attack, &pcor::FlightMotion::sideslip, &pcor::FlightMotion::ground_speed,
            &pcor::FlightMotion::ground_track, &pcor::FlightMotion::liquid_water})
        (motion.*series).insert((motion.*series).begin(), 120, (motion.*series).front());
      const double begin = motion.time.front();
      for (int i = 1; i <= 120; ++i) motion.time.insert(motion.time.begin(), begin - i);
      const std::vector<pcor::Interval> found = pcor::find_regimes(motion);
      const auto is = [wanted = regime](const pcor::Interval& interval) { return interval.regime == wanted; };
      EXPECT_TRUE(std::any_of(found.begin(), found.end(), is)) << each->name;
      const std::vector<pcor::Interval>& stated = each->samples->intervals;
      EXPECT_TRUE(std::any_of(stated.begin(), stated.end(), is)) << each->name;
    }
  }
}

TEST(Manoeuvres, LearnTheAircraftInSpiteOfOutliersAndGaps) {
  Made made;
  made.disturbed = 0.1;
  const FlightSamples disturbed = flight(made);
  const std::vector<Manoeuvre> all = manoeuvres_of(disturbed);
  expect_complete(all, disturbed);
  for (const Manoeuvre& each : all) {
    if (each.name == "level legs with flaps") continue;
    const Series& attack = column(each, Quantity::attack);
    const Series& adifr = column(each, Quantity::attack_differential_pressure);
    const Series& qcr = column(each, Quantity::radome_dynamic_pressure);
    for (std::size_t i = 0; i < attack.size(); ++i) {
      const double z = each.samples->motion.altitude[i];
      const double mach =
          each.samples->motion.airspeed[i] / std::sqrt(1.4 * gas_constant * temperature_at(z));
      const double q = column(each, Quantity::dynamic_pressure)[i];
      EXPECT_NEAR(qcr[i] / q, 1.03, 0.001) << each.name;
      EXPECT_NEAR(adifr[i] / qcr[i], attack_ratio_of(attack[i]), 0.005) << each.name;
      const Series& climb = each.samples->motion.vertical_speed;
      const bool pulls = i > 0 && std::abs(climb[i] - climb[i - 1]) > 1e-3;
      if (pulls || each.samples->motion.roll[i] != 0.0) continue;
      EXPECT_NEAR(attack[i], attack_of(1.0, mach, q), 0.1) << each.name;
    }
  }
}

TEST(Manoeuvres, TakeOtherQuantitiesAsUsualAtTheHeight) {
  const Manoeuvre& climb = first_named("climb and descent");
  const Series& z = climb.samples->motion.altitude;
  for (std::size_t i = 0; i < z.size(); ++i) {
    EXPECT_NEAR(column(climb, pcor::extra_quantity(0))[i], 0.01 * z[i], 1.5);
    EXPECT_NEAR(column(climb, Quantity::transducer_temperature)[i], 290.0 - 0.002 * z[i], 0.5);
    EXPECT_NEAR((*climb.samples->reference.find(Quantity::corrected_static_pressure))[i],
                column(climb, Quantity::static_pressure)[i], 1e-9);
  }
  EXPECT_GT(greatest(z) - least(z), 1000.0);
  EXPECT_NEAR(z.front(), z.back(), 1e-6);
}

TEST(Manoeuvres, ChangeFlapsCloudCabinAndTimeAsNamed) {
  EXPECT_EQ(greatest(column(first_named("level legs with flaps"), Quantity::flaps)), 50.0);
  const Series& liquid = column(first_named("cloud passes"), Quantity::liquid_water);
  EXPECT_GT(greatest(liquid), 0.1);
  EXPECT_EQ(upward_crossings(liquid, 0.1), 10);
  const Manoeuvre& cabin = first_named("cabin pressure change");
  EXPECT_GT(
      greatest(column(cabin, Quantity::cabin_pressure)) - least(column(cabin, Quantity::cabin_pressure)),
      30.0);
  EXPECT_EQ(greatest(column(cabin, Quantity::static_pressure)),
            least(column(cabin, Quantity::static_pressure)));
  const Manoeuvre& again = first_named("level leg repeated");
  EXPECT_EQ(again.duration, 600.0);
  EXPECT_EQ(again.samples->time.back() - again.samples->time.front(), 7500.0);
  EXPECT_EQ(again.samples->time.size(), 602U);
  EXPECT_EQ(column(again, Quantity::time).back(), 7500.0);
}

TEST(Manoeuvres, LeaveOutWhatTheFlightsDoNotTeach) {
  FlightSamples little = flight({{2500.0}, 0.0});
  for (const Quantity quantity :
       {Quantity::flaps, Quantity::liquid_water, Quantity::cabin_pressure, Quantity::attack,
        Quantity::sideslip, Quantity::recovery_temperature, Quantity::dew_point})
    erase(little, quantity);
  little.flaps.clear();
  little.reference.columns.pop_back();
  little.motion = {};
  little.motion.time = little.time;
  const std::vector<Manoeuvre> all = manoeuvres_of(little);
  expect_complete(all, little);
  for (const char* name : {"climb", "level legs with flaps", "cloud", "cabin"})
    EXPECT_TRUE(named(all, name).empty()) << name;
  EXPECT_EQ(named(all, "level leg at").size(), 1U);
  EXPECT_EQ(named(all, "pitch manoeuvre").size(), 2U);
  EXPECT_NE(all.front().how.find("hPa"), std::string::npos) << all.front().how;
}

TEST(Manoeuvres, OfFlightsWithoutAMotionAreComplete) {
  made::Plan plan;
  plan.defect = &made::equation_18;
  const FlightSamples recorded = made::flight(plan);
  const std::vector<Manoeuvre> all = manoeuvres_of(recorded);
  EXPECT_GE(all.size(), 10U);
  expect_complete(all, recorded);
}

TEST(Manoeuvres, AreCompleteAfterTwoMinutesWithEmptyColumns) {
  FlightSamples brief = flight();
  const auto cut = [](Series& values) { values.resize(std::min<std::size_t>(values.size(), 120)); };
  for (Series* series : {&brief.time, &brief.motion.time, &brief.motion.airspeed, &brief.motion.altitude,
                         &brief.motion.vertical_speed, &brief.motion.roll, &brief.flaps})
    cut(*series);
  for (pcor::ModelSamples* samples : {&brief.model, &brief.reference}) {
    for (auto& [quantity, values] : samples->columns) {
      cut(values);
      const bool needed = quantity == Quantity::static_pressure || quantity == Quantity::dynamic_pressure;
      if (!needed) values.assign(values.size(), missing);
    }
  }
  brief.motion.altitude.assign(120, missing);
  const std::vector<Manoeuvre> all = manoeuvres_of(brief);
  EXPECT_GE(all.size(), 5U);
  expect_complete(all, brief);
}

TEST(Manoeuvres, HaveOnlyColumnsThatAllFlightsHave) {
  FlightSamples less = flight();
  erase(less, Quantity::cabin_pressure);
  less.reference.columns.pop_back();
  less.flaps.clear();
  const std::vector<Manoeuvre> all = pcor::internal::standard_manoeuvres(
      {std::make_shared<const FlightSamples>(flight()), std::make_shared<const FlightSamples>(less)});
  expect_complete(all, less);
  for (const Manoeuvre& each : all)
    EXPECT_EQ(each.samples->reference.find(Quantity::corrected_static_pressure), nullptr);
}

TEST(Manoeuvres, AreNoneWhereNothingWasFlown) {
  EXPECT_TRUE(pcor::internal::standard_manoeuvres({}).empty());
  EXPECT_TRUE(pcor::internal::standard_manoeuvres({nullptr}).empty());
  EXPECT_TRUE(manoeuvres_of({}).empty());
  FlightSamples empty = flight();
  for (auto& [quantity, values] : empty.model.columns) values.assign(values.size(), missing);
  EXPECT_TRUE(manoeuvres_of(empty).empty());
}

// The scenario flies 95 to 135 m/s at 1500 m, with a pitch manoeuvre and the usual noise.
TEST(Manoeuvres, OfASimulatedFlightHaveTheAttackOfItsAircraft) {
  const pcor::ModelFile model = pcor::test::laser_model();
  const auto flown = std::make_shared<const FlightSamples>(
      pcor::read_samples(pcor::Flight(pcor::test::short_flight()), model, *pcor::lams_reference()));
  const std::vector<Manoeuvre> all = pcor::internal::standard_manoeuvres({flown});
  expect_complete(all, *flown);
  for (const Manoeuvre& each : all) {
    const pcor::Residuals residuals(each.samples, model, *pcor::lams_reference());
    for (const pcor::Mask mask : residuals.mask()) ASSERT_EQ(mask, pcor::Mask::none) << each.name;
  }

  const auto& aircraft = pcor::internal::simulate::facts_of(pcor::Scenario::Aircraft::c130);
  const std::vector<const Manoeuvre*> pitches = named(all, "pitch manoeuvre");
  ASSERT_FALSE(pitches.empty());
  for (const Manoeuvre* each : pitches) {
    const FlightSamples& samples = *each->samples;
    const Series& z = samples.motion.altitude;
    const Series acceleration = differences(differences(z));
    double greatest_attack = -90.0;
    double least_attack = 90.0;
    for (std::size_t i = 1; i + 1 < z.size(); ++i) {
      const double p = column(*each, Quantity::static_pressure)[i];
      const double q = column(*each, Quantity::dynamic_pressure)[i];
      const double mach = pcor::mach_number(p, q, pcor::dry_air<double>());
      const double attack = pcor::internal::simulate::lift_attack(
          aircraft, aircraft.weight, 1.0 + acceleration[i - 1] / gravity, 70.0 * p * mach * mach, mach, 0.0);
      greatest_attack = std::max(greatest_attack, attack);
      least_attack = std::min(least_attack, attack);
    }
    const Series& attack = column(*each, Quantity::attack_differential_pressure);
    const Series& qcr = column(*each, Quantity::radome_dynamic_pressure);
    Series angle;
    for (std::size_t i = 0; i < qcr.size(); ++i)
      angle.push_back(aircraft.attack.angle(attack[i] / qcr[i], 0.0));
    const double amplitude = 0.5 * (greatest(angle) - least(angle));
    const double expected = 0.5 * (greatest_attack - least_attack);
    RecordProperty(each->name, std::to_string(amplitude / expected));
    EXPECT_NEAR(amplitude / expected, 1.0, 0.3) << each->name;
    EXPECT_NEAR(0.5 * (greatest(angle) + least(angle)), 0.5 * (greatest_attack + least_attack), 0.7);
  }
}
