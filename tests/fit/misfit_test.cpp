#include "fit/misfit.hpp"

#include <gtest/gtest.h>
#include <pcor/fit/refit.hpp>

#include <cmath>
#include <utility>
#include <vector>

#include "fit/solver.hpp"
#include "support/synthetic_samples.hpp"

using namespace pcor;
using namespace pcor::internal;

namespace {

/// A law that lacks a function of q/p, curved more than any of its terms.
double curved(double p, double q, double ratio, double time) {
  const double state = (q / p - 0.1) / 0.03;
  return made::equation_18(p, q, ratio, time) + 0.8 * std::exp(-state * state);
}

/// A law that lacks a narrow peak at small angles of attack.
double peaked(double p, double q, double ratio, double time) {
  const double state = (ratio + 0.31) / 0.02;
  return made::equation_18(p, q, ratio, time) + 0.5 * std::exp(-state * state);
}

RefitResult fit_with_defect(double (*defect)(double, double, double, double)) {
  std::vector<std::shared_ptr<const FlightSamples>> flights;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    made::Plan plan;
    plan.seed = seed;
    plan.noise = 0.1;
    plan.defect = defect;
    flights.push_back(made::shared(plan));
  }
  return refit(flights, made::model({"static-constant", "static-alpha", "static-qp"}),
               made::pressure_reference());
}

}  // namespace

TEST(Misfit, CorrectLawHasAMisfitBelowTheNoise) {
  EXPECT_LT(fit_with_defect(made::equation_18).misfit_rms, 0.05);
}

// A missing roll gave a load factor of 10.
TEST(Misfit, MissingRollGivesNoLoadFactor) {
  made::Plan plan;
  plan.defect = made::equation_18;
  FlightSamples samples = made::flight(plan);
  const std::size_t half = samples.time.size() / 2;
  for (std::size_t i = 0; i < samples.time.size(); ++i)
    samples.motion.roll.push_back(i < half ? NAN : 30.0 * std::sin(0.01 * static_cast<double>(i)));
  const ModelDefinition model = made::model({"static-constant", "static-alpha", "static-qp"});
  const References references = made::pressure_reference();
  const RefitOptions options;
  const FlightSet set({std::make_shared<const FlightSamples>(samples)});
  FitTask task = fit_task(model, references, options, set);
  task.start = Eigen::Vector3d(0.004, 0.02, 0.03);
  FitFlights flights(task, FitSetup{task.start, {0, 1, 2}});
  const std::vector<Eigen::MatrixXd> states = binned_states(flights);
  constexpr Eigen::Index load_factor = 4 * 7;
  const Eigen::MatrixXd bumps =
      MisfitBasis(set.partition(), states)(states.front()).middleCols(load_factor, 7);
  const Eigen::Index without = bumps.rows() / 2 - 1;  // a bin may lie across
  EXPECT_EQ(bumps.topRows(without).norm(), 0.0);
  EXPECT_GT(bumps.bottomRows(without).norm(), 1.0);
}

// The mean of squares less the square of the mean is 7e-7 of 0.1 here, by rounding.
TEST(Misfit, ConstantStateHasNoBumps) {
  const Eigen::MatrixXd states = Eigen::MatrixXd::Constant(20000, 6, 0.1);
  EXPECT_EQ(MisfitBasis(FlightPartition(1), {states})(states.topRows(10)).norm(), 0.0);
}

// The misfit of the law is in the residual against each static pressure. It was noise of all but the first.
TEST(Misfit, IsNoNoiseOfAnyStaticPressure) {
  made::Plan plan;
  plan.noise = 0.1;
  plan.defect = curved;
  const ModelDefinition model = made::model({"static-constant", "static-alpha", "static-qp"});
  References references = made::pressure_reference();
  references.push_back(references.front());
  const RefitOptions options;
  const FlightSet set({made::shared(plan)});
  FitTask task = fit_task(model, references, options, set);
  task.start = Eigen::Vector3d(0.004, 0.02, 0.03);
  FitFlights flights(task, FitSetup{task.start, {0, 1, 2}});
  ASSERT_EQ(flights.joint().size(), 2U);
  Solution solution{task.start, std::vector<bool>(3, false), 1.0};
  solution = solve(flights, std::move(solution), {0, 1, 2});
  EXPECT_GT(find_misfit(flights, solution).rms, 0.05);
  // One reference, given twice.
  const FitFlights& again = *flights.further().front();
  EXPECT_EQ(again.noise(0).drift_component_rms, flights.noise(0).drift_component_rms);
  EXPECT_EQ(again.noise(0).common_level, flights.noise(0).common_level);
}

TEST(Misfit, MisfitEqualsTheSizeOfAMissingTerm) {
  const RefitResult right = fit_with_defect(made::equation_18);
  const RefitResult wrong = fit_with_defect(curved);
  // The part that the law cannot follow increases the residual: the squares add up.
  const double missing = std::sqrt(wrong.rms * wrong.rms - right.rms * right.rms);
  EXPECT_GT(missing, 0.1);
  EXPECT_NEAR(wrong.misfit_rms, missing, 0.3 * missing);
  for (std::size_t p = 0; p < right.parameters.size(); ++p) {
    EXPECT_GT(wrong.parameters[p].standard_error, right.parameters[p].standard_error);
    EXPECT_GE(wrong.parameters[p].standard_error, wrong.parameters[p].noise_error);
  }
}

// The stated error of the slope times its spread was 2.8 times the rms of the residual.
TEST(Misfit, NarrowPeakDoesNotMakeTheSlopeUncertainByMoreThanTheResidual) {
  const RefitResult result = fit_with_defect(peaked);
  constexpr double pressure = 700.0;  // hPa, mean
  constexpr double spread = 0.09;     // standard deviation of the ratio
  const FittedParameter& slope = result.parameters[1];
  ASSERT_EQ(slope.name, "static-alpha.a1");
  EXPECT_LT(slope.standard_error * spread * pressure, result.rms);
  EXPECT_GT(slope.standard_error, slope.noise_error);
}
