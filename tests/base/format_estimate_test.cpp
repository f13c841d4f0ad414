#include <pcor/base/format_estimate.hpp>

#include <gtest/gtest.h>

#include <limits>

using namespace pcor;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(FormatEstimate, ErrorHasTwoDigits) {
  EXPECT_EQ(format_estimate(0.01, 0.0046), "+0.0100 +- 0.0046");
  EXPECT_EQ(format_estimate(-0.53712, 0.0996), "-0.54 +- 0.10");
  EXPECT_EQ(format_estimate(12.3, 34.0), "+12 +- 34");
  EXPECT_EQ(format_estimate(-0.5, 0.012, PlusSign::always, "±"), "-0.500 ± 0.012");
  EXPECT_EQ(format_estimate(0.01, 0.0046, PlusSign::never), "0.0100 +- 0.0046");
  EXPECT_EQ(format_estimate(1e-9, 2e-10, PlusSign::never), "1e-09 +- 2e-10");
}

TEST(FormatEstimate, UnknownErrorIsOmitted) {
  EXPECT_EQ(format_estimate(0.5, nan), "+0.5");
  EXPECT_EQ(format_estimate(0.5, 0.0, PlusSign::never), "0.5");
  EXPECT_EQ(format_estimate(nan, 0.1), "unknown");
}

}  // namespace
