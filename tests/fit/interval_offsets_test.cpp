#include <gtest/gtest.h>
#include <pcor/fit/refit.hpp>

#include <Eigen/Dense>
#include <memory>
#include <vector>

#include "fit/fit_flights.hpp"
#include "fit/solver.hpp"
#include "support/synthetic_samples.hpp"

// The offsets of the intervals of a stage, which every flight finds for itself, against one system of
// equations that has all of them as unknowns, and against the laws that a least has.

using namespace pcor;
using namespace pcor::internal;

namespace {

/// A stage that fits two slopes to intervals of each of ten flights, with the noise of all samples.
class IntervalOffsets : public testing::TestWithParam<Loss> {
 protected:
  static std::vector<std::shared_ptr<const FlightSamples>> flights() {
    std::vector<std::shared_ptr<const FlightSamples>> all;
    for (unsigned seed = 1; seed <= 10; ++seed) {
      made::Plan plan;
      plan.seed = seed;
      plan.samples = 2400;
      plan.outliers = 0.01;
      plan.defect = made::equation_18;
      FlightSamples samples = made::flight(plan);
      for (const std::size_t begin : {200U, 600U, 900U, 1800U})  // the third continues the second
        samples.intervals.push_back(
            {Regime::pitch_manoeuvre, samples.time[begin], samples.time[begin + 300]});
      // Too short for a bin, so that its offset is free.
      samples.intervals.push_back({Regime::pitch_manoeuvre, samples.time[2200], samples.time[2201]});
      all.push_back(std::make_shared<const FlightSamples>(samples));
    }
    return all;
  }

  IntervalOffsets() {
    options_.loss = GetParam();
    options_.threads = 1;
    task_.start = Eigen::Vector3d(0.004, 0.02, 0.03);
    whole_ = std::make_unique<FitFlights>(task_, FitSetup{task_.start, {0, 1, 2}});
    whole_->weigh(task_.start);
    stage_ =
        std::make_unique<FitFlights>(task_, FitSetup{task_.start, {1, 2}, {}, {Regime::pitch_manoeuvre}});
    stage_->share_weight(*whole_);
  }

  Solution solution() {
    Solution from;
    from.values = task_.start;
    from.deviation = whole_->deviation(task_.start);
    return solve(*stage_, from, {1, 2}, true);
  }

  RefitOptions options_;
  ModelDefinition model_ = made::model({"static-constant", "static-alpha", "static-qp"});
  References references_ = made::pressure_reference();
  FlightSet flights_{flights()};
  FitTask task_ = fit_task(model_, references_, options_, flights_);
  std::unique_ptr<FitFlights> whole_;
  std::unique_ptr<FitFlights> stage_;
};

using IntervalOffsetsOfLeastSquares = IntervalOffsets;
using IntervalOffsetsOfAnyLoss = IntervalOffsets;

TEST_P(IntervalOffsetsOfLeastSquares, EqualTheSolutionForAllUnknowns) {
  const Solution found = solution();
  // Derivatives of each flight by the slopes and by its offsets, and its residual.
  const auto systems = stage_->of_each([&](std::size_t flight, const FitFlight& fit) {
    const FlightSamples& samples = fit.residuals().samples();
    const std::vector<double>& pressure = *samples.model.find(Quantity::static_pressure);
    Eigen::MatrixXd system = stage_->weighted(flight, stage_->columns(flight));
    for (std::size_t k = 0; k < 4; ++k) {
      const Interval& interval = samples.intervals[k];
      std::vector<double> shift(samples.time.size(), 0.0);
      for (std::size_t i = 0; i < shift.size(); ++i) {
        if (samples.time[i] >= interval.begin && samples.time[i] < interval.end) shift[i] = pressure[i];
      }
      system.conservativeResize(Eigen::NoChange, system.cols() + 1);
      system.rightCols(1) = stage_->weighted(flight, stage_->bins(flight).means(shift));
    }
    system.conservativeResize(Eigen::NoChange, system.cols() + 1);
    system.rightCols(1) = stage_->weighted(flight, stage_->residual(flight, task_.start));
    return system;
  });
  Eigen::Index bins = 0;
  for (const Eigen::MatrixXd& system : systems) bins += system.rows();
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(bins, 2 + 40);
  Eigen::VectorXd residual(bins);
  Eigen::Index row = 0;
  for (std::size_t f = 0; f < systems.size(); ++f) {
    const Eigen::Index count = systems[f].rows();
    all.block(row, 0, count, 2) = systems[f].leftCols(2);
    all.block(row, 2 + 4 * static_cast<Eigen::Index>(f), count, 4) = systems[f].middleCols(2, 4);
    residual.segment(row, count) = systems[f].rightCols(1);
    row += count;
  }
  const Eigen::VectorXd step = all.colPivHouseholderQr().solve(-residual);
  for (const Eigen::Index k : {0, 1})
    EXPECT_NEAR(found.values[1 + k] / (task_.start[1 + k] + step[k]), 1.0, 1e-10);
  // The derivatives of the least squares include the change of the offsets.
  const Reduction reduction = stage_->reduce(found.values, {});
  const Eigen::MatrixXd information = (all.transpose() * all).inverse().topLeftCorner(2, 2).inverse();
  const Eigen::MatrixXd factor = reduction.factor.leftCols(2);
  EXPECT_LT((factor.transpose() * factor - information).norm(), 1e-9 * information.norm());
  const Eigen::VectorXd lengths = reduction.lengths();
  EXPECT_LT((lengths - all.leftCols(2).colwise().norm().transpose()).norm(), 1e-10 * lengths.norm());
}

INSTANTIATE_TEST_SUITE_P(Stage, IntervalOffsetsOfLeastSquares, testing::Values(Loss::none));

TEST_P(IntervalOffsetsOfAnyLoss, GradientEqualsDifferencesOfTheMinimumLoss) {
  const ScaledLoss loss(GetParam(), 1.0);
  Eigen::VectorXd values = task_.start + Eigen::Vector3d(0.0, 0.0005, 0.0005);
  const Reduction reduction = stage_->reduce(values, loss);
  const Eigen::VectorXd gradient = reduction.factor.leftCols(2).transpose() * reduction.factor.col(2);
  for (const Eigen::Index k : {0, 1}) {
    const double step = 1e-3 / reduction.lengths()[k];
    Eigen::VectorXd more = values;
    Eigen::VectorXd less = values;
    more[1 + k] += step;
    less[1 + k] -= step;
    const double change = stage_->reduce(more, loss).cost - stage_->reduce(less, loss).cost;
    // Costs of a few thousand determine their difference to 1e-12 of their value.
    EXPECT_NEAR(change / (2.0 * step) / gradient[k], 1.0, 1e-5);
  }
  // The result depends only on the parameters, not on earlier calls.
  EXPECT_EQ(stage_->reduce(values, loss).factor, reduction.factor);
}

INSTANTIATE_TEST_SUITE_P(Stage, IntervalOffsetsOfAnyLoss, testing::Values(Loss::huber, Loss::none));

}  // namespace
