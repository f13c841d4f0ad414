#include "campaign/gps_rows.hpp"

#include <gmock/gmock.h>
#include <pcor/residuals/residuals.hpp>
#include <pcor/simulate/simulate.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "support/short_flight.hpp"

using namespace pcor::internal;

namespace {

class GpsRowsOfCircles : public testing::Test {
 protected:
  GpsRowsOfCircles() {
    pcor::simulate_flight(pcor::read_scenario(pcor::test::scenarios / "c130-circles.toml"),
                          directory_ / "circles.nc");
  }

  pcor::FlightSamples samples(const pcor::Reference& reference) const {
    return pcor::read_samples(pcor::Flight(directory_ / "circles.nc"), model, reference);
  }

  const pcor::ModelDefinition model = pcor::test::laser_model();
  const std::vector<double> parameters{0.004, 0.02, 0.03};

 private:
  pcor::test::TemporaryDirectory directory_;
};

// The model takes dry air where the humidity is missing, and the airspeed jumps.
TEST_F(GpsRowsOfCircles, SamplesWithoutTheRecordedHumidityHaveNoRow) {
  for (const auto& reference : {pcor::wind_reference(model), pcor::height_reference(model)}) {
    const GpsKind kind = *gps_kind(*reference);
    pcor::FlightSamples samples = this->samples(*reference);
    std::vector<std::size_t> used(samples.time.size());
    std::iota(used.begin(), used.end(), 0);
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

TEST_F(GpsRowsOfCircles, OneMissingSampleDoesNotBreakTheHeight) {
  pcor::FlightSamples samples = this->samples(*pcor::height_reference(model));
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

// The pressure altitude alone, hundreds of metres from the height by GPS, was a jump of the height at both
// ends of a gap.
TEST_F(GpsRowsOfCircles, GapInTheGpsHeightIsNotAJumpOfTheHeight) {
  pcor::FlightSamples samples = this->samples(*pcor::wind_reference(model));
  for (double& height : samples.motion.altitude) height += 300.0;
  std::vector<std::size_t> used(samples.time.size());
  std::iota(used.begin(), used.end(), 0);
  const auto rise = [&] {
    return gps_rows(GpsKind::wind, samples, model, used, parameters.data(), {0, 1, 2}).rise;
  };
  const std::vector<double> complete = rise();
  const std::vector<double> height = samples.motion.altitude;
  const std::size_t middle = height.size() / 2;
  for (const auto& [first, last] : {std::pair(middle, middle + 10), std::pair(std::size_t{0}, middle)}) {
    samples.motion.altitude = height;
    std::fill(samples.motion.altitude.begin() + static_cast<std::ptrdiff_t>(first),
              samples.motion.altitude.begin() + static_cast<std::ptrdiff_t>(last), std::nan(""));
    const std::vector<double> with_gap = rise();
    // The noise of the pressure changes its altitude by up to 4 m in a second; the jump was 370 m.
    for (std::size_t i = middle - 60; i < middle + 60; ++i) EXPECT_NEAR(with_gap[i], complete[i], 20.0) << i;
  }
}

}  // namespace
