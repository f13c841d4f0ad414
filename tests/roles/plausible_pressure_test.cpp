#include "roles/plausible_pressure.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/physics/standard_atmosphere.hpp>
#include "support/error_of.hpp"
#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

namespace pcor::internal {
namespace {

class PlausiblePressure : public testing::Test {
 protected:
  Flight flight(const char* unit, double pressure, const char* other = "", double value = 0.0) {
    const auto path = folder_.path() / "flight.nc";
    {
      test::NetcdfMaker maker(path);
      maker.time(test::sequence(0, 50));
      maker.series("PSFD", unit, std::vector<double>(50, pressure));
      if (*other != '\0') maker.series(other, *other == 'G' ? "m" : "hPa", std::vector<double>(50, value));
    }
    return Flight(path);
  }

  /// Three systems, each of a static and a dynamic pressure, at a height of 3000 m.
  Flight flight_of(const std::vector<std::array<double, 2>>& systems, double height = 3000.0) {
    const std::vector<std::array<const char*, 2>> names{{"PSFD", "QCF"}, {"PSFRD", "QCFR"}, {"PS_A", "QC_A"}};
    const auto path = folder_.path() / "flight.nc";
    {
      test::NetcdfMaker maker(path);
      maker.time(test::sequence(0, 60));
      maker.series("GGALT", "m", std::vector<double>(60, height));
      for (std::size_t i = 0; i < systems.size(); ++i) {
        for (std::size_t k = 0; k < 2; ++k)
          maker.series(names[i][k], "hPa", std::vector<double>(60, systems[i][k]));
      }
    }
    return Flight(path);
  }

  /// 1000 records without a height: `first` with one static and dynamic pressure, and the others.
  Flight flight_of_two_parts(std::size_t first, std::array<double, 2> then, std::array<double, 2> later) {
    const auto path = folder_.path() / "flight.nc";
    {
      test::NetcdfMaker maker(path);
      maker.time(test::sequence(0, 1000));
      for (std::size_t k = 0; k < 2; ++k) {
        std::vector<double> values(1000, later[k]);
        std::fill_n(values.begin(), first, then[k]);
        maker.series(k == 0 ? "PSFD" : "QCF", "hPa", values);
      }
    }
    return Flight(path);
  }

  /// A climb from 400 to 4600 m of which most is level at 3000 m, with the height multiplied by `scale`.
  Flight climb(const char* unit, double gain, double scale = 1.0, double lowest = 400.0) {
    const auto path = folder_.path() / "flight.nc";
    std::vector<double> heights(1000, 3000.0), pressures;
    for (std::size_t i = 0; i < 200; ++i) {
      heights[i] = lowest + 13.0 * static_cast<double>(i);
      heights[800 + i] = 3000.0 + 8.0 * static_cast<double>(i);
    }
    for (double& height : heights) {
      pressures.push_back(gain * standard_pressure(height));
      height *= scale;
    }
    {
      test::NetcdfMaker maker(path);
      maker.time(test::sequence(0, 1000));
      maker.series("PSFD", unit, pressures);
      maker.series("GGALT", "m", heights);
    }
    return Flight(path);
  }

  static Notes require(const Flight& flight, const ModelDefinition& model) {
    Notes notes;
    require_possible_pressure(flight, model, notes);
    return notes;
  }

  static ModelDefinition model_of_pair() {
    ModelDefinition model = PlausiblePressure::model();
    model.variables[Quantity::dynamic_pressure] = "QCF";
    return model;
  }

  static ModelDefinition model() {
    ModelDefinition model;
    model.variables[Quantity::static_pressure] = "PSFD";
    return model;
  }

  test::TemporaryDirectory folder_;
};

TEST_F(PlausiblePressure, HectopascalsLabelledPascalsAreRefused) {
  const Flight wrong = flight("Pa", 700.0, "GGALT", 3000.0);
  EXPECT_THAT(test::error_of([&] { require(wrong, model()); }),
              test::IsError(Error::Code::unit, "PSFD", "'Pa'", "GGALT", "static_pressure = \"hPa\""));
  ModelDefinition stated = model();
  stated.units[Quantity::static_pressure] = "Pa";
  EXPECT_FALSE(impossible_pressure(wrong, stated)) << "a unit stated in the model is not checked";
}

TEST_F(PlausiblePressure, WeatherIsNotAnError) {
  for (const double pressure : {660.0, 700.0, 740.0})
    EXPECT_FALSE(impossible_pressure(flight("hPa", pressure, "GGALT", 3000.0), model())) << pressure;
}

TEST_F(PlausiblePressure, SystemsDifferingByMoreThanFivePercentAreInconsistent) {
  EXPECT_TRUE(impossible_pressure(flight("hPa", 700.0, "PSFRD", 760.0), model()));
  EXPECT_FALSE(impossible_pressure(flight("hPa", 700.0, "PSFRD", 710.0), model()));
  EXPECT_FALSE(impossible_pressure(flight("hPa", 700.0), model())) << "no variable for a comparison";
}

// The height was assumed to be in feet: PSXC was 1.333 times the truth, with status 0.
TEST_F(PlausiblePressure, GainIsNotExplainedByAHeightInFeet) {
  for (const double gain : {1.2, 1.25, 1.3, 1.4, 1.45})
    EXPECT_TRUE(impossible_pressure(climb("hPa", gain), model())) << gain;
  const auto torr = impossible_pressure(climb("torr", 1.0), model());
  ASSERT_TRUE(torr);
  EXPECT_EQ(torr->unit, "hPa");
  EXPECT_NEAR(torr->ratio, 1.333, 0.001);
}

TEST_F(PlausiblePressure, HeightInFeetIsNotAnError) {
  for (const double gain : {0.96, 1.0, 1.04}) {
    EXPECT_FALSE(impossible_pressure(climb("hPa", gain, 1.0 / 0.3048), model())) << gain;
    EXPECT_FALSE(impossible_pressure(climb("hPa", gain, 1.0 / 0.3048, 2500.0), model())) << gain;
  }
  EXPECT_FALSE(impossible_pressure(flight("hPa", 700.0, "GGALT", 3000.0 / 0.3048), model()))
      << "level flight";
}

TEST_F(PlausiblePressure, UnitThatFitsIsLikelierThanFeetInLevelFlight) {
  const auto torr = impossible_pressure(flight("torr", 700.0, "GGALT", 3000.0), model());
  ASSERT_TRUE(torr);
  EXPECT_EQ(torr->unit, "hPa");
}

// The advice was the unit that the pressure has, which disables the check.
TEST_F(PlausiblePressure, AGainIsNotCorrectedByAUnit) {
  const Flight wrong = flight("hPa", 800.0, "PSFRD", 700.0);
  const auto error = test::error_of([&] { require(wrong, model()); });
  EXPECT_THAT(error, test::IsError(Error::Code::variable, "PSFD", "1.14", "calibration", "static_pressure"));
  EXPECT_THAT(error, testing::Not(test::IsError(Error::Code::variable, "[units]")));
}

TEST_F(PlausiblePressure, PartThatAnotherSystemContradictsGivesANote) {
  const auto notes_of = [&](std::size_t first, std::size_t count) {
    const auto path = folder_.path() / "flight.nc";
    {
      test::NetcdfMaker maker(path);
      maker.time(test::sequence(0, 1000));
      std::vector<double> values(1000, 700.0);
      maker.series("PSFRD", "hPa", values);
      std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(first), count, 770.0);
      maker.series("PSFD", "hPa", values);
    }
    return require(Flight(path), model());
  };
  EXPECT_TRUE(notes_of(300, 59).empty());
  const Notes notes = notes_of(300, 400);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].severity, Severity::warning);
  EXPECT_THAT(notes[0].text, testing::AllOf(testing::HasSubstr("PSFRD"), testing::HasSubstr("400 of 1000")));
}

TEST_F(PlausiblePressure, WrongOtherSystemIsNotAnError) {
  EXPECT_FALSE(impossible_pressure(flight_of({{700.0, 60.0}, {7.0, 60.0}}), model_of_pair())) << "Pa";
  EXPECT_FALSE(impossible_pressure(flight_of({{700.0, 60.0}, {910.0, 60.0}}), model_of_pair())) << "a gain";
  EXPECT_FALSE(impossible_pressure(flight_of({{700.0, 60.0}, {701.0, 60.0}}, 0.0), model_of_pair()))
      << "a height of zero";
}

TEST_F(PlausiblePressure, UnitWrongInAllSystemsIsFoundByHeight) {
  const auto kilopascals = impossible_pressure(flight_of({{70.0, 60.0}, {70.0, 60.0}}), model());
  ASSERT_TRUE(kilopascals);
  EXPECT_EQ(kilopascals->unit, "kPa");
  const auto pascals = impossible_pressure(flight_of({{70000.0, 60.0}, {70000.0, 60.0}}), model());
  ASSERT_TRUE(pascals);
  EXPECT_EQ(pascals->unit, "Pa");
}

TEST_F(PlausiblePressure, AviationUnitsAreIdentified) {
  for (const auto& [unit, hectopascals] :
       {std::pair{"mmHg", 1.333224}, {"inHg", 33.8639}, {"psi", 68.9476}}) {
    const auto wrong = impossible_pressure(flight_of({{700.0 / hectopascals, 60.0}}), model());
    ASSERT_TRUE(wrong) << unit;
    EXPECT_EQ(wrong->unit, unit);
  }
}

TEST_F(PlausiblePressure, DynamicPressureIsCheckedByTotalPressures) {
  const auto wrong = impossible_pressure(flight_of({{700.0, 45.0}, {698.0, 62.0}}), model_of_pair());
  ASSERT_TRUE(wrong);
  EXPECT_EQ(wrong->role, Quantity::dynamic_pressure);
  EXPECT_EQ(wrong->unit, "mmHg");
  EXPECT_NEAR(wrong->ratio, 0.75, 1e-9);
  EXPECT_FALSE(impossible_pressure(flight_of({{700.0, 60.0}, {695.0, 65.0}}), model_of_pair()))
      << "static errors cancel in the total pressure";
  EXPECT_FALSE(impossible_pressure(flight_of({{700.0, 60.0}, {700.0, 30.0}, {700.0, 61.0}}), model_of_pair()))
      << "two against one";
  EXPECT_FALSE(impossible_pressure(flight_of({{700.0, 60.0}, {700.0, 0.5}}), model_of_pair()))
      << "a pitot that is closed";
  ModelDefinition stated = model_of_pair();
  stated.units[Quantity::dynamic_pressure] = "hPa";
  EXPECT_FALSE(impossible_pressure(flight_of({{700.0, 45.0}, {698.0, 62.0}}), stated));
}

// PSFD and QCF exchanged gave an output without a corrected sample, and status 0.
TEST_F(PlausiblePressure, StaticPressureBelowDynamicIsRefused) {
  for (const double height : {3000.0, std::nan("")}) {
    const Flight exchanged = flight_of({{70.0, 700.0}}, height);
    const auto wrong = impossible_pressure(exchanged, model_of_pair());
    ASSERT_TRUE(wrong);
    EXPECT_TRUE(wrong->are_exchanged) << "no unit: kPa also gives a tenth of the value expected";
    EXPECT_NEAR(wrong->ratio, 0.1, 1e-9);
    EXPECT_THAT(
        test::error_of([&] { require(exchanged, model_of_pair()); }),
        test::IsError(Error::Code::variable, "PSFD", "QCF", "[variables]", "static_pressure = \"QCF\""));
  }
  const auto wrong_unit = impossible_pressure(flight_of({{7.0, 60.0}}), model_of_pair());
  ASSERT_TRUE(wrong_unit);
  EXPECT_FALSE(wrong_unit->are_exchanged) << "60 hPa is impossible at 3000 m";
  EXPECT_FALSE(impossible_pressure(flight_of({{700.0, 987.0}}), model_of_pair())) << "Mach 1.2";
  EXPECT_FALSE(impossible_pressure(flight_of({{7.0, 15.0}}, 35000.0), model_of_pair())) << "not in flight";
  EXPECT_FALSE(impossible_pressure(flight_of({{-9999.0, 60.0}}, std::nan("")), model_of_pair()))
      << "a dead sensor";
}

// The median alone decided: a good flight was refused as exchanged.
TEST_F(PlausiblePressure, SensorThatFailsInFlightIsNotExchanged) {
  const auto is_refused = [&](std::size_t first, std::array<double, 2> then, std::array<double, 2> later) {
    return impossible_pressure(flight_of_two_parts(first, then, later), model_of_pair()).has_value();
  };
  EXPECT_FALSE(is_refused(400, {700.0, 60.0}, {5.0, 60.0})) << "dead later in the flight";
  EXPECT_FALSE(is_refused(25, {1000.0, 3447.0}, {1000.0, 0.1})) << "spikes on the ground";
  EXPECT_TRUE(is_refused(20, {700.0, 60.0}, {70.0, 700.0})) << "exchanged, with some odd samples";
}

// Taxiing exceeds the 20 hPa of flight in a wrong unit.
TEST_F(PlausiblePressure, TaxiDoesNotHideAWrongUnit) {
  const Flight flight = flight_of_two_parts(300, {1000.0, 0.5}, {700.0, 60.0});
  ModelDefinition stated = model_of_pair();
  stated.units[Quantity::dynamic_pressure] = "psi";
  EXPECT_TRUE(impossible_pressure(flight, stated));
}

// The advice was to exchange the pressures, although the height confirms the static pressure.
TEST_F(PlausiblePressure, DynamicPressureInPascalsIsNamedIfTheHeightConfirmsTheStaticPressure) {
  const auto wrong = impossible_pressure(flight_of({{700.0, 6000.0}}), model_of_pair());
  ASSERT_TRUE(wrong);
  EXPECT_EQ(wrong->role, Quantity::dynamic_pressure);
  EXPECT_EQ(wrong->unit, "Pa");
  EXPECT_FALSE(wrong->are_exchanged);
}

TEST_F(PlausiblePressure, StatedUnitThatMakesAPressureImpossibleIsNamed) {
  ModelDefinition stated = model_of_pair();
  stated.units[Quantity::static_pressure] = "Pa";
  const Flight right = flight_of({{700.0, 60.0}});
  EXPECT_THAT(test::error_of([&] { require(right, stated); }),
              test::IsError(Error::Code::unit, "PSFD in 'Pa'", "QCF", "static_pressure = \"hPa\""));
  stated = model_of_pair();
  stated.units[Quantity::dynamic_pressure] = "psi";
  EXPECT_THAT(test::error_of([&] { require(right, stated); }),
              test::IsError(Error::Code::unit, "QCF in 'psi'", "PSFD", "dynamic_pressure = \"hPa\""));
}

}  // namespace
}  // namespace pcor::internal
