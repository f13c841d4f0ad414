#include "checks/verdict.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

using namespace pcor::internal;

namespace pcor {
namespace {

TEST(Verdict, DependsOnSizeAndError) {
  EXPECT_EQ(classify({0.05, 0.1}, 0.3), CheckVerdict::consistent);
  EXPECT_EQ(classify({0.2, 0.1}, 0.3), CheckVerdict::inconclusive);    // what matters is one error away
  EXPECT_EQ(classify({-0.29, 0.001}, 0.3), CheckVerdict::consistent);  // certain, but too small to matter
  EXPECT_EQ(classify({-0.5, 0.1}, 0.3), CheckVerdict::inconsistent);
  EXPECT_EQ(classify({0.5, 0.2}, 0.3), CheckVerdict::inconclusive);  // large, but not three errors
  EXPECT_EQ(classify({0.0, 0.4}, 0.3), CheckVerdict::inconclusive);  // the noise hides what would matter
  EXPECT_EQ(classify({std::nan(""), 0.1}, 0.3), CheckVerdict::inconclusive);
}

TEST(Verdict, OneInconsistentNumberMakesTheWholeInconsistent) {
  const auto number = [](double value, double error) { return test_statistic({value, error}, 0.3, "K", ""); };
  const TestStatistic consistent = number(0.0, 0.1);
  const TestStatistic inconclusive = number(0.0, 0.4);
  const TestStatistic inconsistent = number(0.5, 0.1);
  CheckResult result;
  for (const TestStatistic& other : {consistent, inconclusive}) {
    set_verdict({other, inconsistent}, result);
    EXPECT_EQ(result.verdict, CheckVerdict::inconsistent);
    set_verdict({consistent, other}, result);
    EXPECT_EQ(result.verdict, other.verdict);
  }
}

TEST(Verdict, NamesTheDecidingNumber) {
  CheckResult result;
  set_verdict(
      {test_statistic({-0.9, 0.5}, 0.3, "K", "thermometer"), test_statistic({2.8, 0.9}, 0.3, "K", "slope")},
      result);
  EXPECT_EQ(result.verdict, CheckVerdict::inconsistent);
  EXPECT_EQ(result.key.what, "slope");
  EXPECT_EQ(result.explanation.find("+2.800 +- 0.900 K, slope: "), 0U);
  EXPECT_NE(result.explanation.find("2.700"), std::string::npos);
  ASSERT_EQ(result.statistics.size(), 2U);
  EXPECT_EQ(result.statistics[0].verdict, CheckVerdict::inconclusive);

  set_verdict(
      {test_statistic({0.01, 0.02}, 0.3, "hPa", "one"), test_statistic({0.0, 0.1}, 0.3, "hPa", "other")},
      result);
  EXPECT_EQ(result.key.what, "other");  // it may be 0.2 hPa, the first one 0.05 hPa
  EXPECT_EQ(result.explanation.find("+0.000 +- 0.100 hPa, other: "), 0U);
  EXPECT_NE(result.explanation.find("0.200"), std::string::npos);

  set_verdict({test_statistic({0.5, 0.1}, 0.3, "hPa", "between")}, result);
  mark_inconclusive("the other one is as measured", result);
  EXPECT_EQ(result.verdict, CheckVerdict::inconclusive);
  EXPECT_NE(result.explanation.find(", but the other one is as measured"), std::string::npos);
}

}  // namespace
}  // namespace pcor
