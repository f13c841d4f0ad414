#include "temperature/law_doubt.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include <pcor/simulate/simulate.hpp>
#include "support/temporary_directory.hpp"

using namespace pcor::internal;

namespace {

namespace fs = std::filesystem;

const fs::path scenarios = fs::path(PCOR_SOURCE_DIR) / "data" / "scenarios";

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

TEST(LawDoubt, EqualsTheMeanOfTheStatedUncertainty) {
  const pcor::test::TemporaryDirectory directory;
  pcor::Scenario scenario = pcor::read_scenario(scenarios / "c130-climbs.toml");
  scenario.legs.resize(5);
  pcor::simulate_flight(scenario, directory / "flight.nc");
  pcor::ModelDefinition model = pcor::read_model(scenarios / "models" / "c130-psfd-eq18.toml");
  const FlightAir air = read_flight_air({directory / "flight.nc"}, 0, model);
  EXPECT_FALSE(stated_law_variance(model, air));

  model.uncertainty.static_defect = 0.2;
  EXPECT_NEAR(*stated_law_variance(model, air), 0.04, 1e-12);
  model.uncertainty.static_defect_ratio = 4e-4;
  const double left = 0.04 + mean(air, [&](std::size_t i) { return std::pow(4e-4 * air.pressure[i], 2); });
  EXPECT_NEAR(*stated_law_variance(model, air), left, 1e-12);

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
  EXPECT_NEAR(*stated_law_variance(model, air), left + by_law, 1e-6 * by_law);
}

}  // namespace
