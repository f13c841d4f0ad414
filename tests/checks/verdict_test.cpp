#include "checks/verdict.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

using namespace pcor::internal;

namespace pcor {
namespace {

TEST(Verdict, DependsOnSizeAndError) {
  EXPECT_EQ(judge({0.05, 0.1}, 0.3), CheckVerdict::consistent);
  EXPECT_EQ(judge({0.2, 0.1}, 0.3), CheckVerdict::inconclusive);    // what matters is one error away
  EXPECT_EQ(judge({-0.29, 0.001}, 0.3), CheckVerdict::consistent);  // certain, but too small to matter
  EXPECT_EQ(judge({-0.5, 0.1}, 0.3), CheckVerdict::inconsistent);
  EXPECT_EQ(judge({0.5, 0.2}, 0.3), CheckVerdict::inconclusive);  // large, but not three errors
  EXPECT_EQ(judge({0.0, 0.4}, 0.3), CheckVerdict::inconclusive);  // the noise hides what would matter
  EXPECT_EQ(judge({std::nan(""), 0.1}, 0.3), CheckVerdict::inconclusive);
}

TEST(Verdict, OneInconsistentNumberMakesTheWholeInconsistent) {
  const auto number = [](double value, double error) { return judged({value, error}, 0.3, "K", ""); };
  const TestStatistic consistent = number(0.0, 0.1);
  const TestStatistic inconclusive = number(0.0, 0.4);
  const TestStatistic inconsistent = number(0.5, 0.1);
  CheckResult result;
  for (const TestStatistic& other : {consistent, inconclusive}) {
    decide({other, inconsistent}, result);
    EXPECT_EQ(result.verdict, CheckVerdict::inconsistent);
    decide({consistent, other}, result);
    EXPECT_EQ(result.verdict, other.verdict);
  }
}

TEST(Verdict, NamesTheDecidingNumber) {
  CheckResult result;
  decide({judged({-0.9, 0.5}, 0.3, "K", "thermometer"), judged({2.8, 0.9}, 0.3, "K", "slope")}, result);
  EXPECT_EQ(result.verdict, CheckVerdict::inconsistent);
  EXPECT_EQ(result.key.what, "slope");
  EXPECT_EQ(result.decided.find("+2.800 +- 0.900 K, slope: "), 0U);
  EXPECT_NE(result.decided.find("2.700"), std::string::npos);
  ASSERT_EQ(result.judged.size(), 2U);
  EXPECT_EQ(result.judged[0].verdict, CheckVerdict::inconclusive);

  decide({judged({0.01, 0.02}, 0.3, "hPa", "one"), judged({0.0, 0.1}, 0.3, "hPa", "other")}, result);
  EXPECT_EQ(result.key.what, "other");  // it may be 0.2 hPa, the first one 0.05 hPa
  EXPECT_EQ(result.decided.find("+0.000 +- 0.100 hPa, other: "), 0U);
  EXPECT_NE(result.decided.find("0.200"), std::string::npos);

  decide({judged({0.5, 0.1}, 0.3, "hPa", "between")}, result);
  withhold("the other one is as measured", result);
  EXPECT_EQ(result.verdict, CheckVerdict::inconclusive);
  EXPECT_NE(result.decided.find(", but the other one is as measured"), std::string::npos);
}

}  // namespace
}  // namespace pcor
