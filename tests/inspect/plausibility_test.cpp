#include "inspect/plausibility.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <pcor/physics/air_data.hpp>
#include <pcor/physics/constants.hpp>
#include <pcor/physics/standard_atmosphere.hpp>
#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

namespace pcor::internal {
namespace {

using testing::Contains;
using testing::DoubleNear;
using testing::Field;
using testing::IsEmpty;
using Series = std::vector<double>;

constexpr double radians = constants::radians_per_degree;
constexpr double sphere = 6371000.0;  // m

/// A flight of ten minutes through the standard atmosphere, at 140 m/s towards the north-east, that climbs
/// and turns a little. All its series agree.
struct Recording {
  std::map<std::string, Series> series{};
  std::map<std::string, std::string> units{};

  Recording() {
    constexpr std::size_t count = 600;
    constexpr double speed = 140.0;
    double north = 0.0;
    double east = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto t = static_cast<double>(i);
      const double height = 3000.0 + 2.0 * t + 5.0 * std::sin(0.05 * t);
      const double p = standard_pressure(height);
      const double temperature = standard_temperature(height);
      const double heading = 45.0 + 200.0 * std::sin(0.01 * t);
      north += speed * std::cos(heading * radians);
      east += speed * std::sin(heading * radians);
      put("PSFD", "hPa", p);
      put("QCF", "hPa", dynamic_pressure_from_airspeed(p, speed, temperature, dry_air<double>()));
      put("ATX", "degC", temperature - 273.15);
      put("GGALT", "m", height);
      put("TASX", "m/s", speed);
      put("GGSPD", "m/s", speed);
      put("THDG", "degree", heading < 0.0 ? heading + 360.0 : heading);
      put("GGLAT", "degree_N", 40.0 + north / (sphere * radians));
      put("GGLON", "degree_E", -105.0 + east / (sphere * radians * std::cos(40.0 * radians)));
    }
  }

  void put(const std::string& name, const std::string& unit, double value) {
    series[name].push_back(value);
    units[name] = unit;
  }
};

ModelDefinition model() {
  ModelDefinition model;
  model.variables = {{Quantity::static_pressure, "PSFD"},
                     {Quantity::dynamic_pressure, "QCF"},
                     {Quantity::ambient_temperature, "ATX"},
                     {Quantity::altitude, "GGALT"},
                     {Quantity::true_airspeed, "TASX"},
                     {Quantity::ground_speed, "GGSPD"},
                     {Quantity::heading, "THDG"},
                     {Quantity::latitude, "GGLAT"}};
  return model;
}

/// The problems of the flight after `change`.
std::vector<Problem> problems_after(const std::function<void(Recording&)>& change) {
  Recording recording;
  change(recording);
  const test::TemporaryDirectory folder;
  const auto path = folder / "flight.nc";
  {
    test::NetcdfMaker maker(path);
    maker.time(test::sequence(0, recording.series["PSFD"].size()));
    for (const auto& [name, values] : recording.series) maker.series(name, recording.units[name], values);
  }
  return find_problems(Flight(path), model());
}

testing::Matcher<const Problem&> problem(const std::string& variable, const std::string& unit, double number,
                                         double tolerance) {
  return testing::AllOf(Field(&Problem::variable, variable), Field(&Problem::unit, unit),
                        Field(&Problem::number, DoubleNear(number, tolerance)));
}

TEST(Plausibility, ConsistentSeriesHaveNoProblem) {
  EXPECT_THAT(problems_after([](Recording&) {}), IsEmpty());
}

TEST(Plausibility, PressureLabelledWithAnotherUnitIsRefused) {
  const std::vector<Problem> problems =
      problems_after([](Recording& recording) { recording.units["PSFD"] = "Pa"; });
  // The pressure is 0.01 of that of the height; heights are those of the standard atmosphere.
  EXPECT_THAT(problems, Contains(problem("PSFD", "1", 0.01, 1e-4)));
}

TEST(Plausibility, TemperatureInCelsiusLabelledKelvinIsFound) {
  const std::vector<Problem> problems =
      problems_after([](Recording& recording) { recording.units["ATX"] = "K"; });
  // Air never has 5 K: all values are missing, and the contradiction is the share of them.
  EXPECT_THAT(problems, Contains(problem("ATX", "%", 100.0, 0.0)));
}

TEST(Plausibility, DynamicPressureOfHalfTheAirspeedIsFound) {
  const std::vector<Problem> problems = problems_after([](Recording& recording) {
    for (double& q : recording.series["QCF"]) q *= 0.25;
  });
  // q grows with the square of the airspeed, apart from compressibility: 2 % at Mach number 0.43.
  EXPECT_THAT(problems, Contains(problem("QCF", "1", 0.5, 0.02)));
}

TEST(Plausibility, HeadingInRadiansLabelledDegreeIsFound) {
  const std::vector<Problem> problems = problems_after([](Recording& recording) {
    for (double& heading : recording.series["THDG"]) heading *= radians;
  });
  EXPECT_THAT(problems, Contains(problem("THDG", "degree", 2.0 * std::acos(-1.0), 0.1)));
}

TEST(Plausibility, GroundSpeedInKnotsLabelledMetresPerSecondIsFound) {
  constexpr double knot = 1852.0 / 3600.0;
  const std::vector<Problem> problems = problems_after([](Recording& recording) {
    for (double& speed : recording.series["GGSPD"]) speed /= knot;
  });
  // A chord over 20 s of the turns is up to 2 % shorter than the path.
  EXPECT_THAT(problems, Contains(problem("GGSPD", "1", knot, 0.02)));
}

TEST(Plausibility, JumpOfTheHeightHasItsSizeAndTime) {
  const std::vector<Problem> problems = problems_after([](Recording& recording) {
    for (std::size_t i = 300; i < 310; ++i) recording.series["GGALT"][i] += 320.0;
  });
  ASSERT_THAT(problems, Contains(problem("GGALT", "m", 320.0, 1.0)));
  EXPECT_THAT(problems, Contains(Field(&Problem::times, testing::HasSubstr("00:05:00"))));
}

TEST(Plausibility, PressureRecordedInStepsHasTheStep) {
  const std::vector<Problem> problems = problems_after([](Recording& recording) {
    for (double& p : recording.series["PSFD"]) p = 0.25 * std::round(p / 0.25);
  });
  EXPECT_THAT(problems, Contains(problem("PSFD", "hPa", 0.25, 1e-6)));
}

TEST(Plausibility, MissingSeriesAreNoProblem) {
  const std::vector<Problem> problems = problems_after([](Recording& recording) {
    for (const char* name : {"GGALT", "TASX", "GGSPD", "GGLAT", "GGLON"}) {
      for (double& value : recording.series[name]) value = -32767.0;
    }
  });
  EXPECT_THAT(problems, IsEmpty());
}

}  // namespace
}  // namespace pcor::internal
