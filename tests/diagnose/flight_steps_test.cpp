// The means of flights against those of the others.
#include "diagnose/flight_steps.hpp"

#include <gmock/gmock.h>

#include <random>

#include "support/bins.hpp"

namespace pcor::internal {
namespace {

using test::bin_step;

constexpr std::size_t record_count = 300;

/// White noise of 0.2 hPa around means, and a column of the model that all flights share.
struct FlightsWithSteps {
  std::vector<Binning> bins;
  std::vector<Eigen::MatrixXd> columns;
  std::vector<Eigen::VectorXd> residuals;
  NoiseModel noise;

  FlightsWithSteps(const std::vector<double>& means, unsigned seed) {
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> normal;
    for (std::size_t f = 0; f < means.size(); ++f) {
      std::vector<double> time(record_count);
      for (std::size_t i = 0; i < record_count; ++i)
        time[i] = 1e5 * static_cast<double>(f) + bin_step * static_cast<double>(i);
      bins.emplace_back(std::vector<double>(record_count, 0.0), time, bin_step);
      columns.emplace_back(Eigen::MatrixXd::Ones(record_count, 1));
      residuals.emplace_back(
          Eigen::VectorXd::NullaryExpr(record_count, [&] { return means[f] + 0.2 * normal(engine); }));
      noise.level.emplace_back(Eigen::VectorXd::Constant(record_count, 0.2));
    }
    noise.coefficients = {0.0};
  }

  std::vector<FlightOffset> steps() const {
    return find_mean_offsets(FlightPartition(bins.size()), {bins, columns, residuals}, noise);
  }
};

TEST(MeanSteps, DifferingFlightIsFoundWithItsStep) {
  const std::vector<FlightOffset> steps = FlightsWithSteps({0.0, 0.0, 0.15, 0.0}, 1).steps();
  ASSERT_EQ(steps.size(), 4U);
  // The error of a mean of 300 values of 0.2 against that of 900.
  EXPECT_NEAR(steps[2].standard_error, 0.2 * std::sqrt(1.0 / 300.0 + 1.0 / 900.0), 0.002);
  EXPECT_NEAR(steps[2].size, 0.15, 3.0 * steps[2].standard_error);
  EXPECT_LT(steps[2].p_value, 1e-6);
  // The differing flight increases the scatter of the others, so the others are not significant.
  for (const std::size_t other : {0U, 1U, 3U}) EXPECT_GT(steps[other].p_value, 0.05);
}

TEST(MeanSteps, TwoFlightsGiveOneStep) {
  const std::vector<FlightOffset> steps = FlightsWithSteps({0.1, -0.1}, 2).steps();
  EXPECT_NEAR(steps[1].size, -0.2, 4.0 * steps[1].standard_error);
  EXPECT_LT(steps[1].p_value, 1e-6);
  EXPECT_EQ(steps[0].p_value, 1.0) << "the first above the second is the same difference";
}

// A model with a column that is 1 in the second flight and those after it, as that of a step on a date is.
TEST(MeanSteps, ModelledStepIsNotReported) {
  for (const std::vector<double>& means : {std::vector<double>{0.0, 0.4}, {0.0, 0.4, 0.4}}) {
    FlightsWithSteps flights(means, 8);
    for (std::size_t f = 0; f < means.size(); ++f) {
      flights.columns[f].conservativeResize(Eigen::NoChange, 2);
      flights.columns[f].col(1).setConstant(f == 0 ? 0.0 : 1.0);
    }
    for (const FlightOffset& each : flights.steps()) EXPECT_GT(each.p_value, 0.05);
  }
}

// Least squares of the model's columns and a constant of each flight together, by another way.
TEST(MeanSteps, MatchLeastSquaresWithFlightConstants) {
  FlightsWithSteps flights({0.0, 0.2, -0.1, 0.05, 0.0}, 9);
  std::mt19937_64 engine(10);
  std::normal_distribution<double> normal;
  const auto count = static_cast<Eigen::Index>(flights.bins.size());
  constexpr Eigen::Index columns = 2;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(count * record_count, columns + count);
  Eigen::VectorXd right(count * record_count);
  for (Eigen::Index f = 0; f < count; ++f) {
    const auto flight = static_cast<std::size_t>(f);
    flights.columns[flight] = Eigen::MatrixXd::NullaryExpr(
        record_count, columns, [&] { return 0.3 * static_cast<double>(f) + normal(engine); });
    all.block(f * record_count, 0, record_count, columns) = flights.columns[flight];
    all.block(f * record_count, columns + f, record_count, 1).setOnes();
    right.segment(f * record_count, record_count) = flights.residuals[flight];
  }
  const Eigen::VectorXd means = all.colPivHouseholderQr().solve(right).tail(count);
  const std::vector<FlightOffset> steps = flights.steps();
  for (Eigen::Index f = 0; f < count; ++f) {
    const double others = (means.sum() - means[f]) / static_cast<double>(count - 1);
    EXPECT_NEAR(steps[static_cast<std::size_t>(f)].size, means[f] - others, 1e-10);
  }
}

TEST(MeanSteps, WithoutCoefficientsStepsAreDifferencesOfMeans) {
  FlightsWithSteps flights({0.0, 0.3}, 11);
  for (Eigen::MatrixXd& columns : flights.columns) columns.resize(record_count, 0);
  EXPECT_NEAR(flights.steps()[1].size, flights.residuals[1].mean() - flights.residuals[0].mean(), 1e-12);
}

TEST(MeanSteps, OneFlightGivesNoSteps) { EXPECT_EQ(FlightsWithSteps({0.3}, 3).steps().front().p_value, 1.0); }

// A drift of that size makes means differ as much.
TEST(MeanSteps, DriftExplainsAllSteps) {
  FlightsWithSteps flights({0.1, -0.1}, 4);
  flights.noise.drift_component_rms = {0.0, 0.0, 0.0, 0.2};
  EXPECT_GT(flights.steps()[1].p_value, 0.05);
}

// Flights differ from each other by 0.1 hPa at random: of 200 campaigns of six, one flight is expected to be
// reported as a step in 2; more than 7 once in 1,000 times.
TEST(MeanSteps, RandomScatterIsNotSignificant) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  int claims = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::vector<double> means(6);
    for (double& mean : means) mean = 0.1 * normal(engine);
    const std::vector<FlightOffset> steps = FlightsWithSteps(means, 100 + seed).steps();
    claims +=
        std::any_of(steps.begin(), steps.end(), [](const FlightOffset& each) { return each.p_value < 0.01; });
  }
  EXPECT_LE(claims, 7);
}

}  // namespace
}  // namespace pcor::internal
