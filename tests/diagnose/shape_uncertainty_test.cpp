// Columns of uncertain shapes against derivatives of powers and delays.
#include "diagnose/shape_uncertainty.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "support/bins.hpp"

using namespace pcor::internal;
using pcor::FlightPartition;
using pcor::Quantity;
using pcor::test::bin_step;

namespace {

constexpr Eigen::Index row_count = 200;

/// A flight with one column that varies slowly, in air whose pressures vary.
struct Example {
  FlightColumns flight;
  BinnedFlights binned;
  Eigen::VectorXd column{row_count};
  Eigen::VectorXd dynamic_pressure{row_count};

  Example() {
    std::vector<double> time(row_count);
    auto samples = std::make_shared<pcor::FlightSamples>();
    std::vector<double> dynamic(row_count);
    std::vector<double> still(row_count);
    for (Eigen::Index i = 0; i < row_count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double phase = static_cast<double>(i) / 40.0;
      time[k] = bin_step * static_cast<double>(i);
      column[i] = std::sin(phase) + 0.4;
      dynamic_pressure[i] = dynamic[k] = 60.0 + 20.0 * std::cos(0.37 * phase);
      still[k] = 700.0;
    }
    samples->model.columns.emplace_back(Quantity::dynamic_pressure, dynamic);
    samples->model.columns.emplace_back(Quantity::static_pressure, still);
    samples->time = time;
    flight.samples = samples;
    binned.bins.emplace_back(std::vector<double>(row_count, 0.0), time, bin_step);
    binned.columns.emplace_back(column);
  }

  Eigen::MatrixXd uncertainty(double coefficient) const {
    return shape_uncertainty(FlightPartition(1), {&flight}, binned,
                             {Eigen::VectorXd::Constant(1, coefficient)})[0];
  }
};

}  // namespace

TEST(ShapeUncertainty, PressureColumnIsTheDerivativeByTheExponent) {
  const Example example;
  const Eigen::VectorXd found = example.uncertainty(2.0).col(0);
  const Eigen::VectorXd effect = 2.0 * example.column;
  const Eigen::ArrayXd logarithm = example.dynamic_pressure.array().log();
  const double mean = (effect.array().square() * logarithm).sum() / effect.squaredNorm();
  constexpr double change = 1e-6;  // change of the power; the error of the difference is of this order
  const Eigen::ArrayXd ratio = (change * (logarithm - mean)).exp();
  const Eigen::VectorXd difference = (effect.array() * (ratio - 1.0) / change).matrix();
  EXPECT_TRUE(found.isApprox(0.3 * difference, 1e-5));
}

TEST(ShapeUncertainty, ColumnsAreOrthogonalToTheEffect) {
  const Example example;
  const Eigen::MatrixXd found = example.uncertainty(2.0);
  for (Eigen::Index k = 0; k < 4; ++k) {
    // Rounding of a sum over 200 bins of values about one.
    EXPECT_NEAR(found.col(k).dot(example.column), 0.0, 1e-10) << k;
  }
}

TEST(ShapeUncertainty, TheSlopesOnEitherSideOfZeroDiffer) {
  const Example example;
  const Eigen::VectorXd found = example.uncertainty(2.0).col(3);
  const Eigen::ArrayXd ratio = found.cwiseQuotient(example.column).array() / 2.0;
  const Eigen::Array<bool, Eigen::Dynamic, 1> positive = example.column.array() > 0.0;
  const double above = positive.select(ratio, -1.0).maxCoeff();
  const double below = positive.select(1.0, ratio).minCoeff();
  EXPECT_NEAR(above - below, 2.0 * 0.3, 1e-12);
  // Each side has one ratio.
  EXPECT_NEAR((ratio - positive.select(Eigen::ArrayXd::Constant(row_count, above), below)).abs().maxCoeff(),
              0.0, 1e-12);
}

TEST(ShapeUncertainty, EffectOfOneSignHasNoSecondSlope) {
  Example example;
  example.column.array() += 1.0;
  example.binned.columns.front() = example.column;
  EXPECT_NEAR(example.uncertainty(2.0).col(3).cwiseAbs().maxCoeff(), 0.0, 1e-12);
}

TEST(ShapeUncertainty, ConstantPressureGivesAZeroColumn) {
  const Example example;
  EXPECT_NEAR(example.uncertainty(2.0).col(1).cwiseAbs().maxCoeff(), 0.0, 1e-12);
}

TEST(ShapeUncertainty, DelayColumnIsProportionalToTheRateOfChange) {
  const Example example;
  const Eigen::VectorXd found = example.uncertainty(1.0).col(4);
  for (Eigen::Index i = 1; i + 1 < row_count; ++i) {
    const double rate = std::cos(static_cast<double>(i) / 40.0) / 40.0 / bin_step;
    EXPECT_NEAR(found[i], 0.15 * rate, 1e-3 * 0.15 / 40.0 / bin_step) << i;  // second order in the step
  }
}

TEST(ShapeUncertainty, ScalesWithTheEffect) {
  const Example example;
  EXPECT_TRUE(example.uncertainty(6.0).isApprox(3.0 * example.uncertainty(2.0), 1e-12));
}

TEST(ShapeUncertainty, ZeroShiftColumnIsConstantAtTheEffectRms) {
  const Example example;
  const Eigen::VectorXd effect = 2.0 * example.column;
  const double rms = std::sqrt(effect.squaredNorm() / static_cast<double>(row_count));
  EXPECT_TRUE(example.uncertainty(2.0).col(5).isApprox(Eigen::VectorXd::Constant(row_count, rms), 1e-12));
}
