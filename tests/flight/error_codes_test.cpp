// Error codes that programs can use without parsing the message.
#include <gmock/gmock.h>
#include <pcor/base/error.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/units/units.hpp>

#include <string>

using pcor::Error;
using testing::Property;
using testing::Throws;

namespace {

auto has_code(Error::Code code) { return Throws<Error>(Property(&Error::code, code)); }

}  // namespace

TEST(Error, SaysWhatKindOfThingFailed) {
  EXPECT_THAT([] { throw Error("a sentence"); }, has_code(Error::Code::other));
  EXPECT_THAT([] { pcor::UnitConversion::between("m", "s", {}); }, has_code(Error::Code::unit));
  EXPECT_THAT([] { pcor::UnitConversion::between("", "s", {}); }, has_code(Error::Code::unit));
  EXPECT_THAT([] { const pcor::Flight flight("no-such-file.nc"); }, has_code(Error::Code::file));
}
