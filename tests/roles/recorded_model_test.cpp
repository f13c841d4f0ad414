#include "roles/recorded_model.hpp"

#include <gmock/gmock.h>

#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

namespace pcor::internal {
namespace {

struct Recorded {
  std::string name;
  std::string unit;
};

/// The model of a flight of ten records that has these variables.
std::optional<ModelDefinition> model_with(const std::vector<Recorded>& variables) {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory / "flight.nc";
  {
    test::NetcdfMaker file(path);
    file.time(test::sequence(0, 10));
    for (const auto& [name, unit] : variables) file.series(name, unit, std::vector<double>(10, 20.0));
  }
  return recorded_model(Flight(path));
}

const std::vector<Recorded> pressures{{"PSF", "hPa"}, {"QCF", "hPa"}};

std::vector<Recorded> with(std::vector<Recorded> variables, const Recorded& another) {
  variables.push_back(another);
  return variables;
}

TEST(RecordedModel, PrefersCorrectedPressures) {
  const auto model = model_with({{"PSF", "hPa"}, {"QCF", "hPa"}, {"PSXC", "hPa"}, {"QCXC", "hPa"}});
  ASSERT_TRUE(model);
  EXPECT_EQ(model->variables.at(Quantity::static_pressure), "PSXC");
  EXPECT_FALSE(model->model.moist);
  EXPECT_FALSE(model_with({{"PSF", "hPa"}, {"QCF", "m/s"}}));
}

TEST(RecordedModel, UsesTheRecoveryFactorOfTheThermometer) {
  // The bounds are those of the elements of the heated HARCO, and what NCAR's processing had for the others.
  const auto factor = [](const char* thermometer) {
    return model_with(with(pressures, {thermometer, "deg_C"}))->model.recovery(0.8);
  };
  EXPECT_EQ(factor("TTRR"), 0.95);
  EXPECT_EQ(factor("TTX"), 0.95);
  for (const char* harco : {"TTHR1", "TTHL2", "RTH1"}) {
    EXPECT_GT(factor(harco), 0.968) << harco;
    EXPECT_LT(factor(harco), 0.988) << harco;
  }
}

TEST(RecordedModel, PrefersARecordedAmbientTemperature) {
  const auto model = model_with(with(with(pressures, {"TTRR", "deg_C"}), {"ATX", "deg_C"}));
  EXPECT_EQ(model->variables.at(Quantity::ambient_temperature), "ATX");
  EXPECT_EQ(model->variables.count(Quantity::recovery_temperature), 0U);
}

}  // namespace
}  // namespace pcor::internal
