#include <gmock/gmock.h>
#include <pcor/base/error.hpp>
#include <pcor/units/units.hpp>

#include <cmath>
#include <limits>

#include "support/error_of.hpp"

using pcor::Error;
using pcor::UnitConversion;
using pcor::UnitOwner;
using pcor::test::IsError;
using testing::AllOf;
using testing::Not;

namespace {

const UnitOwner owner{"PSFD", "flight.nc", "static_pressure"};

std::optional<Error> refusal(const std::string& from, const std::string& to, const UnitOwner& who = owner) {
  return pcor::test::error_of([&] { UnitConversion::between(from, to, who); });
}

double convert(double value, const std::string& from, const std::string& to) {
  return UnitConversion::between(from, to, owner)(value);
}

}  // namespace

TEST(Units, FileSpellingsMapToIntendedUnits) {
  EXPECT_DOUBLE_EQ(convert(10, "C", "K"), 283.15);
  EXPECT_DOUBLE_EQ(convert(10, "deg_C", "degC"), 10);
  EXPECT_DOUBLE_EQ(convert(10, "degC", "K"), 283.15);
  EXPECT_DOUBLE_EQ(convert(850, "mb", "hPa"), 850);
  EXPECT_DOUBLE_EQ(convert(850, "mbar", "Pa"), 85000);
  EXPECT_DOUBLE_EQ(convert(3, "M/s", "m/s"), 3);
  EXPECT_DOUBLE_EQ(convert(3, "M/s2", "m/s2"), 3);
  EXPECT_DOUBLE_EQ(convert(3, "M", "m"), 3);
  EXPECT_DOUBLE_EQ(convert(1000, "feet", "m"), 304.8);
  EXPECT_NEAR(convert(100, "knots", "m/s"), 100 * 1852. / 3600, 1e-12);
  EXPECT_DOUBLE_EQ(convert(45, "deg", "degree"), 45);
  EXPECT_DOUBLE_EQ(convert(45, "degree_T", "degree"), 45);
  EXPECT_DOUBLE_EQ(convert(2, "none", "1"), 2);
  EXPECT_DOUBLE_EQ(convert(7, "#/cm3", "cm-3"), 7);
  EXPECT_DOUBLE_EQ(convert(7, "N/cm3", "cm-3"), 7) << "N counts particles, it is not newton";
  EXPECT_DOUBLE_EQ(convert(7, "cnt", "1"), 7) << "counts, not centinit";
  EXPECT_NEAR(convert(29.92126, "inHg", "hPa"), 1013.25, 0.003);
}

TEST(Units, EveryUnitOfTheReferenceFlightIsKnown) {
  for (const char* unit :
       {"%",     "C",         "K",    "Lpm",   "M",     "M-1",  "M/s",  "M/s2", "N/L",   "N/cM3",   "N/cm3",
        "Vdc",   "W",         "W/M2", "cnt",   "cnts",  "day",  "deg",  "feet", "g/M3",  "g/kg",    "hours",
        "knots", "mbar",      "none", "month", "ppbv",  "s",    "slpm", "splm", "uM",    "minutes", "vlpm",
        "year",  "std cm3/s", "hPa",  "mb",    "deg_C", "degC", "m/s",  "m",    "degree"})
    EXPECT_TRUE(pcor::is_known_unit(unit)) << unit;
  EXPECT_FALSE(pcor::is_known_unit(""));
  EXPECT_FALSE(pcor::is_known_unit("furlong-ish"));
}

TEST(Units, OnlyNonstandardSpellingsAreChanged) {
  EXPECT_EQ(pcor::standard_unit("C"), "degC");
  EXPECT_EQ(pcor::standard_unit("M/s"), "m/s");
  EXPECT_EQ(pcor::standard_unit("hPa"), "hPa");
  EXPECT_EQ(pcor::standard_unit("c"), "c") << "the table is case-sensitive";
}

TEST(Units, EqualUnitsConvertExactly) {
  for (const auto& [from, to] :
       {std::pair{"hPa", "hPa"}, {"mbar", "hPa"}, {"C", "degC"}, {"deg", "degree"}}) {
    const UnitConversion conversion = UnitConversion::between(from, to, owner);
    EXPECT_EQ(conversion.scale(), 1) << from;
    EXPECT_EQ(conversion.offset(), 0) << from;
  }
}

TEST(Units, TimeConversionUsesTheReferenceDates) {
  // 10957 days from 1970 to 2000. 2011-11-17 20:00 is day 4338 of 2000 and 5/6 of it.
  const auto date = [](double seconds) {
    return convert(seconds, "seconds since 1970-01-01 00:00:00 +0000", "days since 2000-01-01");
  };
  EXPECT_NEAR(date(1321560000.0), 4338.0 + 20.0 / 24.0, 1e-9);
  EXPECT_NEAR(date(10957.0 * 86400.0), 0.0, 1e-9);
}

TEST(Units, RoundTripConversionIsTheIdentity) {
  const auto there = UnitConversion::between("degF", "K", owner),
             back = UnitConversion::between("K", "degF", owner);
  for (const double value : {-459.67, -40.0, 0.0, 32.0, 212.0}) EXPECT_NEAR(back(there(value)), value, 1e-10);
}

TEST(Units, MissingValuesStayMissing) {
  EXPECT_TRUE(std::isnan(convert(std::numeric_limits<double>::quiet_NaN(), "C", "K")));
}

TEST(Units, UnknownUnitErrorStatesRemedy) {
  EXPECT_THAT(refusal("furlong-ish", "hPa"), IsError(Error::Code::unit, "flight.nc", "PSFD", "furlong-ish",
                                                     "unit.static_pressure = \"hPa\"", "[units]"));
}

TEST(Units, MissingUnitErrorStatesRemedy) {
  EXPECT_THAT(refusal("", "hPa"), IsError(Error::Code::unit, "PSFD", "unit.static_pressure = \"hPa\""));
}

TEST(Units, AnotherQuantityIsRefused) {
  EXPECT_THAT(refusal("K", "hPa"), IsError(Error::Code::unit, "PSFD", "\"K\"", "hPa"));
  EXPECT_THAT(refusal("degC", "degree"), IsError(Error::Code::unit, "degC", "degree"));
}

TEST(Units, ALogarithmicUnitIsRefused) {
  EXPECT_THAT(refusal("dBZ", "m3"), IsError(Error::Code::unit, "dBZ", "m3"));
}

// UDUNITS converts a unit to its reciprocal, by a hyperbola.
TEST(Units, AReciprocalIsRefused) {
  EXPECT_THAT(refusal("s/m", "m/s"), IsError(Error::Code::unit, "s/m", "m/s"));
  EXPECT_THAT(refusal("0.1 ks-1 @ 5", "seconds since 1970-01-01"), IsError(Error::Code::unit));
}

TEST(Units, OriginBeyondPrecisionIsRefused) {
  EXPECT_THAT(refusal("hPa @ 1e300", "hPa"), IsError(Error::Code::unit));
}

TEST(Units, WithoutARoleTheMessageNamesNoTable) {
  EXPECT_THAT(refusal("", "hPa", {"PSFD", "", ""}),
              AllOf(IsError(Error::Code::unit, "PSFD"), Not(IsError(Error::Code::unit, "[units]"))));
}
