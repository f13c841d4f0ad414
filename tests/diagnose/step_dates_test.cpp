// The dates on which a step between flights is tried.
#include "diagnose/step_dates.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace pcor::internal {
namespace {

/// A flight a day.
std::vector<double> begins(std::size_t count) {
  std::vector<double> days(count);
  std::iota(days.begin(), days.end(), 100.0);
  return days;
}

Finding step_on(double date) {
  Finding finding;
  finding.effect.id = "aircraft-step";
  finding.effect.parameters = {0.0017, date};
  return finding;
}

/// Tried date nearest to a step between two flights.
double nearest(const std::vector<double>& tried, double date) {
  return *std::min_element(tried.begin(), tried.end(),
                           [date](double a, double b) { return std::abs(a - date) < std::abs(b - date); });
}

TEST(StepDates, FewFlightsTryEveryDateButTheFirst) {
  StepDates dates(begins(4));
  EXPECT_THAT(dates.tried(), testing::ElementsAre(101.0, 102.0, 103.0));
  EXPECT_FALSE(dates.refine({step_on(102.0)}));
}

TEST(StepDates, OneFlightGivesNoDates) {
  EXPECT_THAT(StepDates(begins(1)).tried(), testing::IsEmpty());
  EXPECT_THAT(StepDates(std::vector<double>{}).tried(), testing::IsEmpty());
}

TEST(StepDates, ManyFlightsTrySomeDatesUntilAStepIsFound) {
  StepDates dates(begins(2000));
  EXPECT_LE(dates.tried().size(), 42U);
  EXPECT_FALSE(dates.refine({}));
  Finding other;
  other.effect.id = "static-lag";
  other.effect.parameters = {0.3};
  EXPECT_FALSE(dates.refine({other}));
}

// A step between two groups of flights is tried near enough to keep half of its evidence at least.
TEST(StepDates, TriedDatesAreDenserAtBothEnds) {
  const StepDates dates(begins(2000));
  for (int before = 1; before < 2000; ++before) {
    const double truth = 100.0 + before;
    EXPECT_LE(std::abs(nearest(dates.tried(), truth) - truth), 0.5 * std::min(before, 2000 - before))
        << before;
  }
}

TEST(StepDates, OtherSystemFindingsDoNotRefineDates) {
  StepDates dates(begins(2000));
  Finding other = step_on(dates.tried().front());
  other.of_reference = true;
  EXPECT_FALSE(dates.refine({other}));
}

// Steps at any flight, first and last included, are located to the flight in a few rounds.
TEST(StepDates, RefinementLocatesTheFlight) {
  for (const double truth : {101.0, 350.0, 2099.0}) {
    StepDates dates(begins(2000));
    const auto found = [&] {
      return std::vector<Finding>{step_on(nearest(dates.tried(), truth)),
                                  step_on(nearest(dates.tried(), 1234.0))};
    };
    int rounds = 0;
    while (dates.refine(found())) ++rounds;
    EXPECT_LE(rounds, 3);
    EXPECT_LE(dates.tried().size(), 200U);
    EXPECT_EQ(nearest(dates.tried(), truth), truth);
    EXPECT_EQ(nearest(dates.tried(), 1234.0), 1234.0);
  }
}

}  // namespace
}  // namespace pcor::internal
