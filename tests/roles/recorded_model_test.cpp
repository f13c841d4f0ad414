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
    const int time = file.dimension("Time", 0);
    const int clock = file.variable("Time", NC_DOUBLE, {time});
    file.text(clock, "units", "seconds since 2011-11-17 20:00:00 +0000");
    std::vector<int> numbers;
    for (const auto& [name, unit] : variables) {
      numbers.push_back(file.variable(name, NC_FLOAT, {time}));
      file.text(numbers.back(), "units", unit);
    }
    file.values(clock, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
    for (const int number : numbers) file.values(number, std::vector<double>(10, 20.0));
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
