#include "roles/possible_values.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include <pcor/model/quantity.hpp>
#include "roles/usual_variables.hpp"

namespace pcor::internal {
namespace {

TEST(PossibleValues, AreKnownOfEverySeriesThatIsMeasured) {
  constexpr double absurd = 1e20;
  for (const std::string& series : names_of_series()) {
    const bool is_measured = series != facts_of(Quantity::date).name;
    EXPECT_EQ(std::isnan(possible_values({}, series)(absurd)), is_measured) << series;
    EXPECT_EQ(std::isnan(possible_values({}, series)(-absurd)), is_measured) << series;
  }
  EXPECT_EQ(possible_values({}, "a variable of a formula")(absurd), absurd);
}

TEST(PossibleValues, AreThoseOfTheUnitOfTheSeries) {
  const UnitConversion from_pascal(0.01, 0.0);
  EXPECT_EQ(possible_values(from_pascal, "static_pressure")(85000.0), 850.0);
  EXPECT_TRUE(std::isnan(possible_values(from_pascal, "static_pressure")(850.0)));
}

}  // namespace
}  // namespace pcor::internal
