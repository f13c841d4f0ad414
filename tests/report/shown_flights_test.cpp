#include "report/shown_flights.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <set>
#include <vector>

namespace pcor::internal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;

/// A flight a day, each with the same residual.
std::vector<FlightToShow> flights(std::size_t count) {
  std::vector<FlightToShow> all;
  for (std::size_t f = 0; f < count; ++f) all.push_back({86400.0 * static_cast<double>(f), 0.2});
  return all;
}

TEST(ShownFlights, FewFlightsAreAllShown) {
  EXPECT_THAT(flights_to_show(flights(3)), ElementsAre(0, 1, 2));
  EXPECT_EQ(flights_to_show(flights(max_flights_shown)).size(), max_flights_shown);
}

TEST(ShownFlights, IncludeTheWorstAndOthersSpreadInTime) {
  std::vector<FlightToShow> all = flights(200);
  all[40].failure = 3.0;
  all[41].failure = 2.0;
  all[60].failure = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::size_t> shown = flights_to_show(all);
  EXPECT_EQ(shown.size(), max_flights_shown);
  EXPECT_TRUE(std::is_sorted(shown.begin(), shown.end()));
  EXPECT_EQ(std::set<std::size_t>(shown.begin(), shown.end()).size(), shown.size());
  EXPECT_THAT(shown, IsSupersetOf({40, 41}));
  EXPECT_THAT(shown, testing::Not(testing::Contains(60)));
  // Half of them in eight parts of the time, one each.
  std::set<std::size_t> parts;
  for (const std::size_t f : shown) parts.insert(f / 25);
  EXPECT_EQ(parts.size(), 8U);
}

TEST(ShownFlights, FlightsWithoutAResidualAreOmitted) {
  std::vector<FlightToShow> all = flights(40);
  for (std::size_t f = 3; f < all.size(); ++f) all[f].failure = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(flights_to_show(all), ElementsAre(0, 1, 2));
}

TEST(ShownFlights, ChoiceIsEvenInTime) {
  Report report;
  for (std::size_t f = 0; f < 90; ++f) {
    report.flight_starts.push_back(f);
    report.time.push_back(static_cast<double>((f * 37) % 90));
  }
  report.flight_names.resize(90);
  show_flights_over_time(report, 9);
  std::sort(report.time.begin(), report.time.end());
  EXPECT_THAT(report.time, ElementsAre(5, 15, 25, 35, 45, 55, 65, 75, 85));
}

TEST(ShownFlights, ShownFlightsKeepTheirRecordsAndIntervals) {
  Report report;
  report.time = {0, 1, 100, 101, 102, 200, 201};
  report.flight_starts = {0, 2, 5};
  report.flight_names = {"one", "two", "three"};
  report.columns = {{"a", "a", "", {1, 2, 3, 4, 5, 6, 7}}, {"b", "b", "", {7, 6, 5, 4, 3, 2, 1}}};
  report.intervals = {{"climb", 0, 1}, {"climb", 100, 101}, {"turn", 150, 160}, {"turn", 200, 230}};
  show_flights_over_time(report, 3);
  EXPECT_EQ(report.time.size(), 7U);
  EXPECT_THAT(report.summary, IsEmpty());
  show_flights_over_time(report, 2);
  EXPECT_THAT(report.summary, ElementsAre(HasSubstr("2 of the 3 flights")));
  EXPECT_THAT(report.time, ElementsAre(0, 1, 200, 201));
  EXPECT_THAT(report.flight_starts, ElementsAre(0, 2));
  EXPECT_THAT(report.flight_names, ElementsAre("one", "three"));
  EXPECT_THAT(report.columns[0].values, ElementsAre(1, 2, 6, 7));
  EXPECT_THAT(report.columns[1].values, ElementsAre(7, 6, 2, 1));
  ASSERT_EQ(report.intervals.size(), 2U);
  EXPECT_EQ(report.intervals[0].end, 1);
  EXPECT_EQ(report.intervals[1].end, 230);
}

TEST(ShownFlights, OmittedFlightsAreReported) {
  EXPECT_THAT(format_shown_flights(16, 16), IsEmpty());
  EXPECT_THAT(format_shown_flights(16, 200), HasSubstr("16 of the 200 flights"));
}

}  // namespace
}  // namespace pcor::internal
