#include "fit/warnings.hpp"

#include <gtest/gtest.h>

namespace pcor::internal {
namespace {

// Heights alone do not determine a constant defect: its error was 363 hPa on the GOTEX flight, and was
// written.
TEST(WhyWorse, ErrorBeyondAnyStaticDefectIsRefused) {
  RefitResult result;
  result.rms_before = result.rms = 0.3;
  result.defect_error = 9.0;
  EXPECT_EQ(why_worse(result, 0.3), "");
  result.defect_error = 11.0;
  EXPECT_NE(why_worse(result, 0.3), "");
}

}  // namespace
}  // namespace pcor::internal
