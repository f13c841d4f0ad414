// Error codes that programs can use without parsing the message.
#include <gmock/gmock.h>
#include <pcor/base/error.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/units/units.hpp>

#include <set>
#include <string_view>

#include "support/error_of.hpp"

using pcor::Error;
using pcor::test::error_of;
using pcor::test::IsError;

TEST(Error, HasACode) {
  EXPECT_THAT(error_of([] { pcor::UnitConversion::between("m", "s", {}); }), IsError(Error::Code::unit));
  EXPECT_THAT(error_of([] { pcor::UnitConversion::between("", "s", {}); }), IsError(Error::Code::unit));
  EXPECT_THAT(error_of([] { const pcor::Flight flight("no-such-file.nc"); }), IsError(Error::Code::file));
}

TEST(Error, CodesHaveDifferentNames) {
  std::set<std::string_view> names;
  for (int code = 0; code <= static_cast<int>(Error::Code::system); ++code)
    names.insert(to_string(static_cast<Error::Code>(code)));
  EXPECT_EQ(names.size(), static_cast<std::size_t>(Error::Code::system) + 1);
}
