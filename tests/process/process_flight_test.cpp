// The main job on the real flight of 2004, compared with the results of NCAR nimbus for the same samples.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <pcor/process/process.hpp>
#include "support/temporary_directory.hpp"
#include "support/values_of.hpp"

namespace pcor {
namespace {

ModelDefinition published(const std::string& name) {
  return read_model(std::filesystem::path(PCOR_SOURCE_DIR) / "data/models" / name);
}

class RealFlight : public testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("PCOR_FLIGHTS");
    if (folder == nullptr) GTEST_SKIP() << "PCOR_FLIGHTS does not name a folder of flights";
    path_ = std::filesystem::path(folder) / "GOTEX-rf06-C130-2004.nc";
    if (!std::filesystem::exists(path_)) GTEST_SKIP() << path_ << " is not there";
  }

  Flight process(const ModelDefinition& model) {
    const auto output = directory_.path() / "out.nc";
    summary_ = process_flight(path_, model, output);
    return Flight(output);
  }

  /// The greatest difference between a derived variable and nimbus's, in flight (TASX above 60 m/s).
  double worst(
      const Flight& ours, const std::string& name, const std::string& theirs, const std::string& unit,
      const std::function<double(double)>& of_ours = [](double x) { return x; }) {
    const Flight nimbus(path_);
    const std::vector<double> derived = test::values_of(ours, name, unit);
    const std::vector<double> reference = test::values_of(nimbus, theirs, unit);
    const std::vector<double> airspeed = test::values_of(nimbus, "TASX", "m/s");
    double maximum = 0.0;
    std::size_t compared = 0;
    for (std::size_t i = 0; i < derived.size(); ++i) {
      if (!(airspeed[i] > 60.0)) continue;
      ++compared;
      const double difference = std::abs(of_ours(derived[i]) - reference[i]);
      if (!(difference <= maximum)) maximum = difference;  // a NaN stays
    }
    EXPECT_GT(compared, 2000U) << "most of the flight is in the air";
    RecordProperty("worst_" + name + "_" + theirs, std::to_string(maximum));
    return maximum;
  }

  std::filesystem::path path_;
  test::TemporaryDirectory directory_;
  ProcessSummary summary_;
};

// Pressures are stored as 32-bit floats: 6e-5 hPa at 1000 hPa on either side. The issue is the law's
// coefficients.
constexpr double pressure_tolerance = 2e-4;  // hPa

TEST_F(RealFlight, RadomePairPressuresAgreeWithNimbus) {
  const Flight ours = process(published("c130-psfd-qcr-2003.toml"));
  EXPECT_LT(worst(ours, "PSXC", "PSFDC", "hPa"), pressure_tolerance);
  EXPECT_LT(worst(ours, "QCXC", "QCRC", "hPa"), pressure_tolerance);
  EXPECT_LT(worst(ours, "PSXC", "PSXC", "hPa"), pressure_tolerance);
  EXPECT_LT(worst(ours, "QCXC", "QCXC", "hPa"), pressure_tolerance);
}

TEST_F(RealFlight, PitotPairPressuresAgreeWithNimbus) {
  const Flight ours = process(published("c130-psfd-qcf-2003.toml"));
  EXPECT_LT(worst(ours, "PSXC", "PSFDC", "hPa"), pressure_tolerance);
  EXPECT_LT(worst(ours, "QCXC", "QCFC", "hPa"), pressure_tolerance);
}

// In 2004 nimbus took the constants of dry air for Mach number and temperature.
TEST_F(RealFlight, DryMachNumberAndTemperatureAgreeWithNimbus) {
  ModelDefinition model = published("c130-psfd-qcr-2003.toml");
  model.model.moist = false;
  const Flight ours = process(model);
  EXPECT_LT(worst(ours, "MACHX", "XMACH2", "1", [](double mach) { return mach * mach; }), 5e-6);
  EXPECT_LT(worst(ours, "ATX", "ATRR", "degC"), 5e-4);
}

// Its airspeed was that of moist air.
TEST_F(RealFlight, MoistAirspeedAgreesWithNimbus) {
  const Flight ours = process(published("c130-psfd-qcr-2003.toml"));
  EXPECT_LT(worst(ours, "TASX", "TASX", "m/s"), 0.01);
}

TEST_F(RealFlight, SummaryHasCountsAndOutputs) {
  process(published("c130-psfd-qcr-2003.toml"));
  EXPECT_EQ(summary_.records, 3061U);
  EXPECT_EQ(summary_.rate, 1);
  EXPECT_GT(summary_.corrected, 2000U);
  EXPECT_GE(summary_.min_defect, 1.113);
  EXPECT_THAT(summary_.outputs,
              testing::ElementsAre("PCOR", "PSXC", "QCXC", "MACHX", "ATX", "TASX", "PCORFLAG"));
}

}  // namespace
}  // namespace pcor
