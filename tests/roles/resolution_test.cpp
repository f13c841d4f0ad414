#include "roles/resolution.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

namespace pcor::internal {
namespace {

std::vector<double> rounded_to(double step) {
  std::vector<double> values;
  for (int i = 0; i < 2000; ++i) {
    const double value = 800.0 + 150.0 * std::sin(0.01 * i);
    const double stored = step > 0.0 ? step * std::round(value / step) : value;
    values.push_back(static_cast<double>(static_cast<float>(stored)));
  }
  return values;
}

TEST(Resolution, EqualsTheRoundingStep) {
  EXPECT_NEAR(resolution_of(rounded_to(1.0)), 1.0, 1e-6);
  EXPECT_NEAR(resolution_of(rounded_to(0.1)), 0.1, 2e-3);
}

TEST(Resolution, IsZeroForFloatsOrTooFewValues) {
  EXPECT_LT(resolution_of(rounded_to(0.0)), 0.01);
  EXPECT_EQ(resolution_of({}), 0.0);
  EXPECT_EQ(resolution_of({1, 1, 1, 2}), 0.0) << "too few values";
}

}  // namespace
}  // namespace pcor::internal
