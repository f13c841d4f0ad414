#include "campaign/gps_noise.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

using namespace pcor::internal;

// Heights at 700 hPa, an hour in level flight, with a D-value that walks.
TEST(GpsNoise, FindsTheNoiseOfThePressureInHeights) {
  constexpr Eigen::Index count = 3600;
  constexpr double thickness = 11.0;  // m/hPa
  for (const double pressure_noise : {0.01, 0.06, 0.3}) {
    std::mt19937_64 engine(7);
    std::normal_distribution<double> normal;
    GpsRows rows;
    rows.kind = GpsKind::height;
    rows.rise.assign(count, 0.0);
    rows.warmth.assign(count, 1.0 / 280.0);
    rows.thickness.assign(count, thickness);
    rows.is_break.assign(count, false);
    rows.rows.resize(count, 2);
    double value = 0.0;
    for (Eigen::Index i = 0; i < count; ++i) {
      rows.time.push_back(static_cast<double>(i));
      value += 0.05 * normal(engine);
      rows.rows.row(i) << std::sin(0.01 * static_cast<double>(i)),
          value + thickness * pressure_noise * normal(engine) + 0.1 * normal(engine);
    }
    GpsNoise noise(GpsKind::height);
    noise.maximise(rows, Eigen::VectorXd::Zero(count), {Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1)});
    // 3600 samples determine a deviation to 1 to 2 %; the fixed noise of GPS is a part of the smaller one.
    EXPECT_NEAR(std::exp(noise.logarithms()[4]), pressure_noise, 0.1 * pressure_noise);
    const WhiteRows white = noise.white(rows, Eigen::VectorXd::Zero(count));
    EXPECT_NEAR(white.rows.col(1).squaredNorm() / count, 1.0, 0.1) << "innovations in units of their error";
  }
}
