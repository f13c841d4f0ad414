#include <gmock/gmock.h>
#include <udunits2.h>
#include <pcor/units/units.hpp>

#include <cerrno>
#include <new>
#include <string>

#include <pcor/base/error.hpp>
#include "support/of_library.hpp"

using pcor::test::of_library;

namespace {

std::string failing;  // the failing function of UDUNITS, if any
int reason = 0;       // errno that it leaves

bool fails(const char* name) {
  if (failing != name) return false;
  errno = reason;
  return true;
}

}  // namespace

// These functions replace the functions of the library.
extern "C" {

ut_unit* ut_parse(const ut_system* system, const char* text, ut_encoding encoding) {
  return fails("ut_parse") ? nullptr : of_library(&ut_parse, "ut_parse")(system, text, encoding);
}

int ut_are_convertible(const ut_unit* one, const ut_unit* other) {
  return fails("ut_are_convertible") ? 0 : of_library(&ut_are_convertible, "ut_are_convertible")(one, other);
}
}

namespace pcor {
namespace {

/// A unit that cannot be read for want of memory is not a wrong unit: its variable would be dropped.
TEST(FailingUnits, LibraryFailureIsNotReportedAsInvalidUnit) {
  EXPECT_TRUE(is_convertible("mbar", "hPa"));
  for (const char* const function : {"ut_parse", "ut_are_convertible"}) {
    failing = function;
    reason = ENOMEM;
    EXPECT_THROW(is_convertible("mbar", "hPa"), std::bad_alloc) << function;
    reason = 0;
    EXPECT_FALSE(is_convertible("mbar", "hPa")) << function;
  }
  failing.clear();
}

}  // namespace
}  // namespace pcor
