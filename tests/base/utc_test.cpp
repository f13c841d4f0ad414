#include <pcor/base/utc.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace pcor {
namespace {

TEST(UtcText, FormatsSecondsAsDateAndTime) {
  EXPECT_EQ(utc_text(1077114120.9), "2004-02-18 14:22:00");
  EXPECT_EQ(utc_text(-1.0), "1969-12-31 23:59:59");
  EXPECT_EQ(utc_text(253402300799.0, "%Y-%m-%d"), "9999-12-31");
}

TEST(UtcText, UnrepresentableYearIsPrintedInSeconds) {
  EXPECT_EQ(utc_text(1e300), "1e+300 s after 1970-01-01");
  EXPECT_EQ(utc_text(-std::numeric_limits<double>::infinity()), "-inf s after 1970-01-01");
  EXPECT_EQ(utc_text(std::nan("")), "nan s after 1970-01-01");
}

}  // namespace
}  // namespace pcor
