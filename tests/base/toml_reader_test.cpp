#include "base/toml_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include <pcor/base/error.hpp>

#include "support/error_of.hpp"

namespace pcor::internal {
namespace {

TEST(MomentIn, AcceptsOnlyAnIsoDate) {
  EXPECT_EQ(moment_in<toml::date>("2012-02-29"), (toml::date{2012, 2, 29}));
  for (const char* text :
       {"2011-02-29", "2011-13-01", "2011-11-00", "2011-11-2", " 2011-11-02", "2011-11-02 ",
        "2011-11-02T20:00:00", "2011-11-02\nx = 1", "2011-11-02 # day", "2011", "-", ""}) {
    EXPECT_FALSE(moment_in<toml::date>(text)) << text;
  }
}

TEST(MomentIn, AcceptsOnlyAnIsoTime) {
  EXPECT_EQ(moment_in<toml::time>("20:10:00.5"), (toml::time{20, 10, 0, 500000000}));
  for (const char* text :
       {"24:00:00", "20:60:00", "20:10:61", "8:00:00", "20:10:00.", "2011-11-02", "20.10"}) {
    EXPECT_FALSE(moment_in<toml::time>(text)) << text;
  }
}

// Rules common to all readers.
struct AnyReader final : TomlReader {
  AnyReader() : TomlReader("some.toml") {}
  using TomlReader::parse;

  // The values of a = ..., b = ... and c = ..., of which b is required.
  std::vector<std::int64_t> values(const std::string& text) const {
    std::vector<std::int64_t> all;
    const Action read = [&](const Entry& entry) { all.push_back(whole_number(entry)); };
    each(parse(text), "", {{"a", read}, {"b", read}, {"c", read}}, {{"b", "there is no b"}});
    return all;
  }
};

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  for (std::size_t i = 0; i < times; ++i) all += text;
  return all;
}

TEST(TomlReader, NetcdfFileIsNamed) {
  for (const char* text : {"CDF\x01 and more", "\x89HDF\r\n"}) {
    EXPECT_THAT(test::error_of([&] { AnyReader().parse(text); }),
                test::IsError(Error::Code::definition, "some.toml:1:1"));
  }
}

// Beyond, toml++ overflows the stack: at 20000 tables in each other.
TEST(TomlReader, RefusesDeeplyNestedKeys) {
  EXPECT_NO_THROW(AnyReader().parse(repeated("a.", 16) + "a = 1"));
  for (const std::size_t dots : {17U, 100000U}) {
    for (const std::string& key :
         {repeated("a.", dots) + "a", repeated("\"a#\".", dots) + "a", repeated("'a' . ", dots) + "a"}) {
      for (const std::string& text :
           {"x = 1\n" + key + " = 1", "\n[" + key + "]", "\nx = {" + key + " = 1}"}) {
        EXPECT_THAT(test::error_of([&] { AnyReader().parse(text); }),
                    test::IsError(Error::Code::definition, "some.toml:2:1", "16"));
      }
    }
  }
}

TEST(TomlReader, DotsOutsideKeysAreAccepted) {
  const std::string dots(100, '.');
  EXPECT_NO_THROW(AnyReader().parse("# isn't " + dots + "\na = \"\\\"" + dots + "\" # it's " + dots +
                                    "\nb = '" + dots + "'\nc = \"\"\"\"\n" + dots + "\"\"\"\nd = [" +
                                    repeated("1.5, ", 100) + "]"));
}

TEST(TomlReader, RefusesTooManyEntries) {
  EXPECT_NO_THROW(AnyReader().parse("a = [" + repeated("1, ", 10000) + "]"));
  EXPECT_THAT(test::error_of([&] { AnyReader().parse("\nb = [[" + repeated("1, ", 10001) + "]]"); }),
              test::IsError(Error::Code::definition, "some.toml:2:6", "10001", "10000"));
  EXPECT_THAT(test::error_of([&] { AnyReader().parse(repeated("[[leg]]\n", 10001)); }),
              test::IsError(Error::Code::definition, "10001"));
}

TEST(TomlReader, KeysAreReadInTheirOrder) {
  EXPECT_EQ(AnyReader().values("c = 3\nb = 2\na = 1\n"), (std::vector<std::int64_t>{1, 2, 3}));
  EXPECT_EQ(AnyReader().values("b = 2\n"), std::vector<std::int64_t>{2});
}

TEST(TomlReader, FirstErrorIsUnknownKeyThenInOrder) {
  const auto error = [](const std::string& text) {
    return test::error_of([&] { AnyReader().values(text); });
  };
  const auto code = Error::Code::definition;
  EXPECT_THAT(error("c = 'c'\nb = 'b'\nd = 1\ne = 1\n"), test::IsError(code, "some.toml:3:1"));
  EXPECT_THAT(error("c = 'c'\nb = 'b'\n"), test::IsError(code, "some.toml:2:5"));
  for (const char* text : {"c = 'c'\n", "c = 'c'\nb = ''\n", "c = 'c'\nb = []\n"})
    EXPECT_THAT(error(text), test::IsError(code, "some.toml:1:1"));
}

TEST(Seconds, AreContinuousAcrossDays) {
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
