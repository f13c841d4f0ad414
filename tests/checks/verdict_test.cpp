#include "checks/verdict.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace pcor::internal;

namespace pcor {
namespace {

TEST(Verdict, WeighsSizeAndError) {
  EXPECT_EQ(judge({0.05, 0.1}, 0.3), CheckVerdict::consistent);
  EXPECT_EQ(judge({0.2, 0.1}, 0.3), CheckVerdict::cannot_tell);     // what matters is one error away
  EXPECT_EQ(judge({-0.29, 0.001}, 0.3), CheckVerdict::consistent);  // certain, but too small to matter
  EXPECT_EQ(judge({-0.5, 0.1}, 0.3), CheckVerdict::inconsistent);
  EXPECT_EQ(judge({0.5, 0.2}, 0.3), CheckVerdict::cannot_tell);  // large, but not three errors
  EXPECT_EQ(judge({0.0, 0.4}, 0.3), CheckVerdict::cannot_tell);  // the noise hides what would matter
  EXPECT_EQ(judge({std::nan(""), 0.1}, 0.3), CheckVerdict::cannot_tell);
}

TEST(Verdict, OneThatIsInconsistentIsEnough) {
  EXPECT_EQ(together(CheckVerdict::consistent, CheckVerdict::inconsistent), CheckVerdict::inconsistent);
  EXPECT_EQ(together(CheckVerdict::cannot_tell, CheckVerdict::inconsistent), CheckVerdict::inconsistent);
  EXPECT_EQ(together(CheckVerdict::consistent, CheckVerdict::cannot_tell), CheckVerdict::cannot_tell);
  EXPECT_EQ(together(CheckVerdict::consistent, CheckVerdict::consistent), CheckVerdict::consistent);
}

}  // namespace
}  // namespace pcor
