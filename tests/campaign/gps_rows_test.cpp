#include "campaign/gps_rows.hpp"

#include <gmock/gmock.h>
#include <pcor/residuals/residuals.hpp>
#include <pcor/simulate/simulate.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "support/temporary_directory.hpp"

using namespace pcor::internal;

// The model takes dry air where the humidity is missing, and the airspeed jumps.
TEST(GpsRows, SamplesWithoutTheRecordedHumidityHaveNoRow) {
  const std::filesystem::path scenarios = std::filesystem::path(PCOR_SOURCE_DIR) / "data" / "scenarios";
  const pcor::test::TemporaryDirectory directory;
  pcor::simulate_flight(pcor::read_scenario(scenarios / "c130-circles.toml"), directory / "circles.nc");
  const pcor::ModelDefinition model = pcor::read_model(scenarios / "models" / "c130-psfd-eq18.toml");
  const pcor::Flight flight(directory / "circles.nc");
  for (const auto& reference : {pcor::wind_reference(model), pcor::height_reference(model)}) {
    const GpsKind kind = *gps_kind(*reference);
    pcor::FlightSamples samples = pcor::read_samples(flight, model, *reference);
    std::vector<std::size_t> used(samples.time.size());
    std::iota(used.begin(), used.end(), 0);
    const std::vector<double> parameters{0.004, 0.02, 0.03};
    const auto residuals = [&] {
      const GpsRows rows = gps_rows(kind, samples, model, used, parameters.data(), {0, 1, 2});
      return Eigen::VectorXd(rows.rows.rightCols(1));
    };
    const Eigen::VectorXd complete = residuals();
    std::vector<double>& humidity = *samples.model.find(pcor::Quantity::vapor_pressure);
    const std::size_t first = samples.time.size() / 2;
    ASSERT_TRUE(std::isfinite(complete[static_cast<Eigen::Index>(first)]));
    for (std::size_t i = first; i < first + 30; ++i) humidity[i] = std::nan("");
    const Eigen::VectorXd with_gap = residuals();
    for (std::size_t i = 0; i < samples.time.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const bool is_gap = i >= first && i < first + 30;
      if (is_gap) {
        EXPECT_TRUE(std::isnan(with_gap[row])) << i;
      } else if (kind == GpsKind::wind && std::isfinite(complete[row])) {
        EXPECT_EQ(with_gap[row], complete[row]) << i;
      }
    }
  }
}

TEST(GpsRows, OneMissingSampleDoesNotBreakTheHeight) {
  const std::filesystem::path scenarios = std::filesystem::path(PCOR_SOURCE_DIR) / "data" / "scenarios";
  const pcor::test::TemporaryDirectory directory;
  pcor::simulate_flight(pcor::read_scenario(scenarios / "c130-circles.toml"), directory / "circles.nc");
  const pcor::ModelDefinition model = pcor::read_model(scenarios / "models" / "c130-psfd-eq18.toml");
  pcor::FlightSamples samples =
      pcor::read_samples(pcor::Flight(directory / "circles.nc"), model, *pcor::height_reference(model));
  const std::vector<double> parameters{0.004, 0.02, 0.03};
  const auto breaks = [&] {
    const GpsRows rows = gps_rows(GpsKind::height, samples, model, {}, parameters.data(), {0, 1, 2});
    return std::count(rows.is_break.begin(), rows.is_break.end(), true);
  };
  const auto complete = breaks();
  std::vector<double>& humidity = *samples.model.find(pcor::Quantity::vapor_pressure);
  const std::size_t first = samples.time.size() / 2;
  humidity[first] = std::nan("");
  EXPECT_EQ(breaks(), complete);
  for (std::size_t i = first; i < first + 30; ++i) humidity[i] = std::nan("");
  EXPECT_EQ(breaks(), complete + 1);
}
