#include <gmock/gmock.h>
#include <sys/resource.h>
#include <pcor/base/error.hpp>
#include <pcor/base/utc.hpp>
#include <pcor/flight/flight.hpp>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>
#include <tuple>

#include "support/constants.hpp"
#include "support/error_of.hpp"
#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"
#include "support/values_of.hpp"

using pcor::Error;
using pcor::Flight;
using pcor::RecordBlock;
using pcor::TimestampAlignment;
using pcor::UnitConversion;
using pcor::utc_text;
using pcor::test::error_of;
using pcor::test::infinity;
using pcor::test::IsError;
using pcor::test::midnight;
using pcor::test::missing;
using pcor::test::NetcdfMaker;
using pcor::test::sequence;
using pcor::test::values_of;
using testing::DoubleEq;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsNan;

namespace {

class FlightTest : public testing::Test {
 protected:
  std::filesystem::path path() const { return directory / "flight.nc"; }

  // The error of opening the file.
  std::optional<Error> refusal() const { return refusal(path()); }
  static std::optional<Error> refusal(const std::filesystem::path& file) {
    std::optional<Error> error = error_of([&] { Flight{file}; });
    EXPECT_THAT(error ? error->what() : "", HasSubstr(file.string()));
    return error;
  }

  std::vector<double> read(const std::string& name, const std::string& unit = "") const {
    return values_of(Flight(path()), name, unit);
  }

  std::vector<double> times() const {
    const Flight flight(path());
    std::vector<double> values(flight.records());
    flight.read_time_stamps({0, flight.records()}, values.data());
    return values;
  }

  template <class Fill>
  void make(const std::vector<double>& seconds, const Fill& fill) const {
    pcor::test::make_flight(path(), seconds, fill);
  }
  template <class Fill>
  void make_classic(const std::vector<double>& seconds, const Fill& fill) const {
    pcor::test::make_flight(path(), seconds, fill, 0);
  }

  void make_with_times(const std::vector<double>& seconds, int type = NC_INT) const {
    NetcdfMaker maker(path());
    maker.time(seconds, "seconds since 2004-02-18 00:00:00 +0000", type);
  }

  // base_time and time_offset as before 2005
  static void put_old_time(NetcdfMaker& maker, double base, const std::vector<double>& offsets) {
    maker.time_dimension = maker.dimension("Time", offsets.size());
    const int base_time = maker.variable("base_time", NC_INT, {});
    const int offset = maker.variable("time_offset", NC_FLOAT, {maker.time_dimension});
    maker.values(base_time, {base});
    maker.values(offset, offsets);
  }

  pcor::test::TemporaryDirectory directory;
};

// Files that cannot be read

TEST_F(FlightTest, AnAbsentFileIsNamed) { EXPECT_THAT(refusal(), IsError(Error::Code::file)); }

TEST_F(FlightTest, ADirectoryIsRefused) {
  EXPECT_THAT(refusal(directory.path()), IsError(Error::Code::file));
}

TEST_F(FlightTest, ADeviceIsRefused) { EXPECT_THAT(refusal("/dev/null"), IsError(Error::Code::file)); }

TEST_F(FlightTest, AFileOfAnotherKindIsRefused) {
  std::ofstream(path()) << "PSFD,QCF\n850,100\n";
  EXPECT_THAT(refusal(), IsError(Error::Code::file));
  std::ofstream(path(), std::ios::trunc).flush();
  EXPECT_THAT(refusal(), IsError(Error::Code::file));
}

TEST_F(FlightTest, RefusesTruncatedFilesOfEachFormat) {
  for (const int mode : {0, NC_64BIT_OFFSET, NC_64BIT_DATA, NC_NETCDF4}) {
    for (const bool one_record_variable : {true, false}) {
      {
        NetcdfMaker maker(path(), mode);
        maker.time(sequence(100, 500));
        if (!one_record_variable) maker.series("PSFD", "hPa", std::vector<double>(500, 850));
      }
      EXPECT_EQ(Flight(path()).records(), 500);
      const auto size = std::filesystem::file_size(path());
      for (const std::uintmax_t remaining : {size - 1, size / 2, std::uintmax_t{40}}) {
        std::filesystem::resize_file(path(), remaining);
        EXPECT_THAT(refusal(), IsError(Error::Code::file)) << mode << " " << remaining << " of " << size;
      }
    }
  }
}

TEST_F(FlightTest, AFileWithoutANameIsRefused) {
  EXPECT_THAT(error_of([] { Flight{""}; }), IsError(Error::Code::file));
}

// The netCDF library trusts a header, and allocates the stated memory.
TEST_F(FlightTest, DamagedHeaderUsesLittleTimeAndMemory) {
  constexpr int mutations = 250;
  constexpr std::size_t max_mutated = 2048;
  const auto begin = std::chrono::steady_clock::now();
  std::mt19937 random(20040218);
  int refused = 0;
  for (const int mode : {0, NC_64BIT_OFFSET, NC_64BIT_DATA}) {
    {
      NetcdfMaker maker(path(), mode);
      maker.text(NC_GLOBAL, "FlightDate", "02/18/2004");
      maker.time(sequence(100, 50));
      for (int i = 0; i < 10; ++i) {
        const int number = maker.series("PS" + std::to_string(i), "hPa", std::vector<double>(50, 850));
        maker.text(number, "long_name", "Static Pressure of system " + std::to_string(i));
      }
      maker.series("FAST", "hPa", std::vector<double>(250, 100), 5);
    }
    std::ostringstream text;
    text << std::ifstream(path(), std::ios::binary).rdbuf();
    const std::string whole = text.str();
    std::uniform_int_distribution<std::size_t> position(0, std::min(max_mutated, whole.size()) - 1);
    for (int i = 0; i < mutations; ++i) {
      std::string damaged = whole;
      for (auto changes = 1 + random() % 4; changes > 0; --changes) {
        const auto kind = random() % 3;
        damaged[position(random)] = static_cast<char>(kind == 0 ? 0xff : kind == 1 ? 0 : random() % 256);
      }
      std::ofstream(path(), std::ios::binary) << damaged;
      try {
        const Flight flight(path());
        for (const std::string& name : flight.variables()) {
          if (flight.variable(name).is_series) values_of(flight, name);
        }
      } catch (const Error&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 100);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(60));
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  EXPECT_LT(usage.ru_maxrss, 2 << 20) << "kB";
}

TEST_F(FlightTest, ImpossibleDimensionCountIsRefused) {
  for (const int mode : {0, NC_64BIT_DATA}) {
    { NetcdfMaker(path(), mode).time(sequence(100, 5)); }
    std::fstream file(path(), std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(mode == 0 ? 12 : 16);  // number of dimensions
    file.put('\x3f');
    file.close();
    EXPECT_THAT(refusal(), IsError(Error::Code::file));
  }
}

/// The netCDF library copies a name to where there is room for 256 bytes, however long it is.
TEST_F(FlightTest, RefusesNamesLongerThanNetcdfAllows) {
  const std::filesystem::path seeds = std::filesystem::path(PCOR_SOURCE_DIR) / "tests/fuzz/seeds/flight";
  std::filesystem::copy_file(seeds / "long_attribute_name.nc", path());
  EXPECT_THAT(refusal(), IsError(Error::Code::file));
  std::filesystem::copy_file(seeds / "long_names_hdf5.nc", path(),
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(refusal(), IsError(Error::Code::file, "256"));
}

TEST_F(FlightTest, AnEmptyTimeDimensionIsRefused) {
  NetcdfMaker(path()).time({});
  EXPECT_THAT(refusal(), IsError(Error::Code::samples, "Time"));
}

TEST_F(FlightTest, AFileWithoutTimeIsRefused) {
  { NetcdfMaker(path()).dimension("x", 3); }
  EXPECT_THAT(refusal(), IsError(Error::Code::time, "Time", "base_time", "time_offset"));
}

// Time

TEST_F(FlightTest, TimeCountsFromMidnight) {
  make_with_times({51720, 51721, 51722});
  const Flight flight(path());
  EXPECT_EQ(utc_text(flight.time().first), "2004-02-18 14:22:00");
  EXPECT_EQ(utc_text(flight.time().last), "2004-02-18 14:22:02");
  EXPECT_EQ(flight.time().step, 1);
  EXPECT_TRUE(flight.time().whole_seconds);
  EXPECT_EQ(flight.time().gap_count, 0);
  EXPECT_THAT(times(), ElementsAre(midnight + 51720, midnight + 51721, midnight + 51722));
}

TEST_F(FlightTest, TimeMayExceed86400Seconds) {
  make_with_times({86399, 86400, 86401});
  EXPECT_EQ(utc_text(Flight(path()).time().last), "2004-02-19 00:00:01");
}

TEST_F(FlightTest, TimeMayWrapAtMidnight) {
  make_with_times({86398, 86399, 0, 1});
  EXPECT_THAT(Flight(path()).time().midnight_wraps, ElementsAre(2));
  EXPECT_THAT(times(), ElementsAre(midnight + 86398, midnight + 86399, midnight + 86400, midnight + 86401));
  double one = 0;
  Flight(path()).read_time_stamps({3, 1}, &one);
  EXPECT_EQ(one, midnight + 86401) << "the same in a block that begins after midnight";
}

TEST_F(FlightTest, TheTimeDimensionMayBeLowerCaseAndFixed) {
  {
    NetcdfMaker maker(path());
    const int dimension = maker.dimension("time", 2);
    const int time = maker.variable("time", NC_DOUBLE, {dimension});
    maker.text(time, "units", "hours since 2004-02-18");
    maker.values(time, {10, 11});
  }
  EXPECT_THAT(times(), ElementsAre(midnight + 36000, midnight + 39600));
}

TEST_F(FlightTest, OldFilesHaveBaseTimeAndTimeOffset) {
  {
    NetcdfMaker maker(path(), 0);
    put_old_time(maker, midnight + 51720, {0, 1, 2});
  }
  EXPECT_THAT(times(), ElementsAre(midnight + 51720, midnight + 51721, midnight + 51722));
  EXPECT_EQ(Flight(path()).time_variable(), "time_offset");
}

TEST_F(FlightTest, InvalidTimeUnitsFallBackToBaseTime) {
  for (const char* units :
       {"seconds since 1141-01-00 00:00:00 +0000", "seconds since 1970-1-1 0:00:00 0:00", "s", ""}) {
    {
      NetcdfMaker maker(path());
      const int base = maker.variable("base_time", NC_INT, {});
      maker.values(base, {midnight + 51720});
      maker.time({51720, 51721}, units);
    }
    EXPECT_THAT(times(), ElementsAre(midnight + 51720, midnight + 51721)) << units;
  }
}

TEST_F(FlightTest, SecondsSince1970AreNotShifted) {
  {
    NetcdfMaker maker(path());
    maker.time({midnight + 51720, midnight + 51721}, "seconds since 1970-1-1 0:00:00 0:00");
  }
  EXPECT_THAT(times(), ElementsAre(midnight + 51720, midnight + 51721));
}

TEST_F(FlightTest, WithoutBaseTimeTheFlightDateIsUsed) {
  for (const double first : {51720., 0.}) {
    {
      NetcdfMaker maker(path());
      maker.text(NC_GLOBAL, "FlightDate", std::string("02/18/2004\0", 11));
      maker.text(NC_GLOBAL, "TimeInterval", "14:22:00-15:13:00");
      maker.time({first, first + 1}, "seconds");
    }
    EXPECT_THAT(times(), ElementsAre(midnight + 51720, midnight + 51721)) << "from " << first;
  }
}

TEST_F(FlightTest, MonthsAndYearsAreInvalidTimeUnits) {
  for (const char* units : {"months since 2004-01-01", "years since 2004-01-01"}) {
    { NetcdfMaker(path()).time({1, 2}, units); }
    EXPECT_THAT(refusal(), IsError(Error::Code::time, units, "ncatted -a units,Time"));
  }
  { NetcdfMaker(path()).time({1, 2}, "days since 2004-02-18"); }
  EXPECT_EQ(Flight(path()).time().step, 86400) << "slow, and not wrong";
}

TEST_F(FlightTest, AmbiguousTimeStatesHowToDefineIt) {
  { NetcdfMaker(path()).time({51720, 51721}, "seconds since 1141-01-00 00:00:00 +0000"); }
  EXPECT_THAT(refusal(), IsError(Error::Code::time, "1141-01-00", "ncatted -a units,Time"));
}

TEST_F(FlightTest, NonGregorianCalendarIsRefused) {
  const auto make = [this](const std::string& calendar, const std::string& units) {
    NetcdfMaker maker(path());
    const int time = maker.time({51720, 51721}, units, NC_DOUBLE);
    maker.text(NC_GLOBAL, "FlightDate", "02/18/2004");
    maker.text(time, "calendar", calendar);
  };
  const std::string units = "seconds since 2004-02-18 00:00:00 +0000";
  for (const char* calendar : {"noleap", "365_day", "all_leap", "360_day", "julian", "tai"}) {
    make(calendar, units);
    EXPECT_THAT(refusal(), IsError(Error::Code::time, "Time", calendar));
  }
  for (const char* calendar : {"standard", "Gregorian", "proleptic_gregorian"}) {
    make(calendar, units);
    EXPECT_EQ(utc_text(Flight(path()).time().first), "2004-02-18 14:22:00") << calendar;
  }
  // Before 1582 the standard calendar is the Julian one, two days apart.
  make("proleptic_gregorian", "seconds since 1500-01-01");
  EXPECT_THAT(refusal(), IsError(Error::Code::time, "1500"));
}

TEST_F(FlightTest, TimeZoneMustBeUtcOrAnOffset) {
  for (const char* zone : {"", " UTC", " GMT", " Z", "Z", " +0000", " +00:00"}) {
    { NetcdfMaker(path()).time({51720, 51721}, std::string("seconds since 2004-02-18 00:00:00") + zone); }
    EXPECT_EQ(utc_text(Flight(path()).time().first), "2004-02-18 14:22:00") << zone;
  }
  { NetcdfMaker(path()).time({51720, 51721}, "seconds since 2004-02-18 00:00:00 -07:00"); }
  EXPECT_EQ(utc_text(Flight(path()).time().first), "2004-02-18 21:22:00");
  for (const char* rest : {" MST", " (MST)", " Europe/Berlin"}) {
    {
      NetcdfMaker maker(path());
      maker.text(NC_GLOBAL, "FlightDate", "02/18/2004");  // the day in that zone, so no help
      maker.time({51720, 51721}, std::string("seconds since 2004-02-18 00:00:00") + rest);
    }
    EXPECT_THAT(refusal(), IsError(Error::Code::time, rest, "UTC", "ncatted -a units,Time"));
  }
}

TEST_F(FlightTest, AdviceOnAZoneKeepsTheTimeOfDay) {
  for (const char* of_day : {" 14:22:00 MST", " 14:22:00 +25:00", " 14:22:00 +HHMM"}) {
    { NetcdfMaker(path()).time({0, 1}, std::string("seconds since 2004-02-18") + of_day); }
    EXPECT_THAT(refusal(), IsError(Error::Code::time, "'seconds since 2004-02-18 14:22:00 +HHMM'"));
  }
  { NetcdfMaker(path()).time({0, 1}, "hours since 2004-02-18 MST"); }
  EXPECT_THAT(refusal(), IsError(Error::Code::time, "'hours since 2004-02-18 00:00:00 +HHMM'"));
}

TEST_F(FlightTest, FlightDateReplacesOnlyTheDate) {
  const auto make = [this](const std::string& units) {
    NetcdfMaker maker(path());
    maker.text(NC_GLOBAL, "FlightDate", "02/18/2004");
    maker.time({51720, 51721}, units);
  };
  for (const char* units :
       {"seconds since 20040218T000000-0700", "seconds since 20040218050000",
        "seconds since 02/18/2004 05:00:00", "seconds since 18-02-2004 00:00:00 +05:00",
        "seconds since 18-02-2004 00:60:00", "seconds since 18-02-2004 00:00:00 MST",
        "seconds since 2004-02-31 00:00:00 -07:00", "seconds from 2004-02-18 00:00:00 -07:00",
        "seconds since 1970-01-01 00:00:00 -07:00", "seconds since 00:00:00 -07:00",
        "hours since 18-02-2004"}) {
    make(units);
    EXPECT_THAT(refusal(), IsError(Error::Code::time, units, "ncatted -a units,Time"));
  }
  for (const char* units : {"s", "seconds since midnight", "seconds since 00:00:00 UTC",
                            "seconds since 1141-01-00 00:00:00 +0000", "seconds since 20040218",
                            "seconds since 02/18/2004 00:00:00", "seconds since 18-02-2004T00:00:00Z",
                            "seconds since 1970-1-1 0:00:00 0:00"}) {
    make(units);
    EXPECT_EQ(utc_text(Flight(path()).time().first), "2004-02-18 14:22:00") << units;
  }
}

TEST_F(FlightTest, InvalidDateIsRefused) {
  for (const char* date : {"2011-13-45", "2011-02-30", "2011-00-10", "2004-049", "0000-01-01"}) {
    { NetcdfMaker(path()).time({51720, 51721}, std::string("seconds since ") + date); }
    EXPECT_THAT(refusal(), IsError(Error::Code::time, "Time", date));
  }
  { NetcdfMaker(path()).time({51720, 51721}, "seconds since 2004-02-29"); }
  EXPECT_EQ(utc_text(Flight(path()).time().first), "2004-02-29 14:22:00");
}

TEST_F(FlightTest, AYearBeforeOrAfterAllFlightsIsRefused) {
  for (const char* units :
       {"seconds since 1890-01-01", "seconds since 3011-11-17", "days since 1970-01-01"}) {
    {
      NetcdfMaker maker(path());
      maker.text(NC_GLOBAL, "FlightDate", "02/18/2004");
      maker.time({151720, 151721}, units);
    }
    EXPECT_THAT(refusal(), IsError(Error::Code::time, units, "ncatted -a units,Time"));
  }
  make_with_times({100, 101, 1e12}, NC_DOUBLE);
  EXPECT_THAT(refusal(), IsError(Error::Code::time, "record 2", "1.00108e+12 s"));
}

// 20:05:00 in 16 bits is 01:52:44, and the file gives no hint.
TEST_F(FlightTest, TimeOfLessThan32BitsIsRefused) {
  for (const int type : {NC_SHORT, NC_USHORT, NC_BYTE}) {
    make_with_times({100, 101}, type);
    EXPECT_THAT(refusal(), IsError(Error::Code::time, "Time", "32-bit"));
  }
}

// As xarray packs it: half a second a step, from noon.
TEST_F(FlightTest, PackedTimesAreUnpackedBeforeTheirChecks) {
  for (const int type : {NC_SHORT, NC_INT}) {
    {
      NetcdfMaker maker(path());
      const int time = maker.time({0, 2, 4}, "seconds since 2004-02-18 00:00:00 +0000", type);
      maker.numbers(time, "scale_factor", NC_DOUBLE, {0.5});
      maker.numbers(time, "add_offset", NC_DOUBLE, {80000});
    }
    EXPECT_THAT(times(), ElementsAre(midnight + 80000, midnight + 80001, midnight + 80002));
  }
}

TEST_F(FlightTest, RefusesDuplicateNames) {
  make_classic({100, 101}, [&](NetcdfMaker& maker) {
    maker.series("PSFD", "hPa", {850, 851});
    maker.series("PSFX", "hPa", {1, 2});
  });
  std::ostringstream text;
  text << std::ifstream(path(), std::ios::binary).rdbuf();
  std::string bytes = text.str();
  bytes.replace(bytes.find("PSFX"), 4, "PSFD");
  std::ofstream(path(), std::ios::binary) << bytes;
  EXPECT_THAT(refusal(), IsError(Error::Code::file, "PSFD"));
}

TEST_F(FlightTest, RatesAbove1000HzAreRefusedOnRead) {
  const auto make = [this](std::size_t rate, double step) {
    NetcdfMaker maker(path());
    maker.time({100, 100 + step}, "seconds since 2004-02-18 00:00:00 +0000", NC_DOUBLE);
    maker.series("FAST", "hPa", std::vector<double>(2 * rate, 850), static_cast<int>(rate));
  };
  make(1000, 1);
  EXPECT_EQ(read("FAST").size(), 2000U);
  make(60000, 60);
  EXPECT_EQ(read("FAST").size(), 120000U);
  const auto refused = [this] { return error_of([&] { read("FAST"); }); };
  make(1001, 1);
  EXPECT_THAT(refused(), IsError(Error::Code::variable, "FAST", "1001", "1 s"));
  make(1, 1e-6);
  EXPECT_THAT(refused(), IsError(Error::Code::variable, "FAST", "1"));
}

TEST_F(FlightTest, TooManyRecordsAreRefused) {
  { NetcdfMaker(path(), NC_64BIT_DATA).time({100, 101}); }
  std::fstream file(path(), std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(7);  // number of records: 2^35 more
  file.put('\x08');
  file.close();
  std::filesystem::resize_file(path(), std::uintmax_t{1} << 40);  // a hole
  EXPECT_THAT(refusal(), IsError(Error::Code::file, "100000000"));
}

TEST_F(FlightTest, BackwardTimeReportsRecordAndCount) {
  make_with_times({100, 101, 102, 101, 102, 90, 91});
  EXPECT_THAT(refusal(), IsError(Error::Code::time, "record 3", "2004-02-18 00:01:41", "2004-02-18 00:01:42",
                                 "2 backward", "0 repeated", "ncks -d Time,0,2"));
}

TEST_F(FlightTest, RepeatedTimeReportsTheRecord) {
  make_with_times({100, 101, 101, 102});
  EXPECT_THAT(refusal(), IsError(Error::Code::time, "record 2", "0 backward", "1 repeated"));
}

TEST_F(FlightTest, MissingTimeReportsTheRecord) {
  {
    NetcdfMaker maker(path());
    const int time = maker.time({}, "seconds since 2004-02-18 00:00:00 +0000");
    maker.numbers(time, "missing_value", NC_INT, {-32767});
    maker.values(time, {100, 101, -32767, 103});
  }
  EXPECT_THAT(refusal(), IsError(Error::Code::time, "record 2"));
}

TEST_F(FlightTest, GapsAreAllowedAndCounted) {
  make_with_times({100, 101, 110, 111, 200});
  EXPECT_EQ(Flight(path()).time().gap_count, 2);
}

TEST_F(FlightTest, TimeStepsMayBeIrregularAndFractional) {
  make_with_times({100, 101.1, 101.9, 103}, NC_DOUBLE);
  const Flight flight(path());
  EXPECT_FALSE(flight.time().whole_seconds);
  EXPECT_NEAR(flight.time().step, 1.1, 1e-6);
}

TEST_F(FlightTest, TimeIsCheckedAcrossBlocks) {
  std::vector<double> seconds = sequence(0, 2 * pcor::records_per_block);
  seconds[pcor::records_per_block] = seconds[pcor::records_per_block - 1];
  make_with_times(seconds);
  EXPECT_THAT(refusal(), IsError(Error::Code::time, "record " + std::to_string(pcor::records_per_block)));
}

TEST_F(FlightTest, SamplesLieInTheMiddleOfTheirIntervals) {
  make_with_times({100, 101});
  double values[4];
  Flight(path()).read_sample_times({0, 2}, 1, values);
  EXPECT_THAT(std::vector(values, values + 2), ElementsAre(midnight + 100.5, midnight + 101.5));
  Flight(path()).read_sample_times({0, 2}, 2, values);
  EXPECT_THAT(std::vector(values, values + 4),
              ElementsAre(midnight + 100.25, midnight + 100.75, midnight + 101.25, midnight + 101.75));
  Flight(path(), TimestampAlignment::middle).read_sample_times({0, 2}, 1, values);
  EXPECT_THAT(std::vector(values, values + 2), ElementsAre(midnight + 100, midnight + 101));
  Flight(path(), TimestampAlignment::middle).read_sample_times({0, 1}, 2, values);
  EXPECT_THAT(std::vector(values, values + 2), ElementsAre(midnight + 99.75, midnight + 100.25));
}

// Variables

TEST_F(FlightTest, MissingVariableSuggestsSimilarNames) {
  make({100}, [&](NetcdfMaker& maker) {
    for (const char* name : {"TASX", "QCR", "QCFR", "QCX", "PSFD"}) maker.series(name, "hPa", {1});
  });
  const Flight flight(path());
  EXPECT_THAT(error_of([&] { flight.variable("QCF"); }),
              IsError(Error::Code::variable, path().string(), "QCF", "QCFR, QCR, QCX"));
  EXPECT_TRUE(flight.has("QCR"));
  EXPECT_FALSE(flight.has("QCF"));
}

TEST_F(FlightTest, MissingModelVariableReportsRoleAndMatches) {
  make({100}, [&](NetcdfMaker& maker) {
    maker.series("QCFR", "mbar", {1});
    maker.series("QCR", "hPa", {1});
    maker.series("QCX", "hPa", {1});
    maker.series("QCFK", "K", {1});
    maker.text(maker.series("ATX", "degC", {1}), "long_name", "Ambient");
    maker.series("RSTB1", "degC", {1});
    maker.series("COUNTS", "1", {1});
    maker.text(maker.series("PSXC", "hPa", {1}), "long_name", "Corrected Static Pressure, Reference");
    maker.text(maker.series("INPS2", "hPa", {1}), "long_name", "Static Pressure, Sample Plane");
    for (const char* name : {"TTRR", "TTRL", "TTWH"})
      maker.text(maker.series(name, "C", {1}), "long_name", "Total Temperature");
  });
  const Flight flight(path());
  const auto rejection_reason_of = [&](const char* name, const char* unit, const char* role) {
    return error_of([&] { flight.conversion(name, unit, role); });
  };
  EXPECT_THAT(rejection_reason_of("QCF", "hPa", "dynamic_pressure"),
              IsError(Error::Code::variable, path().string(), "QCF", "QCFR, QCR, QCX", "dynamic_pressure",
                      "[variables]"));
  EXPECT_THAT(rejection_reason_of("RTF1", "K", "recovery_temperature"),
              IsError(Error::Code::variable, path().string(), "RTF1", "recovery_temperature",
                      "TTRR, TTRL, TTWH in degC, QCFK in K, ATX, RSTB1 in degC", "[variables]"))
      << "the words of the role first";
  EXPECT_THAT(rejection_reason_of("ALT", "degree", "attack"),
              IsError(Error::Code::variable, "ALT", "attack", "degree", "[variables]"));
  EXPECT_THAT(rejection_reason_of("PSF", "hPa", "static_pressure"),
              IsError(Error::Code::variable, "PSF", "only PSXC, already corrected", "pcor inspect"));
  EXPECT_THAT(rejection_reason_of("ENGTRQ", "percent", "engine_torque")->what(),
              testing::Not(testing::HasSubstr("COUNTS")))
      << "many variables are ratios";
  EXPECT_STREQ(error_of([&] { flight.conversion("QCF", "hPa"); })->what(),
               error_of([&] { flight.variable("QCF"); })->what())
      << "no role, so no model to change";
}

TEST_F(FlightTest, RawPressureOfAnotherNameIsProposedInPlaceOfTheCorrectedOne) {
  make({100}, [&](NetcdfMaker& maker) {
    maker.text(maker.series("PSXC", "hPa", {1}), "long_name", "Corrected Static Pressure");
    maker.text(maker.series("STATP", "hPa", {1}), "long_name", "Raw static pressure");
  });
  const Flight flight(path());
  EXPECT_THAT(error_of([&] { flight.conversion("PSFD", "hPa", "static_pressure"); }),
              IsError(Error::Code::variable, "PSFD", "STATP in hPa"));
}

TEST_F(FlightTest, AtMostSixMatchingVariablesAreListed) {
  make({100}, [&](NetcdfMaker& maker) {
    for (int i = 1; i < 10; ++i) maker.series("ABCD" + std::to_string(i), "degC", {1});
  });
  const Flight flight(path());
  EXPECT_THAT(error_of([&] { flight.conversion("ZZ", "K", "ambient_temperature"); }),
              IsError(Error::Code::variable, "ABCD1, ABCD2, ABCD3, ABCD4, ABCD5, ABCD6 in degC and 3"));
}

TEST_F(FlightTest, ModelUnitOverridesFileUnit) {
  make({100}, [&](NetcdfMaker& maker) {
    maker.series("PSFD", "mbar", {850});
    maker.series("HEAT", "K", {1});
    maker.series("ODD", "furlong-ish", {1});
    maker.series("BARE", "", {1});
  });
  const Flight flight(path());
  const auto stated = [&](const char* name, const char* unit) {
    return flight.conversion(name, "hPa", "static_pressure", unit)(1);
  };
  EXPECT_EQ(stated("PSFD", "hPa"), 1) << "the same in another spelling";
  EXPECT_EQ(stated("ODD", "kPa"), 10);
  EXPECT_EQ(stated("BARE", "kPa"), 10);
  EXPECT_EQ(stated("PSFD", "Pa"), 0.01) << "the file's unit is wrong";
  EXPECT_EQ(stated("HEAT", "hPa"), 1) << "its kind, too";
  EXPECT_EQ(stated("PSFD", "-1 hPa"), -1) << "a minus turns the sign";
  const auto rejection_reason_of = [&](const char* name, const char* unit) {
    return error_of([&] { stated(name, unit); });
  };
  for (const char* wrong : {"furlong", "K", "furlong-ish"})
    EXPECT_THAT(rejection_reason_of("BARE", wrong),
                IsError(Error::Code::unit, wrong, "BARE", "unit.static_pressure", "[units]"));
}

TEST_F(FlightTest, TrailingNulOfAttributesIsRemoved) {
  make({100}, [&](NetcdfMaker& maker) {
    const int number = maker.series("PSFD", std::string("mbar\0", 5), {850});
    maker.text(number, "long_name", std::string("Static\0\0", 8));
    maker.text(NC_GLOBAL, "Aircraft", std::string("N130AR\0", 7));
    maker.text(NC_GLOBAL, "project", "GOTEX");
  });
  const Flight flight(path());
  EXPECT_EQ(flight.variable("PSFD").units, "mbar");
  EXPECT_EQ(flight.variable("PSFD").long_name, "Static");
  EXPECT_EQ(flight.aircraft(), "N130AR");
  EXPECT_EQ(flight.project(), "GOTEX");
  EXPECT_EQ(flight.flight_number(), "");
}

TEST_F(FlightTest, EveryMissingValueMarkerBecomesNan) {
  make_classic({100, 101, 102, 103, 104}, [&](NetcdfMaker& maker) {
    const auto put = [&](const char* name, const char* attribute, int type, double marker) {
      const int number = maker.variable(name, NC_FLOAT, {maker.time_dimension});
      if (attribute != nullptr) maker.numbers(number, attribute, type, {marker});
      maker.values(number, {marker, missing, infinity, -infinity, 5});
    };
    put("FILL", "_FillValue", NC_FLOAT, -32767);
    put("MISSING", "missing_value", NC_FLOAT, -9999.9f);
    put("OLD", "MissingValue", NC_FLOAT, 99999);
    put("DOUBLE", "missing_value", NC_DOUBLE, -999.9);
    put("BARE", nullptr, NC_FLOAT, -32767);
    put("DEFAULT", nullptr, NC_FLOAT, static_cast<double>(NC_FILL_FLOAT));
    const int text = maker.variable("TEXT", NC_FLOAT, {maker.time_dimension});
    maker.text(text, "missing_value", std::string("-32767.f\0", 9));
    maker.values(text, {-32767, missing, missing, missing, 5});
  });
  for (const char* name : {"FILL", "MISSING", "OLD", "DOUBLE", "BARE", "DEFAULT", "TEXT"})
    EXPECT_THAT(read(name), ElementsAre(IsNan(), IsNan(), IsNan(), IsNan(), 5)) << name;
}

TEST_F(FlightTest, TheDefaultFillOfEveryPackedTypeIsMissing) {
  make({100, 101}, [&](NetcdfMaker& maker) {
    const auto put = [&](const char* name, int type, double fill) {
      const int number = maker.variable(name, type, {maker.time_dimension});
      maker.numbers(number, "scale_factor", NC_DOUBLE, {0.5});
      maker.values(number, {10, fill});
    };
    put("SHORT", NC_SHORT, NC_FILL_SHORT);
    put("USHORT", NC_USHORT, NC_FILL_USHORT);
    put("INT", NC_INT, NC_FILL_INT);
    put("UINT", NC_UINT, NC_FILL_UINT);
    put("INT64", NC_INT64, static_cast<double>(NC_FILL_INT64));
    put("UINT64", NC_UINT64, 0);  // its fill value is not a double
  });
  {
    int id = 0, number = 0;
    nc_open(path().c_str(), NC_WRITE, &id);
    nc_inq_varid(id, "UINT64", &number);
    const std::size_t second = 1;
    const unsigned long long fill = NC_FILL_UINT64;
    nc_put_var1_ulonglong(id, number, &second, &fill);
    nc_close(id);
  }
  for (const char* name : {"SHORT", "USHORT", "INT", "UINT", "INT64", "UINT64"})
    EXPECT_THAT(read(name), ElementsAre(5, IsNan())) << name;
}

TEST_F(FlightTest, UnsignedAttributeAppliesToSignedIntegers) {
  make_classic({100, 101, 102, 103}, [&](NetcdfMaker& maker) {
    const auto put = [&](const char* name, int type, const std::vector<double>& stored) {
      const int number = maker.variable(name, type, {maker.time_dimension});
      maker.text(number, "_Unsigned", type == NC_BYTE ? "True" : "true");
      maker.numbers(number, "_FillValue", type, {-1});
      maker.numbers(number, "valid_max", type, {-3});
      maker.numbers(number, "scale_factor", NC_DOUBLE, {0.01});
      maker.numbers(number, "add_offset", NC_DOUBLE, {500});
      maker.values(number, stored);
    };
    put("BYTE", NC_BYTE, {100, -128, -1, -2});
    put("SHORT", NC_SHORT, {100, -32768, -1, -2});
    put("INT", NC_INT, {100, -4, -1, -2});
  });
  EXPECT_THAT(read("BYTE"), ElementsAre(501, DoubleEq(501.28), IsNan(), IsNan()));
  EXPECT_THAT(read("SHORT"), ElementsAre(501, DoubleEq(827.68), IsNan(), IsNan()));
  EXPECT_THAT(read("INT"), ElementsAre(501, DoubleEq(500 + 0.01 * 4294967292.), IsNan(), IsNan()));
}

TEST_F(FlightTest, InvalidValuesAreMissing) {
  make_classic({100, 101, 102}, [&](NetcdfMaker& maker) {
    const int range = maker.series("RANGE", "hPa", {850, 99.9f, 5000});
    maker.numbers(range, "valid_range", NC_FLOAT, {100, 1100});
    const int minimum = maker.series("LEAST", "hPa", {850, 0.1f, 0.05f});
    maker.numbers(minimum, "valid_min", NC_DOUBLE, {0.1});
    const int maximum = maker.series("GREATEST", "hPa", {850, 0.1f, 5000});
    maker.numbers(maximum, "valid_max", NC_FLOAT, {1100});
    const int packed = maker.variable("PACKED", NC_SHORT, {maker.time_dimension});
    maker.numbers(packed, "scale_factor", NC_DOUBLE, {0.5});
    maker.numbers(packed, "valid_range", NC_SHORT, {10, 20});
    maker.values(packed, {10, 20, 21});
  });
  EXPECT_THAT(read("RANGE"), ElementsAre(850, IsNan(), IsNan()));
  EXPECT_THAT(read("LEAST"), ElementsAre(850, DoubleEq(static_cast<double>(0.1f)), IsNan()))
      << "0.1 as a float is not below 0.1";
  EXPECT_THAT(read("GREATEST"), ElementsAre(850, DoubleEq(static_cast<double>(0.1f)), IsNan()));
  EXPECT_THAT(read("PACKED"), ElementsAre(5, 10, IsNan())) << "the range is that of the packed numbers";
}

TEST_F(FlightTest, TextRangeIsUsedOnlyIfTwoNumbers) {
  make_classic({100, 101, 102}, [&](NetcdfMaker& maker) {
    const auto put = [&](const char* name, const char* range) {
      maker.text(maker.series(name, "degree", {-95, 40, 95}), "valid_range", range);
    };
    put("OF_R", "c(-90, 90)");
    put("COMMA", "-90, 90");
    put("TO", "-90 to 90");
    put("BRACKETS", "[-90 90]");
    put("WORDS", "all of them");
    put("ONE", "90");
  });
  for (const char* const name : {"OF_R", "COMMA", "TO", "BRACKETS"}) {
    EXPECT_THAT(read(name), ElementsAre(IsNan(), 40, IsNan())) << name;
    EXPECT_EQ(Flight(path()).variable(name).ignored_range, "") << name;
  }
  EXPECT_THAT(read("WORDS"), ElementsAre(-95, 40, 95));
  EXPECT_EQ(Flight(path()).variable("WORDS").ignored_range, "valid_range = 'all of them'");
  EXPECT_EQ(Flight(path()).variable("ONE").ignored_range, "valid_range = '90'");
}

TEST_F(FlightTest, AircraftAttributeIsReadInEverySpelling) {
  for (const char* const name :
       {"platform", "Platform", "PLATFORM", "Aircraft", "aircraft", "tail_number", "platform_name"}) {
    make({100, 101}, [&](NetcdfMaker& maker) { maker.text(NC_GLOBAL, name, "N677F"); });
    EXPECT_EQ(Flight(path()).aircraft(), "N677F") << name;
  }
  make({100, 101},
       [&](NetcdfMaker& maker) { maker.text(NC_GLOBAL, "source", "NSF/NCAR GV (N677F), nimbus"); });
  EXPECT_EQ(Flight(path()).aircraft(), "N677F");
}

TEST_F(FlightTest, TimeUnitsMayHaveCapitalsAndAComma) {
  {
    NetcdfMaker maker(path());
    maker.time({804988800, 804988801}, "Seconds since 1970-01-01, 00:00:00 UTC");
  }
  EXPECT_EQ(Flight(path()).time().first, 804988800);
}

TEST_F(FlightTest, TimeIsFoundByDimensionOrStandardName) {
  for (const bool by_standard_name : {false, true}) {
    {
      NetcdfMaker maker(path());
      maker.time_dimension = maker.dimension(by_standard_name ? "record" : "UTC", NC_UNLIMITED);
      const int time = maker.variable("UTC", NC_DOUBLE, {maker.time_dimension});
      maker.text(time, "units", "seconds since 2015-07-29");
      if (by_standard_name) maker.text(time, "standard_name", "time");
      maker.values(time, {100, 101});
      maker.series("PS", "hPa", {850, 851});
    }
    const Flight flight(path());
    EXPECT_EQ(flight.time_variable(), "UTC");
    EXPECT_EQ(flight.time().last - flight.time().first, 1);
    EXPECT_THAT(read("PS"), ElementsAre(850, 851));
  }
}

TEST_F(FlightTest, TimeErrorStatesTheDateIfKnown) {
  const auto refusal_with = [this](const char* date) {
    {
      NetcdfMaker maker(path());
      maker.time({100, 101}, "fortnights since the war");
      if (*date != 0) maker.text(NC_GLOBAL, "FlightDate", date);
      maker.text(NC_GLOBAL, "TimeInterval", "09:00:00-10:00:00");
    }
    return error_of([this] { Flight flight(path()); });
  };
  EXPECT_THAT(refusal_with("07/05/1995"), IsError(Error::Code::time, "seconds since 1995-07-05 00:00:00"));
  EXPECT_THAT(refusal_with(""), IsError(Error::Code::time, "seconds since DAY 00:00:00"));
}

TEST_F(FlightTest, ImplausibleValuesAreMissing) {
  make({100, 101, 102, 103}, [&](NetcdfMaker& maker) {
    const int number = maker.variable("PSFD", NC_DOUBLE, {maker.time_dimension});
    maker.values(number, {850, 1e30, -1e300, infinity});
    const int packed = maker.variable("PACKED", NC_DOUBLE, {maker.time_dimension});
    maker.numbers(packed, "scale_factor", NC_DOUBLE, {1e300});
    maker.values(packed, {0, 1e10, 1e20, 1});
  });
  EXPECT_THAT(read("PSFD"), ElementsAre(850, IsNan(), IsNan(), IsNan()));
  EXPECT_THAT(read("PACKED"), ElementsAre(0, IsNan(), IsNan(), 1e300));
}

TEST_F(FlightTest, AmbiguousNumbersAreRefusedOnRead) {
  make({100, 101}, [&](NetcdfMaker& maker) {
    const auto put = [&](const char* name) {
      const int number = maker.variable(name, NC_SHORT, {maker.time_dimension});
      maker.values(number, {10, 11});
      return number;
    };
    maker.text(put("SCALE"), "scale_factor", "text");
    maker.numbers(put("ZERO"), "scale_factor", NC_DOUBLE, {0});
    maker.numbers(put("NAN"), "add_offset", NC_DOUBLE, {missing});
    maker.numbers(put("TWO"), "add_offset", NC_DOUBLE, {1, 2});
    maker.numbers(put("RANGE"), "valid_range", NC_SHORT, {20, 10});
    maker.numbers(put("ONE"), "valid_range", NC_SHORT, {20});
    const int packed = put("PACKED");
    maker.numbers(packed, "scale_factor", NC_DOUBLE, {0.5});
    maker.numbers(packed, "valid_max", NC_DOUBLE, {20});
    maker.text(put("DIGITS"), "scale_factor", "0.5");
  });
  const auto rejection_reason_of = [this](const char* name) { return error_of([&] { read(name); }); };
  EXPECT_THAT(rejection_reason_of("SCALE"),
              IsError(Error::Code::variable, path().string(), "\"text\"", "ncatted -a scale_factor,SCALE"));
  EXPECT_THAT(rejection_reason_of("ZERO"), IsError(Error::Code::variable, "scale_factor", "ZERO", "\"0\""));
  EXPECT_THAT(rejection_reason_of("NAN"), IsError(Error::Code::variable, "add_offset", "NAN"));
  EXPECT_THAT(rejection_reason_of("TWO"), IsError(Error::Code::variable, "add_offset", "TWO", "\"1, 2\""));
  EXPECT_THAT(rejection_reason_of("RANGE"), IsError(Error::Code::variable, "valid_range", "RANGE"));
  EXPECT_THAT(rejection_reason_of("ONE"), IsError(Error::Code::variable, "valid_range", "ONE"));
  EXPECT_THAT(rejection_reason_of("PACKED"), IsError(Error::Code::variable, "valid_max", "PACKED"));
  EXPECT_THAT(read("DIGITS"), ElementsAre(5, 5.5));
}

TEST_F(FlightTest, ImpossibleValuesAreCountedAndExcluded) {
  make({100, 101}, [&](NetcdfMaker& maker) {
    maker.series("PSFD", "hPa", {800, 802, 9999, 806, -9999, -32767}, 3);
  });
  const Flight flight(path());
  const UnitConversion possible = UnitConversion(0.1, 0).within(1, 120);
  std::vector<double> values(6);
  EXPECT_EQ(flight.read("PSFD", {0, 2}, possible, values.data()).impossible, 2U);
  EXPECT_THAT(values, ElementsAre(80, DoubleEq(80.2), IsNan(), DoubleEq(80.6), IsNan(), IsNan()));
  EXPECT_EQ(flight.read_at_rate(1, "PSFD", {0, 2}, possible, values.data()).impossible, 2U);
  EXPECT_THAT(values,
              ElementsAre(DoubleEq(80.1), DoubleEq(80.6), testing::_, testing::_, testing::_, testing::_));
}

TEST_F(FlightTest, KeptMeansEqualMeansThatAreRead) {
  make({100, 101}, [&](NetcdfMaker& maker) {
    maker.series("PSFD", "hPa", {800, 802, 9999, 806, 1e36, -32767}, 3);
    maker.series("QCF", "hPa", {50, -32767});
    maker.series("NONE", "hPa", {-32767, -32767});
    maker.variable("OTHER", NC_FLOAT, {});
  });
  const Flight flight(path()), kept(path());
  kept.keep_means({"PSFD", "QCF", "NONE", "OTHER", "ABSENT"});
  // The second conversion rejects a sample of PSFD.
  for (const UnitConversion& conversion : {UnitConversion(0.1, 1), UnitConversion(0.1, 0).within(1, 120)}) {
    for (const char* name : {"PSFD", "QCF", "NONE"}) {
      std::vector<double> expected(2), values(2);
      const pcor::RejectedCounts rejected = flight.read_at_rate(1, name, {0, 2}, conversion, expected.data());
      const pcor::RejectedCounts counted = kept.read_at_rate(1, name, conversion, values.data());
      for (int i = 0; i < 2; ++i) EXPECT_THAT(values[i], testing::NanSensitiveDoubleEq(expected[i])) << name;
      EXPECT_EQ(counted.impossible, rejected.impossible) << name;
      EXPECT_EQ(counted.enormous, rejected.enormous) << name;
    }
  }
  EXPECT_FALSE(error_of([&] { kept.require_values("QCF"); }));
  EXPECT_THAT(error_of([&] { kept.require_values("NONE"); }), IsError(Error::Code::variable, "no value"));
}

TEST_F(FlightTest, FlaggedUnusableValuesAreMissing) {
  make({0, 1, 2, 3}, [&](NetcdfMaker& file) {
    const auto series = [&](const std::string& name, int type, const std::vector<double>& values) {
      const int variable = file.variable(name, type, {file.time_dimension});
      file.values(variable, values);
      return variable;
    };
    for (const char* name : {"VALUES", "MASKS", "HARMLESS"}) series(name, NC_FLOAT, {1, 2, 3, 4});
    file.text(series("NAMED", NC_FLOAT, {1, 2, 3, 4}), "ancillary_variables",
              "NOT_THERE HARMLESS_FLAG QUALITY");
    // As FAAM writes them: the worse the higher, and -128 for no flag.
    const int values = series("VALUES_FLAG", NC_BYTE, {0, 1, 3, -128});
    file.numbers(values, "flag_values", NC_BYTE, {0, 1, 2, 3});
    file.text(values, "flag_meanings",
              "data_good possible_minor_issues possible_major_issues data_bad_or_missing");
    // Bits, of which the highest is the sign.
    const int masks = series("MASKS_FLAG", NC_BYTE, {1, 2, 3, -128});
    file.numbers(masks, "flag_masks", NC_BYTE, {1, 2, -128});
    file.text(masks, "flag_meanings", "aircraft_on_ground data_out_of_range data_missing");
    const int named = series("QUALITY", NC_INT, {0, 7, 0, 7});
    file.numbers(named, "flag_values", NC_INT, {0, 7});
    file.text(named, "flag_meanings", "NOT_missing BAD");
    const int harmless = series("HARMLESS_FLAG", NC_BYTE, {1, 1, 1, 1});
    file.numbers(harmless, "flag_values", NC_BYTE, {1});
    file.text(harmless, "flag_meanings", "badger_on_board");
  });
  EXPECT_THAT(read("VALUES"), ElementsAre(1, 2, IsNan(), 4));
  EXPECT_THAT(read("MASKS"), ElementsAre(1, IsNan(), IsNan(), IsNan()));
  EXPECT_THAT(read("NAMED"), ElementsAre(1, IsNan(), 3, IsNan()));
  EXPECT_THAT(read("HARMLESS"), ElementsAre(1, 2, 3, 4));
  const Flight flight(path());
  EXPECT_THAT(flight.variable("NAMED").flags, ElementsAre("QUALITY"));
  EXPECT_THAT(flight.variable("HARMLESS").flags, testing::IsEmpty());
}

TEST_F(FlightTest, FlagsOfAnyTypeAreInterpreted) {
  make({0, 1, 2, 3}, [&](NetcdfMaker& file) {
    const int fast = file.dimension("sps2", 2);
    const auto flagged = [&](const std::string& name, int type, const std::vector<double>& flags,
                             const std::vector<double>& masks) {
      file.values(file.variable(name, NC_FLOAT, {file.time_dimension}), {1, 2, 3, 4});
      const int variable = file.variable(name + "_FLAG", type, {file.time_dimension});
      file.values(variable, flags);
      file.numbers(variable, "flag_masks", type == NC_INT64 ? NC_DOUBLE : NC_BYTE, masks);
      file.text(variable, "flag_meanings", "late bad");
      return variable;
    };
    flagged("UNSIGNED", NC_UBYTE, {1, 128, 129, 2}, {1, -128});
    file.text(flagged("MARKED", NC_BYTE, {1, -128, -127, 2}, {1, -128}), "_Unsigned", "true");
    file.numbers(flagged("FILLED", NC_BYTE, {-127, 0, 1, 3}, {2, 1}), "missing_value", NC_BYTE, {-127});
    flagged("EMPTY", NC_BYTE, {0, 1, 2, 3}, {1, 0});
    flagged("HUGE", NC_INT64, {0, 1, 2, 3}, {1, 1e300});
    flagged("WIDE", NC_INT64, {1, 2, 3, -2}, {1, 2});
    flagged("REAL", NC_DOUBLE, {1, 2, 3, 2.5}, {1, 2});
    file.values(file.variable("FAST", NC_FLOAT, {file.time_dimension, fast}), {1, 2, 3, 4, 5, 6, 7, 8});
    const int of_records = file.variable("FAST_FLAG", NC_INT, {file.time_dimension});
    file.values(of_records, {0, 1, 0, 1});
    file.numbers(of_records, "flag_values", NC_INT, {0, 1});
    file.text(of_records, "flag_meanings", "good bad");
  });
  EXPECT_THAT(read("UNSIGNED"), ElementsAre(1, IsNan(), IsNan(), 4));
  EXPECT_THAT(read("MARKED"), ElementsAre(1, IsNan(), IsNan(), 4));
  EXPECT_THAT(read("FILLED"), ElementsAre(1, 2, IsNan(), IsNan())) << "no flag is stored where the fill is";
  EXPECT_THAT(read("EMPTY"), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(read("HUGE"), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(read("WIDE"), ElementsAre(1, IsNan(), IsNan(), 4)) << "a negative number has no bits";
  EXPECT_THAT(read("REAL"), ElementsAre(1, IsNan(), IsNan(), 4)) << "neither has a fraction";
  EXPECT_THAT(read("FAST"), ElementsAre(1, 2, IsNan(), IsNan(), 5, 6, IsNan(), IsNan()));
}

TEST_F(FlightTest, RequiredVariableWithoutValuesIsAnError) {
  make({100, 101}, [&](NetcdfMaker& maker) {
    maker.series("PSFD", "hPa", {-32767, -32767});
    maker.series("QCF", "hPa", {-32767, 3});
  });
  const Flight flight(path());
  EXPECT_THAT(error_of([&] { flight.require_values("PSFD"); }), IsError(Error::Code::variable, "PSFD", "2"));
  EXPECT_NO_THROW(flight.require_values("QCF"));
}

TEST_F(FlightTest, UnitsAreConvertedByTheUnitsAttribute) {
  make({100, 101}, [&](NetcdfMaker& maker) {
    maker.series("ATX", std::string("C\0", 2), {10, -32767});
    maker.series("PSF", "", {850, 851});
    maker.series("ODD", "furlong-ish", {1, 2});
  });
  const Flight flight(path());
  EXPECT_THAT(read("ATX", "K"), ElementsAre(DoubleEq(283.15), IsNan()));
  EXPECT_THAT(error_of([&] { flight.conversion("PSF", "hPa", "static_pressure"); }),
              IsError(Error::Code::unit, "PSF", "unit.static_pressure = \"hPa\"", "[units]"));
  EXPECT_THAT(error_of([&] { flight.conversion("ODD", "hPa", "static_pressure"); }),
              IsError(Error::Code::unit, "ODD", "furlong-ish"));
  EXPECT_THAT(error_of([&] { flight.conversion("ATX", "hPa", "static_pressure"); }),
              IsError(Error::Code::unit, "ATX", "C", "hPa"));
  EXPECT_EQ(flight.conversion("PSF", "hPa", "static_pressure", "kPa")(85), 850)
      << "the unit that a model file states";
}

TEST_F(FlightTest, PackedIntegersAreUnpacked) {
  make({100, 101}, [&](NetcdfMaker& maker) {
    const int number = maker.variable("PACKED", NC_SHORT, {maker.time_dimension});
    maker.numbers(number, "scale_factor", NC_DOUBLE, {0.5});
    maker.numbers(number, "add_offset", NC_DOUBLE, {100});
    maker.numbers(number, "_FillValue", NC_SHORT, {-1});
    maker.values(number, {10, -1});
  });
  EXPECT_THAT(read("PACKED"), ElementsAre(105, IsNan()));
}

TEST_F(FlightTest, OtherVariablesAreListedAndRefused) {
  make({100}, [&](NetcdfMaker& maker) {
    const int sps1 = maker.dimension("sps1", 1), bins = maker.dimension("Vector64", 64);
    maker.variable("CDP", NC_FLOAT, {maker.time_dimension, sps1, bins});
    maker.variable("WORDS", NC_CHAR, {maker.time_dimension});
    maker.variable("ONE", NC_FLOAT, {maker.time_dimension, sps1});
  });
  const Flight flight(path());
  EXPECT_THAT(flight.variables(), ElementsAre("Time", "CDP", "WORDS", "ONE"));
  EXPECT_FALSE(flight.variable("CDP").is_series);
  double value = 0;
  EXPECT_THAT(error_of([&] {
                flight.read("CDP", {0, 1}, {}, &value);
              }),
              IsError(Error::Code::variable, "CDP(Time, sps1, Vector64)"));
  EXPECT_THAT(error_of([&] {
                flight.read("WORDS", {0, 1}, {}, &value);
              }),
              IsError(Error::Code::variable, "WORDS(Time)"));
  EXPECT_EQ(flight.variable("ONE").rate, 1);
}

// netCDF cache settings apply to the variables being read, not to all files of the program that links the
// library.
TEST_F(FlightTest, ChunkCacheOfTheProgramIsUnchanged) {
  make_with_times({0, 1, 2});
  const auto cache = [] {
    std::size_t bytes = 0, slots = 0;
    float preemption = 0;
    nc_get_chunk_cache(&bytes, &slots, &preemption);
    return std::make_tuple(bytes, slots, preemption);
  };
  const auto before = cache();
  times();
  EXPECT_EQ(cache(), before);
}

TEST_F(FlightTest, ABlockBeyondTheEndIsRefused) {
  make_with_times({100, 101});
  double values[3];
  EXPECT_THAT(error_of([&] {
                Flight(path()).read("Time", {1, 2}, {}, values);
              }),
              IsError(Error::Code::usage, "Time", "1 to 3", "2"));
}

// Rates

TEST_F(FlightTest, VariablesOfDifferentRatesAreRead) {
  make({100, 101}, [&](NetcdfMaker& maker) {
    maker.series("SLOW", "hPa", {1, 2});
    maker.series("FAST", "hPa", {1, 2, -32767, 6, -32767, -32767, -32767, -32767}, 4);
  });
  const Flight flight(path());
  EXPECT_EQ(flight.variable("SLOW").rate, 1);
  EXPECT_EQ(flight.variable("FAST").rate, 4);
  const auto at = [&](int rate, const char* name) {
    std::vector<double> values(static_cast<std::size_t>(2 * rate));
    flight.read_at_rate(rate, name, {0, 2}, {}, values.data());
    return values;
  };
  EXPECT_THAT(at(4, "SLOW"), ElementsAre(1, 1, 1, 1, 2, 2, 2, 2)) << "held constant within its record";
  EXPECT_THAT(at(1, "FAST"), ElementsAre(3, IsNan())) << "the mean of the existing samples";
  EXPECT_THAT(at(2, "FAST"), ElementsAre(1.5, 6, IsNan(), IsNan()));
  EXPECT_THAT(at(4, "FAST"), ElementsAre(1, 2, IsNan(), 6, IsNan(), IsNan(), IsNan(), IsNan()));
  EXPECT_THAT(error_of([&] { at(3, "FAST"); }),
              IsError(Error::Code::samples, "FAST", "4 samples", "1 samples"));
  EXPECT_THAT(error_of([&] { at(6, "FAST"); }), IsError(Error::Code::samples, "FAST", "4", "6"));
}

TEST_F(FlightTest, AnglesAreAveragedOnTheCircle) {
  make({100, 101, 102}, [&](NetcdfMaker& maker) {
    const std::vector<double> degrees{350, 10, 340, 360, 90, 270};
    const int heading = maker.series("THDG", "deg", degrees, 2);
    maker.numbers(heading, "modulus_range", NC_FLOAT, {0, 360});
    const int longitude = maker.series("LON", "deg", {179, -179, 10, 20, -179, 177}, 2);
    maker.numbers(longitude, "modulus_range", NC_FLOAT, {-180, 180});
  });
  const Flight flight(path());
  double values[3];
  flight.read_at_rate(1, "THDG", {0, 3}, {}, values);
  EXPECT_NEAR(std::remainder(values[0], 360), 0, 1e-9);
  EXPECT_NEAR(values[1], 350, 1e-9);
  EXPECT_THAT(values[2], IsNan()) << "opposite directions have no mean";
  flight.read_at_rate(1, "LON", {0, 3}, {}, values);
  EXPECT_NEAR(std::abs(values[0]), 180, 1e-9);
  EXPECT_NEAR(values[1], 15, 1e-9);
  EXPECT_NEAR(values[2], 179, 1e-9);
}

TEST_F(FlightTest, BlocksOfAnySizeGiveTheSame) {
  make_classic(sequence(0, 100),
               [&](NetcdfMaker& maker) { maker.series("PSFD", "hPa", sequence(500, 500), 5); });
  const Flight flight(path());
  for (const std::size_t size : {1U, 7U, 100U, 1000U}) {
    std::vector<double> all(500);
    for (const RecordBlock block : pcor::blocks_of(flight.records(), size))
      flight.read("PSFD", block, {}, all.data() + 5 * block.first);
    EXPECT_EQ(all, sequence(500, 500)) << size;
  }
}

TEST_F(FlightTest, BlocksHoldEachRecordOnceAndReadContiguously) {
  constexpr std::size_t records = 5000;
  const auto max_block = [&](int mode, int rate) {
    {
      NetcdfMaker maker(path(), mode);
      maker.time(sequence(0, records));
      maker.series("PSFD", "hPa", std::vector<double>(records * static_cast<std::size_t>(rate), 800.0), rate);
    }
    const Flight flight(path());
    std::size_t next = 0;
    std::size_t longest = 0;
    for (const RecordBlock block : flight.blocks()) {
      EXPECT_EQ(block.first, next);
      next += block.count;
      longest = std::max(longest, block.count);
    }
    EXPECT_EQ(next, records);
    return longest;
  };
  EXPECT_EQ(max_block(NC_NETCDF4, 1000), pcor::records_per_block);
  EXPECT_EQ(max_block(0, 1), pcor::records_per_block);
  // Records of 4,004 bytes: the number in a buffer of 1 MiB, for any position of the first record in the
  // buffer.
  const std::size_t together = max_block(0, 1000);
  EXPECT_LT(together * 4004, std::size_t{1} << 20);
  EXPECT_GT(together * 4004, std::size_t{1} << 19);
}

// The real thing

TEST(RealFlight, FlightOfJuly2004IsRead) {
  const char* flights = std::getenv("PCOR_FLIGHTS");
  if (flights == nullptr) GTEST_SKIP() << "set PCOR_FLIGHTS to the directory of the reference flights";
  const Flight flight(std::filesystem::path(flights) / "GOTEX-rf06-C130-2004.nc");
  EXPECT_EQ(flight.records(), 3061);
  EXPECT_EQ(utc_text(flight.time().first), "2004-02-18 14:22:00");
  EXPECT_EQ(utc_text(flight.time().last), "2004-02-18 15:13:00");
  EXPECT_EQ(flight.time().gap_count, 0);
  EXPECT_EQ(flight.aircraft(), "N130AR");
  EXPECT_EQ(flight.project(), "Ocean Waves");
  EXPECT_EQ(flight.flight_number(), "rf06");
  EXPECT_THAT(error_of([&] { flight.variable("VLAMS"); }), IsError(Error::Code::variable, "VLAMS"));
  for (const std::string& name : flight.variables()) {
    const pcor::VariableInfo& info = flight.variable(name);
    EXPECT_TRUE(info.units.empty() || pcor::is_known_unit(info.units)) << name << " " << info.units;
  }

  // Total pressure of the two systems: slope 0.99989, offset -0.05 hPa, rms 0.088 in flight.
  const std::size_t records = flight.records();
  std::vector<std::vector<double>> values;
  for (const char* name : {"PSFD", "QCF", "PSFRD", "QCFR"}) values.push_back(values_of(flight, name, "hPa"));
  const std::vector<double> airspeed = values_of(flight, "TASX", "m/s");
  double squares = 0;
  int samples = 0;
  for (std::size_t i = 0; i < records; ++i) {
    if (!(airspeed[i] > 50)) continue;
    const double first = values[0][i] + values[1][i], second = values[2][i] + values[3][i];
    const double residual =
        std::min(std::abs(second - (0.99989 * first - 0.05)), std::abs(first - (0.99989 * second - 0.05)));
    squares += residual * residual;
    ++samples;
  }
  EXPECT_GT(samples, 2000);
  EXPECT_LT(std::sqrt(squares / samples), 0.12);
}

}  // namespace
