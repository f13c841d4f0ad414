// Text files of the ICARTT conventions as flights.
#include <gmock/gmock.h>

#include <fstream>
#include <string>

#include <pcor/base/error.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/flight/flight_writer.hpp>
#include "flight/flight_file.hpp"
#include "support/error_of.hpp"
#include "support/says.hpp"
#include "support/temporary_directory.hpp"
#include "support/values_of.hpp"

namespace pcor::internal {
namespace {

using test::values_of;
using testing::AllOf;
using testing::DoubleEq;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsNan;
using testing::Not;

const std::string head =
    "24, 1001, V02_2016\r\nDoe, Jane\nTheir laboratory\nN/A\nMISSION\n1, 1\n2018, 11, 04, 2019, 05, 13\n1\n"
    "Time_Start, seconds\n3\n1, 0.1, 1\n-9999, -9999, -9999\n"
    "static_pressure, hPa\ndynamic_pressure, hPa, Pressure_dynamic, dynamic pressure of the boom\nmach, N/A\n"
    "1\na special comment\n6\nPLATFORM: N701BN\nLLOD_FLAG: -8888\nno/name: of an attribute\nULOD_FLAG: "
    "-7777\n"
    "REVISION: R0\nTime_Start,static_pressure,dynamic_pressure,mach\n";

class Icartt : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return path_;
  }

  test::TemporaryDirectory folder_;
  std::filesystem::path path_ = folder_.path() / "flight.ict";
};

const std::string value_lines = "47076, 850, 300, 0.3\n47077,-9999,-8888, 0.31\r\n47078, 852.5, 310, -7777\n";

TEST_F(Icartt, IsReadAsAFlight) {
  const Flight flight(write(head + value_lines));
  EXPECT_EQ(flight.records(), 3U);
  EXPECT_EQ(flight.time().first, 1541289600.0 + 47076.0) << "the midnight of 2018-11-04";
  EXPECT_EQ(flight.aircraft(), "N701BN");
  EXPECT_EQ(flight.project(), "MISSION");
  EXPECT_EQ(flight.attribute("institution"), "Their laboratory");
  EXPECT_EQ(flight.variable("mach").units, "N/A");
  EXPECT_EQ(flight.variable("dynamic_pressure").long_name, "dynamic pressure of the boom");
  EXPECT_THAT(values_of(flight, "static_pressure"), ElementsAre(850, IsNan(), 852.5));
  EXPECT_THAT(values_of(flight, "dynamic_pressure"), ElementsAre(DoubleEq(30), IsNan(), DoubleEq(31)));
  EXPECT_THAT(values_of(flight, "mach"), ElementsAre(0.3, 0.31, IsNan()));
}

TEST_F(Icartt, IsCopiedToNetcdf) {
  const std::filesystem::path output = folder_.path() / "out.nc";
  const Flight flight(write(head + value_lines));
  FlightWriter writer(output, flight, {});
  writer.copy("static_pressure");
  writer.finish();
  EXPECT_THAT(values_of(Flight(output), "static_pressure"), ElementsAre(850, IsNan(), 852.5));
  EXPECT_EQ(Flight(output).time().first, flight.time().first);
  for (const char* name : {"institution", "project", "PLATFORM", "REVISION"})
    EXPECT_THAT(Flight(output).attribute(name), AllOf(Not(IsEmpty()), flight.attribute(name)));
}

TEST_F(Icartt, ErrorNamesTheLine) {
  const auto refusal = [this](const std::string& text) {
    write(text);
    return test::error_of([this] { Flight flight(path_); });
  };
  EXPECT_THAT(refusal(head + value_lines + "47079, 850\n"),
              test::IsError(Error::Code::file, "flight.ict:28", "4"));
  EXPECT_THAT(refusal(head + "47076, 850, , 0.3\n"), test::IsError(Error::Code::file, "flight.ict:25", "4"))
      << "a blank was read as 0";
  EXPECT_THAT(refusal(head + "47076, 850, x, 0.3\n"), test::IsError(Error::Code::file, "flight.ict:25", "4"));
  EXPECT_THAT(refusal("25, 2110\n"), test::IsError(Error::Code::file, "flight.ict:1", "2110"));
  EXPECT_THAT(refusal("25, 1001\nDoe\n"), test::IsError(Error::Code::file, "flight.ict:3"));
  EXPECT_THAT(refusal("23" + head.substr(2) + value_lines), test::IsError(Error::Code::file, "23"));
  EXPECT_THAT(refusal(head), test::IsError(Error::Code::samples, "flight.ict"));
  EXPECT_THAT(refusal("70 people"), test::IsError(Error::Code::file, "flight.ict"));
}

// Further fields were dropped, and with decimal commas the numbers were those of other variables.
TEST_F(Icartt, OtherNumberOfFieldsIsRefused) {
  const auto refusal = [this](const std::string& text) {
    write(text);
    return test::error_of([this] { Flight flight(path_); });
  };
  const auto with_head = [](const std::string& old, const std::string& other) {
    std::string text = head + value_lines;
    return text.replace(text.find(old), old.size(), other);
  };
  EXPECT_THAT(refusal(head + value_lines + "47079, 850, 300, 0.3, 5, 6\n"),
              test::IsError(Error::Code::file, "flight.ict:28", "4", "6"));
  EXPECT_THAT(refusal(head + "47076,850,12,300,05,0,3\n" + value_lines),
              test::IsError(Error::Code::file, "flight.ict:25", "4", "7"));
  EXPECT_THAT(refusal(with_head("1, 0.1, 1", "1, 1, 0.1, 1")),
              test::IsError(Error::Code::file, "flight.ict:11", "3", "4"));
  EXPECT_THAT(refusal(with_head("-9999, -9999, -9999", "-9999, -9999, -9999, -8888")),
              test::IsError(Error::Code::file, "flight.ict:12", "3", "4"));
}

TEST_F(Icartt, CommaAfterTheLastFieldIsNoField) {
  EXPECT_THAT(values_of(Flight(write(head + "47076, 850, 300, 0.3, \r\n47077, 851, 300, 0.4,\n")), "mach"),
              ElementsAre(0.3, 0.4));
}

TEST_F(Icartt, TruncatedLastRecordIsDroppedAndReported) {
  // 0.35 may be 0.359, and a record of two numbers has lost two.
  for (const char* const cut : {"47079, 850, 300, 0.35", "47079, 850"}) {
    const Flight flight(write(head + value_lines + cut));
    EXPECT_EQ(flight.records(), 3U);
    EXPECT_THAT(flight.file().notes(), ElementsAre(test::Says("line 28 of flight.ict")));
  }
  EXPECT_TRUE(Flight(write(head + value_lines)).file().notes().empty());
}

TEST_F(Icartt, CompleteLastRecordWithoutLineEndIsKept) {
  // All last fields have two decimals, or are flags; a cut would leave fewer.
  const std::string fixed = "47076, 850, 300, 0.30\n47077, 850, 300, -9999\n47078, 851, 300, 0.31\n";
  const Flight whole(write(head + fixed + "47079, 850, 300, 0.35"));
  EXPECT_EQ(whole.records(), 4U);
  EXPECT_EQ(values_of(whole, "mach").back(), 0.35);
  EXPECT_TRUE(whole.file().notes().empty());
  for (const char* const cut : {"47079, 850, 300, 0.3", "47079, 850, 300, 0.", "47079, 850, 300,",
                                "47079, 850, 0.35", "47079, 850, 0.35,"}) {
    const Flight flight(write(head + fixed + cut));
    EXPECT_EQ(flight.records(), 3U) << cut;
    EXPECT_EQ(flight.file().notes().size(), 1U) << cut;
  }
  // Whole numbers have two or three digits, so 31 may be 310 without its end.
  EXPECT_EQ(Flight(write(head + "47076, 1, 1, 31\n47077, 1, 1, 310\n47078, 1, 1, 31")).records(), 2U);
}

TEST_F(Icartt, CompressedFileErrorSuggestsGunzip) {
  path_ = folder_.path() / "flight.ict.gz";
  write("\x1f\x8b");
  EXPECT_THAT(test::error_of([this] { Flight flight(path_); }),
              test::IsError(Error::Code::file, "gunzip -k"));
}

}  // namespace
}  // namespace pcor::internal
