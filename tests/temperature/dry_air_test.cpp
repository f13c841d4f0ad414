#include "temperature/dry_air.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include <pcor/flight/flight.hpp>
#include <pcor/simulate/simulate.hpp>
#include "support/temporary_directory.hpp"

using namespace pcor::internal;

namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const fs::path scenarios = fs::path(PCOR_SOURCE_DIR) / "data" / "scenarios";

/// A climb by 2 km, with the given contribution of the model's vapour to the thickness, m.
HeightRecord climb_from(double height, double by_vapor) {
  HeightRecord record;
  record.name = "climb";
  record.blocks.resize(2);
  record.blocks[0].height = height;
  record.blocks[1].height = height + 2000.0;
  record.blocks[1].errors[with_vapor] = by_vapor;
  return record;
}

class DryAir : public testing::Test {
 protected:
  DryAir() {
    pcor::Scenario scenario = pcor::read_scenario(scenarios / "c130-climbs.toml");
    scenario.legs.resize(2);
    pcor::simulate_flight(scenario, directory_ / "flight.nc");
    dry_.model.moist = false;
    dry_.variables.erase(pcor::Quantity::vapor_pressure);
  }

  std::string trouble(const HeightRecord& record, const pcor::ModelDefinition& model) const {
    return trouble_with_dry_air(record, model, pcor::Flight(directory_ / "flight.nc"));
  }

  pcor::test::TemporaryDirectory directory_;
  const pcor::ModelDefinition moist_ = pcor::read_model(scenarios / "models" / "c130-psfd-eq18.toml");
  pcor::ModelDefinition dry_ = moist_;
};

TEST_F(DryAir, IsAcceptedAbove5Km) {
  EXPECT_THAT(trouble(climb_from(5001.0, 0.0), dry_), IsEmpty());
  EXPECT_THAT(trouble(climb_from(4999.0, 0.0), dry_), HasSubstr("4999 m"));
}

TEST_F(DryAir, IgnoresTheHumidityOfTheModel) {
  // The driest air below 5 km, 0.05 hPa at 540 hPa, makes 0.07 m in 2 km; steps of an archived flight are
  // rounded to 1 mm.
  EXPECT_THAT(trouble(climb_from(1000.0, 0.07), moist_), IsEmpty());
  EXPECT_THAT(trouble(climb_from(1000.0, 0.001), moist_), HasSubstr("EDPC contains no water vapour"));
}

TEST_F(DryAir, ListsHumidityVariables) {
  EXPECT_THAT(trouble(climb_from(1000.0, 0.0), dry_),
              AllOf(HasSubstr("vapor_pressure = \"EDPC\""), HasSubstr("moist = true"), Not(HasSubstr("\n"))));
  pcor::ModelDefinition named = moist_;
  named.model.moist = false;
  EXPECT_THAT(trouble(climb_from(1000.0, 0.0), named),
              AllOf(HasSubstr("moist = true"), Not(HasSubstr("EDPC"))));
  pcor::ModelDefinition of_others = dry_;
  of_others.roles_from = "faam-core";
  EXPECT_THAT(trouble(climb_from(1000.0, 0.0), of_others), HasSubstr("name the flight's vapor_pressure"));
}

}  // namespace
