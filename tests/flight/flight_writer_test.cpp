#include <gmock/gmock.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <pcor/base/atomic_file.hpp>
#include <pcor/base/error.hpp>
#include <pcor/flight/flight_writer.hpp>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>

#include "flight/netcdf_file.hpp"
#include "support/constants.hpp"
#include "support/error_of.hpp"
#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

using pcor::Error;
using pcor::FileDescription;
using pcor::Flight;
using pcor::FlightWriter;
using pcor::NetcdfFormat;
using pcor::NewFlight;
using pcor::OutputVariable;
using pcor::RecordBlock;
using pcor::test::error_of;
using pcor::test::IsError;
using pcor::test::make_flight;
using pcor::test::midnight;
using pcor::test::missing;
using pcor::test::NetcdfMaker;
using pcor::test::sequence;
using testing::ElementsAre;
using testing::MatchesRegex;
using testing::NanSensitiveDoubleEq;
using testing::Pointwise;

namespace {

OutputVariable pressure(const std::string& name = "PSXC", int rate = 1) {
  OutputVariable variable;
  variable.name = name;
  variable.rate = rate;
  variable.units = "hPa";
  variable.long_name = "Static Pressure, Corrected";
  variable.standard_name = "air_pressure";
  variable.category = "Thermodynamic";
  variable.dependencies = {"PSFD", "QCF"};
  return variable;
}

NetcdfFormat kind_of(const std::filesystem::path& path) { return pcor::internal::NetcdfFile(path).kind(); }

std::string contents(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// Description of a written file by netcdf-cxx4. The variable "" has the global attributes.
class Written {
 public:
  explicit Written(const std::filesystem::path& path) : file_(path, netCDF::NcFile::read) {}

  netCDF::NcVar variable(const std::string& name) const {
    return name.empty() ? netCDF::NcVar(file_, NC_GLOBAL) : file_.getVar(name);
  }
  int type(const std::string& name) const { return variable(name).getType().getId(); }
  int attribute_type(const std::string& name, const std::string& attribute) const {
    return variable(name).getAtt(attribute).getType().getId();
  }
  std::string text(const std::string& name, const std::string& attribute) const {
    std::string value;
    variable(name).getAtt(attribute).getValues(value);
    return value;
  }
  std::vector<double> numbers(const std::string& name, const std::string& attribute) const {
    const auto attributes = variable(name).getAtts();
    const auto found = attributes.find(attribute);
    if (found == attributes.end()) return {};
    std::vector<double> values(found->second.getAttLength());
    found->second.getValues(values.data());
    return values;
  }
  std::vector<double> values(const std::string& name) const {
    std::size_t total = 1;
    for (const netCDF::NcDim& each : variable(name).getDims()) total *= each.getSize();
    std::vector<double> result(total);
    variable(name).getVar(result.data());
    return result;
  }
  std::vector<std::string> shape(const std::string& name) const {
    std::vector<std::string> names;
    for (const netCDF::NcDim& each : variable(name).getDims()) names.push_back(each.getName());
    return names;
  }

 private:
  netCDF::NcFile file_;
};

class FlightWriterTest : public testing::Test {
 protected:
  // Two systems, a scalar, a histogram with an extra dimension, and the oddities of old files.
  void make_input_of(int mode) const {
    NetcdfMaker maker(input, mode);
    maker.text(NC_GLOBAL, "Aircraft", std::string("N130AR\0", 7));
    maker.text(NC_GLOBAL, "ProjectName", "GOTEX");
    maker.text(NC_GLOBAL, "FlightNumber", "rf06");
    maker.text(NC_GLOBAL, "history", "2004: made");
    maker.numbers(NC_GLOBAL, "landmark", NC_FLOAT, {39.5, -105});
    maker.time({51720, 51721, 51722});
    const int statics = maker.series("PSFD", std::string("mbar\0", 5), {850, 851, -32767});
    maker.numbers(statics, "CalibrationCoefficients", NC_FLOAT, {0, 1});
    maker.series("QCF", "mbar", sequence(100, 12), 4);
    maker.series("TASX", "M/s", {100, 101, 102});
    const int counter = maker.variable("COUNT", NC_SHORT, {maker.time_dimension});
    maker.numbers(counter, "missing_value", NC_DOUBLE, {-9});
    maker.values(counter, {1, 2, -9});
    const int bins = maker.dimension("Vector3", 3), sps1 = maker.dimension("sps1", 1);
    const int histogram = maker.variable("CDP", NC_FLOAT, {maker.time_dimension, sps1, bins});
    maker.values(histogram, sequence(0, 9));
    const int base = maker.variable("base_time", NC_INT, {});
    maker.values(base, {midnight + 51720});
    const int latitude = maker.series("GGLAT", "degree_N", {15.25, 15.5, -32767});
    maker.text(latitude, "standard_name", "latitude");
  }

  static void write_all(FlightWriter& writer, std::size_t variable, const std::vector<double>& values,
                        std::size_t records) {
    writer.write(variable, {0, records}, values.data());
  }

  static std::optional<Error> refusal(const std::filesystem::path& file) {
    return error_of([&] { FlightWriter(file, NewFlight{midnight}, {}); });
  }

  // Writes a long flight to `path` until an error occurs.
  static std::optional<Error> write_much(const std::filesystem::path& path, NetcdfFormat kind) {
    return error_of([&] {
      constexpr std::size_t records = 4096;
      FlightWriter writer(path, NewFlight{midnight, true, kind}, {});
      const std::size_t number = writer.define(pressure("PSXC", 25));
      const std::vector<double> values(records * 25, 850);
      for (std::size_t block = 0; block < 4; ++block) {
        const std::vector<double> times = sequence(midnight + static_cast<double>(block * records), records);
        writer.write_time_stamps({block * records, records}, times.data());
        writer.write(number, {block * records, records}, values.data());
      }
      writer.finish();
    });
  }

  pcor::test::TemporaryDirectory directory;
  const std::filesystem::path input = directory / "in.nc";
  const std::filesystem::path output = directory / "out.nc";
};

// Written content

TEST_F(FlightWriterTest, TimeAndVariablesFollowTheConventions) {
  FlightWriter writer(output, NewFlight{midnight + 86399}, {});
  const std::size_t slow = writer.define(pressure());
  const std::size_t fast = writer.define(pressure("QCXC", 4));
  OutputVariable quality;
  quality.name = "PCORFLAG";
  quality.long_name = "Quality";
  quality.flags = {{1, "missing_input"}, {4, "low_speed"}};
  const std::size_t flags = writer.define(quality);
  const std::vector<double> times{midnight + 86399, midnight + 86400};
  writer.write_time_stamps({0, 2}, times.data());
  write_all(writer, slow, {850.25, missing}, 2);
  write_all(writer, fast, sequence(1, 8), 2);
  write_all(writer, flags, {0, 5}, 2);
  writer.finish();

  const Written file(output);
  EXPECT_EQ(file.type("Time"), NC_INT);
  EXPECT_THAT(file.values("Time"), ElementsAre(86399, 86400))
      << "midnight is crossed without beginning again";
  EXPECT_EQ(file.text("Time", "units"), "seconds since 2004-02-18 00:00:00 +0000");
  EXPECT_EQ(file.text("Time", "standard_name"), "time");
  EXPECT_EQ(file.text("Time", "axis"), "T");
  EXPECT_EQ(file.text("Time", "calendar"), "standard");
  EXPECT_EQ(file.text("Time", "strptime_format"), "seconds since %F %T %z");
  EXPECT_TRUE(file.variable("Time").getDim(0).isUnlimited());

  EXPECT_EQ(file.type("PSXC"), NC_FLOAT);
  EXPECT_THAT(file.shape("PSXC"), ElementsAre("Time"));
  EXPECT_EQ(file.text("PSXC", "units"), "hPa");
  EXPECT_EQ(file.text("PSXC", "long_name"), "Static Pressure, Corrected");
  EXPECT_EQ(file.text("PSXC", "standard_name"), "air_pressure");
  EXPECT_EQ(file.text("PSXC", "Category"), "Thermodynamic");
  EXPECT_EQ(file.text("PSXC", "DataQuality"), "Preliminary");
  EXPECT_EQ(file.text("PSXC", "Dependencies"), "2 PSFD QCF");
  EXPECT_EQ(file.attribute_type("PSXC", "_FillValue"), NC_FLOAT);
  EXPECT_THAT(file.numbers("PSXC", "_FillValue"), ElementsAre(-32767));
  EXPECT_THAT(file.numbers("PSXC", "actual_range"), ElementsAre(850.25, 850.25));
  EXPECT_THAT(file.values("PSXC"), ElementsAre(850.25, -32767));

  EXPECT_THAT(file.shape("QCXC"), ElementsAre("Time", "sps4"));
  EXPECT_EQ(file.values("QCXC"), sequence(1, 8));
  EXPECT_THAT(file.numbers("QCXC", "actual_range"), ElementsAre(1, 8));

  EXPECT_EQ(file.type("PCORFLAG"), NC_INT);
  EXPECT_THAT(file.numbers("PCORFLAG", "flag_masks"), ElementsAre(1, 4));
  EXPECT_EQ(file.text("PCORFLAG", "flag_meanings"), "missing_input low_speed");
  EXPECT_THAT(file.values("PCORFLAG"), ElementsAre(0, 5));
}

TEST_F(FlightWriterTest, CopiesRecordsInBlocks) {
  make_input_of(0);
  const Flight flight(input);
  FileDescription description;
  description.latitude = "GGLAT";
  FlightWriter writer(output, flight, description);
  writer.copy("GGLAT");
  writer.copy_records({0, 1});
  writer.copy_records({1, 1});
  writer.finish();
  const Written file(output);
  EXPECT_THAT(file.values("GGLAT"), ElementsAre(15.25, 15.5, -32767));
  EXPECT_THAT(file.values("Time"), testing::SizeIs(flight.records()));
  EXPECT_THAT(file.numbers("", "geospatial_lat_min"), ElementsAre(15.25));
}

TEST_F(FlightWriterTest, WritesGlobalAttributes) {
  make_input_of(NC_NETCDF4);
  const Flight flight(input);
  FileDescription description;
  description.history = "pcor process in.nc";
  description.latitude = "GGLAT";
  description.attributes = {{"pcor_model", "C-130"}};
  FlightWriter writer(output, flight, description);
  writer.copy("GGLAT");
  writer.finish();

  const Written file(output);
  EXPECT_EQ(file.text("", "Conventions"), "CF-1.8 ACDD-1.3")
      << "the input does not claim the NCAR convention";
  EXPECT_THAT(file.text("", "history"), MatchesRegex("20..-..-..T..:..:..Z: pcor process in.nc\n2004: made"));
  EXPECT_THAT(file.text("", "date_created"), MatchesRegex("20..-..-..T..:..:..Z"));
  EXPECT_EQ(file.text("", "title"), "GOTEX rf06 N130AR");
  EXPECT_EQ(file.text("", "source"), "airborne observations");
  EXPECT_EQ(file.text("", "Aircraft"), "N130AR") << "trailing NUL removed";
  EXPECT_EQ(file.text("", "platform"), "N130AR");
  EXPECT_EQ(file.text("", "time_coverage_start"), "2004-02-18T14:22:00Z");
  EXPECT_EQ(file.text("", "time_coverage_end"), "2004-02-18T14:22:02Z");
  EXPECT_EQ(file.text("", "FlightDate"), "02/18/2004");
  EXPECT_EQ(file.text("", "TimeInterval"), "14:22:00-14:22:02");
  EXPECT_EQ(file.text("", "latitude_coordinate"), "GGLAT");
  EXPECT_EQ(file.text("", "pcor_model"), "C-130");
  EXPECT_THAT(file.numbers("", "landmark"), ElementsAre(39.5, -105));
  EXPECT_THAT(file.numbers("", "geospatial_lat_min"), ElementsAre(15.25));
  EXPECT_THAT(file.numbers("", "geospatial_lat_max"), ElementsAre(15.5));
}

TEST_F(FlightWriterTest, AVariableWithoutAnyValueHasNoRange) {
  for (const NetcdfFormat kind : {NetcdfFormat::classic, NetcdfFormat::netcdf4}) {
    FlightWriter writer(output, NewFlight{midnight, true, kind}, {});
    const std::size_t number = writer.define(pressure());
    writer.write_time_stamps({0, 1}, &midnight);
    write_all(writer, number, {missing}, 1);
    writer.finish();
    EXPECT_THAT(Written(output).numbers("PSXC", "actual_range"), ElementsAre());
    EXPECT_THAT(Written(output).values("PSXC"), ElementsAre(-32767));
  }
}

TEST_F(FlightWriterTest, ValuesOutsideFloatRangeAreMissing) {
  FlightWriter writer(output, NewFlight{midnight}, {});
  const std::size_t number = writer.define(pressure());
  const std::vector<double> times = sequence(midnight, 4);
  writer.write_time_stamps({0, 4}, times.data());
  const double infinity = std::numeric_limits<double>::infinity();
  write_all(writer, number, {1e300, infinity, -infinity, 3}, 4);
  writer.finish();
  EXPECT_THAT(Written(output).values("PSXC"), ElementsAre(-32767, -32767, -32767, 3));
}

TEST_F(FlightWriterTest, FractionalTimesAreKept) {
  {
    NetcdfMaker maker(input);
    maker.time({100.5, 101.5}, "seconds since 2004-02-18 00:00:00 +0000", NC_DOUBLE);
  }
  const Flight flight(input);
  FlightWriter(output, flight, {}).finish();
  EXPECT_EQ(Written(output).type("Time"), NC_DOUBLE);
  EXPECT_THAT(Written(output).values("Time"), ElementsAre(100.5, 101.5));
}

TEST_F(FlightWriterTest, CopiesAreIdenticalForEveryFileKind) {
  for (const int mode : {0, NC_64BIT_OFFSET, NC_64BIT_DATA, NC_NETCDF4, NC_NETCDF4 | NC_CLASSIC_MODEL}) {
    make_input_of(mode);
    {
      const Flight flight(input);
      FlightWriter writer(output, flight, {});
      for (const std::string& name : flight.variables()) writer.copy(name);
      const std::size_t number = writer.define(pressure());
      write_all(writer, number, {849, 850, 851}, 3);
      writer.finish();
      EXPECT_EQ(kind_of(output), kind_of(input)) << mode;
    }
    const Written before(input), after(output);
    for (const char* name : {"PSFD", "QCF", "TASX", "COUNT", "CDP", "base_time", "GGLAT", "Time"}) {
      EXPECT_EQ(after.type(name), before.type(name)) << name;
      EXPECT_EQ(after.shape(name), before.shape(name)) << name;
      EXPECT_EQ(after.values(name), before.values(name)) << name;
    }
    EXPECT_EQ(after.text("PSFD", "units"), "mbar") << "trailing NUL removed";
    EXPECT_EQ(after.text("TASX", "units"), "m/s") << "spelling of UDUNITS";
    EXPECT_EQ(after.text("TASX", "long_name"), "TASX") << "CF wants one";
    EXPECT_THAT(after.numbers("PSFD", "CalibrationCoefficients"), ElementsAre(0, 1));
    EXPECT_EQ(after.attribute_type("COUNT", "missing_value"), NC_SHORT) << "type of the variable";
    EXPECT_THAT(after.values("PSXC"), ElementsAre(849, 850, 851));
  }
}

TEST_F(FlightWriterTest, StringAttributesAreCopied) {
  make_flight(input, {100}, [](NetcdfMaker& maker) {
    const int number = maker.series("PSFD", "hPa", {850});
    const char* text[] = {"Static"};
    nc_put_att_string(maker.id(), number, "long_name", 1, text);
  });
  const Flight flight(input);
  FlightWriter writer(output, flight, {});
  writer.copy("PSFD");
  writer.finish();
  EXPECT_EQ(Flight(output).variable("PSFD").long_name, "Static");
}

TEST_F(FlightWriterTest, BlocksFormTheWholeFile) {
  constexpr std::size_t records = 2 * pcor::records_per_block + 3;
  for (const NetcdfFormat kind : {NetcdfFormat::classic, NetcdfFormat::netcdf4}) {
    FlightWriter writer(output, NewFlight{midnight, true, kind}, {});
    const std::size_t number = writer.define(pressure("PSXC", 5));
    const std::vector<double> times = sequence(midnight, records), values = sequence(0, 5 * records);
    for (const RecordBlock block : pcor::blocks_of(records, 1000)) {
      writer.write_time_stamps(block, times.data() + block.first);
      writer.write(number, block, values.data() + 5 * block.first);
    }
    writer.finish();
    const Flight flight(output);
    EXPECT_EQ(flight.records(), records);
    std::vector<double> read(5 * records);
    flight.read("PSXC", {0, records}, {}, read.data());
    EXPECT_EQ(read, values);
  }
}

// Mistakes of the caller

TEST_F(FlightWriterTest, RefusesAnExistingName) {
  make_input_of(NC_NETCDF4);
  const Flight flight(input);
  FlightWriter writer(output, flight, {});
  writer.copy("PSFD");
  EXPECT_TRUE(writer.has("PSFD"));
  EXPECT_FALSE(writer.has("PSXC"));
  EXPECT_THAT(error_of([&] { writer.define(pressure("PSFD")); }), IsError(Error::Code::usage, "PSFD"));
  EXPECT_THAT(error_of([&] { writer.copy("PSFD"); }), IsError(Error::Code::usage, "PSFD"));
  EXPECT_THAT(error_of([&] { writer.copy("PSFX"); }), IsError(Error::Code::variable, "PSFX", "PSFD"));
}

TEST_F(FlightWriterTest, IncompleteVariableIsAnError) {
  make_input_of(NC_NETCDF4);
  const Flight flight(input);
  {
    FlightWriter writer(output, flight, {});
    const std::size_t number = writer.define(pressure());
    write_all(writer, number, {1, 2}, 2);
    EXPECT_THAT(error_of([&] { writer.finish(); }), IsError(Error::Code::usage, "PSXC", "2 of 3"));
  }
  EXPECT_EQ(directory.entries(), 1) << "only the input remains";
}

TEST_F(FlightWriterTest, UncopyableVariablesAreReportedInAdvance) {
  make_flight(input, {100, 101}, [](NetcdfMaker& maker) {
    maker.series("PSFD", "hPa", {850, 851});
    maker.series("FAST", "hPa", sequence(1, 8), 4);
    const int bins = maker.dimension("Vector2", 2);
    maker.variable("SIDEWAYS", NC_FLOAT, {bins, maker.time_dimension});
    nc_type pair = NC_NAT;
    ASSERT_EQ(nc_def_compound(maker.id(), 8, "pair", &pair), NC_NOERR);
    ASSERT_EQ(nc_insert_compound(maker.id(), pair, "first", 0, NC_INT), NC_NOERR);
    ASSERT_EQ(nc_insert_compound(maker.id(), pair, "second", 4, NC_INT), NC_NOERR);
    maker.variable("PAIRS", pair, {maker.time_dimension});
    const int values[] = {1, 2};
    ASSERT_EQ(nc_put_att(maker.id(), NC_GLOBAL, "pair", pair, 1, values), NC_NOERR);
  });
  const Flight flight(input);
  FlightWriter writer(output, flight, {});
  EXPECT_TRUE(writer.can_copy("PSFD"));
  EXPECT_TRUE(writer.can_copy("FAST"));
  for (const char* name : {"PAIRS", "SIDEWAYS", "ABSENT"}) EXPECT_FALSE(writer.can_copy(name)) << name;
  EXPECT_THAT(error_of([&] { writer.copy("PAIRS"); }), IsError(Error::Code::variable, "PAIRS"));
  writer.copy("PSFD");
  writer.finish();
  EXPECT_THAT(Written(output).values("PSFD"), ElementsAre(850, 851));
  EXPECT_FALSE(FlightWriter(output, NewFlight{midnight}, {}).can_copy("PSFD")) << "there is no input";
}

// A division by the size of a record ended the program.
TEST_F(FlightWriterTest, VariableWithASecondUnlimitedDimensionOfLengthZeroIsCopied) {
  make_flight(input, {100, 101}, [](NetcdfMaker& maker) {
    maker.series("PSFD", "hPa", {850, 851});
    int bins = 0;
    ASSERT_EQ(nc_def_dim(maker.id(), "bins", NC_UNLIMITED, &bins), NC_NOERR);
    maker.variable("EMPTY", NC_FLOAT, {maker.time_dimension, bins});
  });
  const Flight flight(input);
  FlightWriter writer(output, flight, {});
  ASSERT_TRUE(writer.can_copy("EMPTY"));
  writer.copy("EMPTY");
  writer.copy("PSFD");
  writer.finish();
  EXPECT_THAT(Written(output).values("PSFD"), ElementsAre(850, 851));
}

/// HDF5 has attributes that netCDF does not write, such as a text for a missing number, optional filters,
/// and texts of a fixed length and long doubles, both of which netCDF assumes to be variable-length texts
/// and reads into a buffer that is too small.
TEST_F(FlightWriterTest, Hdf5OnlyFeatureIsReportedWithRemedy) {
  const Flight flight(PCOR_SOURCE_DIR "/tests/fuzz/seeds/flight/odd_hdf5.nc");
  FlightWriter writer(output, flight, {});
  EXPECT_THAT(error_of([&] { writer.copy("PSFD"); }),
              IsError(Error::Code::variable, "_FillValue", "PSFD", "ncatted -a _FillValue,PSFD,d,,"));
  for (const char* name : {"REMARKS", "LONG"}) EXPECT_FALSE(writer.can_copy(name)) << name;
  std::vector<double> values(flight.records());
  EXPECT_THAT(error_of([&] {
                flight.read_at_rate(1, "PACKED", {0, flight.records()}, {}, values.data());
              }),
              IsError(Error::Code::file, "PACKED", "nccopy -F none"));
}

TEST_F(FlightWriterTest, AttributeOutsideVariableTypeIsNamed) {
  {
    NetcdfMaker maker(input, 0);
    maker.time({100});
    const int number = maker.variable("STATE", NC_BYTE, {maker.time_dimension});
    const double marker = -32767.0;
    nc_put_att_double(maker.id(), number, "missing_value", NC_DOUBLE, 1, &marker);
  }
  const Flight flight(input);
  FlightWriter writer(output, flight, {});
  EXPECT_THAT(error_of([&] { writer.copy("STATE"); }),
              IsError(Error::Code::variable, "missing_value", "STATE", "ncatted -a missing_value,STATE,d,,"));
}

/// The library lists it and does not find it.
TEST_F(FlightWriterTest, NonTextAttributeNameIsReported) {
  {
    NetcdfMaker maker(input, 0);
    maker.time({100});
    maker.text(maker.series("PSFD", "hPa", {850}), "Category", "Pressure");
  }
  std::string bytes = contents(input);
  bytes[bytes.find("Category")] = '\xff';
  std::ofstream(input, std::ios::binary) << bytes;
  const Flight flight(input);
  FlightWriter writer(output, flight, {});
  EXPECT_THAT(error_of([&] { writer.copy("PSFD"); }), IsError(Error::Code::variable, "PSFD"));
}

TEST_F(FlightWriterTest, FlagsMustBeWholeNumbers) {
  FlightWriter writer(output, NewFlight{midnight}, {});
  OutputVariable quality;
  quality.name = "PCORFLAG";
  quality.flags = {{1, "missing_input"}};
  const std::size_t number = writer.define(quality);
  for (const double value : {0.5, missing, 1e10})
    EXPECT_THAT(error_of([&] {
                  writer.write(number, {7, 1}, &value);
                }),
                IsError(Error::Code::variable, "PCORFLAG", "record 7"));
}

TEST_F(FlightWriterTest, TimesMustIncrease) {
  FlightWriter writer(output, NewFlight{midnight}, {});
  const std::vector<double> times{midnight, midnight + 1, midnight + 1};
  EXPECT_THAT(error_of([&] {
                writer.write_time_stamps({0, 3}, times.data());
              }),
              IsError(Error::Code::time, "record 2"));
}

// Atomic output

TEST_F(FlightWriterTest, OutputExistsOnlyAfterFinish) {
  {
    FlightWriter writer(output, NewFlight{midnight}, {});
    writer.write_time_stamps({0, 1}, &midnight);
    EXPECT_FALSE(std::filesystem::exists(output));
  }
  EXPECT_EQ(directory.entries(), 0) << "an unfinished writer writes no file";
  FlightWriter writer(output, NewFlight{midnight}, {});
  writer.write_time_stamps({0, 1}, &midnight);
  writer.finish();
  EXPECT_TRUE(std::filesystem::exists(output));
  EXPECT_EQ(directory.entries(), 1);
}

TEST_F(FlightWriterTest, FailureKeepsTheExistingFile) {
  std::ofstream(output) << "old";
  std::filesystem::permissions(output,
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  {
    FlightWriter writer(output, NewFlight{midnight}, {});
    EXPECT_THAT(error_of([&] { writer.finish(); }), IsError(Error::Code::samples, output.string()));
  }
  EXPECT_EQ(contents(output), "old");
  FlightWriter writer(output, NewFlight{midnight}, {});
  writer.write_time_stamps({0, 1}, &midnight);
  EXPECT_EQ(contents(output), "old");
  writer.finish();
  EXPECT_EQ(Flight(output).records(), 1);
  EXPECT_EQ(std::filesystem::status(output).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
}

TEST_F(FlightWriterTest, ASymbolicLinkIsFollowed) {
  std::filesystem::create_symlink("real.nc", output);
  FlightWriter writer(output, NewFlight{midnight}, {});
  writer.write_time_stamps({0, 1}, &midnight);
  writer.finish();
  EXPECT_TRUE(std::filesystem::is_symlink(output));
  EXPECT_EQ(Flight(directory / "real.nc").records(), 1);
}

TEST_F(FlightWriterTest, UnfinishedOutputIsHiddenAndRemovedOnSignal) {
  for (const NetcdfFormat kind : {NetcdfFormat::classic, NetcdfFormat::netcdf4}) {
    std::ofstream(output) << "old";
    const NewFlight flight{midnight, true, kind};
    FlightWriter first(output, flight, {}), second(output, flight, {});
    EXPECT_EQ(directory.entries(), 3) << "each has its own";
    for (const auto& entry : std::filesystem::directory_iterator(directory.path()))
      EXPECT_THAT(entry.path().filename().string(),
                  MatchesRegex("(\\.out\\.nc\\..*\\.......\\.part|out\\.nc)"));
    pcor::remove_unfinished_files();
    EXPECT_EQ(directory.entries(), 1);
    EXPECT_EQ(contents(output), "old");
  }
}

TEST_F(FlightWriterTest, FinishedFileIsNotRemovedOnSignal) {
  FlightWriter writer(output, NewFlight{midnight}, {});
  writer.write_time_stamps({0, 1}, &midnight);
  writer.finish();
  pcor::remove_unfinished_files();
  EXPECT_EQ(Flight(output).records(), 1);
}

TEST_F(FlightWriterTest, UnfinishedFilesBeyondListLimitAreWritten) {
  std::vector<std::unique_ptr<pcor::AtomicFile>> files;
  for (int i = 0; i < 20; ++i)
    files.push_back(std::make_unique<pcor::AtomicFile>(directory / std::to_string(i)));
  for (const auto& file : files) file->commit();
  EXPECT_EQ(directory.entries(), 20);
  files.clear();
  EXPECT_EQ(directory.entries(), 20);
}

TEST_F(FlightWriterTest, NewFileHasDefaultPermissions) {
  pcor::AtomicFile file(output);
  file.commit();
  const auto other = directory / "other";
  std::ofstream(other).flush();
  EXPECT_EQ(std::filesystem::status(output).permissions(), std::filesystem::status(other).permissions());
}

TEST_F(FlightWriterTest, OutputNameMayHaveMaximumLength) {
  const auto longest = directory / std::string(255, 'n');
  pcor::AtomicFile(longest).commit();
  EXPECT_TRUE(std::filesystem::exists(longest));
}

TEST_F(FlightWriterTest, InputOrLinkToItAsOutputIsRefused) {
  make_input_of(0);
  const std::string before = contents(input);
  const auto hard = directory / "hard.nc", soft = directory / "soft.nc";
  std::filesystem::create_hard_link(input, hard);
  std::filesystem::create_symlink(input, soft);
  const Flight flight(input);
  for (const auto& same : {input, hard, soft, directory / "." / "in.nc"})
    EXPECT_THAT(error_of([&] { FlightWriter(same, flight, {}); }),
                IsError(Error::Code::usage, same.string()));
  EXPECT_EQ(contents(input), before);
  EXPECT_EQ(directory.entries(), 3);
}

// Outputs that cannot be written

TEST_F(FlightWriterTest, NonFileOutputIsRefused) {
  EXPECT_THAT(refusal(directory.path()), IsError(Error::Code::output, directory.path().string()));
  EXPECT_THAT(refusal("/dev/full"), IsError(Error::Code::output, "/dev/full"));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

TEST_F(FlightWriterTest, ErrorNamesAnAbsentDirectory) {
  EXPECT_THAT(refusal(directory / "absent" / "out.nc"),
              IsError(Error::Code::output, (directory / "absent" / "out.nc").string(),
                      "directory " + (directory / "absent").string()));
}

TEST_F(FlightWriterTest, ADirectoryThatCannotBeWrittenIsRefused) {
  EXPECT_THAT(refusal("/proc/out.nc"), IsError(Error::Code::output, "/proc/out.nc"));
  EXPECT_THAT(error_of([] { FlightWriter("", NewFlight{midnight}, {}); }), IsError(Error::Code::output));
}

TEST_F(FlightWriterTest, TimesBeyond32BitsAreUnchanged) {
  NetcdfMaker(input).time({51720, 3e9}, "seconds since 2004-02-18 00:00:00 +0000", NC_DOUBLE);
  const Flight flight(input);
  FlightWriter(output, flight, {}).finish();
  EXPECT_EQ(Flight(output).time().last, midnight + 3e9);
}

// Another program writes a new version of the flight while this one is read.
TEST_F(FlightWriterTest, ChangedInputIsRefusedAndOldOutputKept) {
  for (const int kind : {0, NC_NETCDF4}) {
    for (const bool renamed : {true, false}) {
      const auto make = [kind](const std::filesystem::path& path, double pressure) {
        NetcdfMaker maker(path, kind);
        maker.time(sequence(51720, 20));
        maker.series("PSFD", "hPa", std::vector<double>(20, pressure));
      };
      make(input, 850);
      make(directory / "new.nc", 700);
      std::ofstream(output) << "old";
      const Flight flight(input);
      FlightWriter writer(output, flight, {});
      writer.copy("PSFD");
      if (renamed) {
        std::filesystem::rename(directory / "new.nc", input);
      } else {
        std::fstream(input, std::ios::binary | std::ios::in | std::ios::out)
            << contents(directory / "new.nc");
      }
      EXPECT_THAT(error_of([&] { writer.finish(); }), IsError(Error::Code::file, input.string()));
      EXPECT_EQ(contents(output), "old");
    }
  }
}

TEST_F(FlightWriterTest, FileSizeLimitWritesNoOutput) {
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  std::ofstream(output) << "old";
  for (const NetcdfFormat kind : {NetcdfFormat::classic, NetcdfFormat::netcdf4}) {
    rlimit small = before;
    small.rlim_cur = 200000;
    setrlimit(RLIMIT_FSIZE, &small);
    const std::optional<Error> refused = write_much(output, kind);
    setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_THAT(refused, IsError(Error::Code::output, output.string()));
    EXPECT_EQ(contents(output), "old");
    EXPECT_EQ(directory.entries(), 1);
  }
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(write_much(output, NetcdfFormat::netcdf4), std::nullopt) << "and the next file is whole";
}

TEST_F(FlightWriterTest, FullDiskIsAnOutputError) {
  const auto disk = directory / "disk";
  std::filesystem::create_directory(disk);
  if (mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=300k") != 0)
    GTEST_SKIP() << "only root can mount the small disk that this test fills";
  for (const NetcdfFormat kind : {NetcdfFormat::classic, NetcdfFormat::netcdf4}) {
    EXPECT_THAT(write_much(disk / "out.nc", kind), IsError(Error::Code::output, (disk / "out.nc").string()));
    EXPECT_TRUE(std::filesystem::is_empty(disk));
  }
  umount2(disk.c_str(), MNT_DETACH);  // HDF5 keeps a file open that it could not complete
}

// The real thing

TEST_F(FlightWriterTest, ReferenceFlightIsCopiedCompletely) {
  const char* flights = std::getenv("PCOR_FLIGHTS");
  if (flights == nullptr) GTEST_SKIP() << "set PCOR_FLIGHTS to the directory of the reference flights";
  const Flight flight(std::filesystem::path(flights) / "GOTEX-rf06-C130-2004.nc");
  FlightWriter writer(output, flight, {});
  for (const std::string& name : flight.variables()) writer.copy(name);
  writer.finish();
  const Written before(flight.path()), after(output);
  for (const std::string& name : flight.variables())
    EXPECT_THAT(after.values(name), Pointwise(NanSensitiveDoubleEq(), before.values(name))) << name;
  EXPECT_EQ(Flight(output).time().first, flight.time().first);
  EXPECT_EQ(Flight(output).time().last, flight.time().last);
  EXPECT_EQ(kind_of(output), NetcdfFormat::classic);
}

}  // namespace
