#include "temperature/read_heights.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include <pcor/flight/flight.hpp>
#include "support/short_flight.hpp"

using namespace pcor::internal;

namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A climb by 2 km, with the given contribution of the model's vapour to the thickness, m.
HeightRecord climb_from(double height, double by_vapor) {
  HeightRecord record;
  record.name = "climb";
  record.blocks.resize(2);
  record.blocks[0].height = height;
  record.blocks[1].height = height + 2000.0;
  record.blocks[1].columns[with_vapor] = by_vapor;
  return record;
}

class DryAir : public testing::Test {
 protected:
  DryAir() {
    dry_.model.moist = false;
    dry_.variables.erase(pcor::Quantity::vapor_pressure);
  }

  std::string problem(const HeightRecord& record, const pcor::ModelDefinition& model) const {
    return dry_air_problem(record, model, pcor::Flight(pcor::test::short_flight()));
  }

  const pcor::ModelDefinition moist_ = pcor::test::laser_model();
  pcor::ModelDefinition dry_ = moist_;
};

TEST_F(DryAir, IsAcceptedAbove5Km) {
  EXPECT_THAT(problem(climb_from(5001.0, 0.0), dry_), IsEmpty());
  EXPECT_THAT(problem(climb_from(4999.0, 0.0), dry_), HasSubstr("4999 m"));
}

TEST_F(DryAir, IgnoresTheHumidityOfTheModel) {
  // The driest air below 5 km, 0.05 hPa at 540 hPa, makes 0.07 m in 2 km; steps of an archived flight are
  // rounded to 1 mm.
  EXPECT_THAT(problem(climb_from(1000.0, 0.07), moist_), IsEmpty());
  EXPECT_THAT(problem(climb_from(1000.0, 0.001), moist_), HasSubstr("EDPC contains no water vapour"));
}

TEST_F(DryAir, ListsHumidityVariables) {
  EXPECT_THAT(problem(climb_from(1000.0, 0.0), dry_),
              AllOf(HasSubstr("vapor_pressure = \"EDPC\""), HasSubstr("moist = true"), Not(HasSubstr("\n"))));
  pcor::ModelDefinition named = moist_;
  named.model.moist = false;
  EXPECT_THAT(problem(climb_from(1000.0, 0.0), named),
              AllOf(HasSubstr("moist = true"), Not(HasSubstr("EDPC"))));
  pcor::ModelDefinition of_others = dry_;
  of_others.roles_from = "faam-core";
  EXPECT_THAT(problem(climb_from(1000.0, 0.0), of_others), HasSubstr("name the flight's vapor_pressure"));
}

/// The mean over the samples in the air.
template <class Value>
double mean(const FlightAir& air, const Value& value) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < air.size(); ++i) {
    if (!air.flying[i] || std::isnan(value(i))) continue;
    sum += value(i);
    count += 1.0;
  }
  return sum / count;
}

TEST(LawError, EqualsTheMeanOfTheStatedUncertainty) {
  pcor::ModelDefinition model = pcor::test::laser_model();
  const FlightAir air = read_flight_air({pcor::test::short_flight()}, 0, model);
  EXPECT_FALSE(stated_law_variance(model, air));

  model.uncertainty.static_defect = 0.2;
  EXPECT_NEAR(*stated_law_variance(model, air), 0.04, 1e-12);
  model.uncertainty.static_defect_ratio = 4e-4;
  const double by_uncertainty =
      0.04 + mean(air, [&](std::size_t i) { return std::pow(4e-4 * air.pressure[i], 2); });
  EXPECT_NEAR(*stated_law_variance(model, air), by_uncertainty, 1e-12);

  // delta-p of equation 18 is a0 p + a1 r p + a2 q of the measured pressures, r the radome ratio: the
  // variance by a0 and a2, which are not independent, is that of p da0 + q da2.
  model.covariance.parameters = {"static-constant.a0", "static-qp.a2"};
  model.covariance.matrix = {{1e-8, -5e-8}, {-5e-8, 4e-7}};
  const double by_law = mean(air, [&](std::size_t i) {
    const double p = air.measured_static[i];
    const double q = air.measured_dynamic[i];
    return 1e-8 * p * p - 1e-7 * p * q + 4e-7 * q * q;
  });
  // delta-p is linear in them, and one standard deviation of 1e-4 and 6e-4 is a difference of 0.05 hPa,
  // rounded to 1e-13.
  EXPECT_NEAR(*stated_law_variance(model, air), by_uncertainty + by_law, 1e-6 * by_law);
}

}  // namespace
