#include "temperature/parts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

using namespace pcor::internal;

namespace {

/// Heights of a climb and a descent to half its height, with an error of the thermometer in the climb only.
/// The first two columns of each block are those of the integral in climbs and in descents.
HeightRecord climb_and_descent() {
  HeightRecord record;
  for (int i = 0; i < 200; ++i) {
    HeightBlock block;
    block.starts_segment = i == 0;
    block.time = 10.0 * i;
    block.length = 10.0;
    block.samples = 10;
    const double climbs = i < 100 ? i : 100.0;
    const double descents = i < 100 ? 0.0 : -0.5 * (i - 100.0);
    block.columns.head<2>() << climbs, descents;
    block.excess = 0.02 * climbs + std::sin(i);
    record.blocks.push_back(block);
  }
  return record;
}

HeightNoise white_noise() {
  HeightNoise noise;
  noise.white = 1.0;
  noise.wander = noise.walk = 0.0;
  return noise;
}

HeightPrior level_isobars() {
  HeightPrior prior;
  prior.slope = 0.0;
  return prior;
}

/// The record with other columns in place of those in climbs and in descents.
template <class Columns>
HeightRecord with_columns(const Columns& columns) {
  HeightRecord record = climb_and_descent();
  for (HeightBlock& block : record.blocks)
    block.columns.head<2>() = columns(block.columns[0], block.columns[1]);
  return record;
}

/// The integral of the column of a0 over climbs and descents.
Eigen::Vector2d integral(double climbs, double descents) { return {climbs + descents, 0.0}; }

// Both corrections depend on the unknown height at the start. Taken as independent, they gave half of the
// chi-squared.
TEST(Parts, DifferenceOfClimbsAndDescentsHasTheErrorOfADifference) {
  const HeightNoise noise = white_noise();
  const HeightPrior prior = level_isobars();
  const Workers workers(pcor::serial_communicator(), 1);
  const std::vector<pcor::PartCorrection> parts = corrections_of_climbs_and_descents(
      {with_columns(integral)}, noise, prior, HeightUnknowns::Zero(), workers);
  ASSERT_EQ(parts.size(), 2U);
  // Half of the difference as an unknown in addition to the mean.
  const auto half = [](double climbs, double descents) {
    return Eigen::Vector2d(climbs + descents, climbs - descents);
  };
  const HeightEquations equations = height_equations(with_columns(half), noise, prior);
  const double expected = equations.best(2)[1] * equations.best(2)[1] / equations.covariance(2)(1, 1);
  ASSERT_GT(expected, 10.0);
  // The unknown start has a variance of 1e8 m2 in the filter: relative errors of 1e-8 times the condition.
  EXPECT_NEAR(disagreement_of(parts).chi_squared / expected, 1.0, 1e-5);
}

// A flight that climbs in its first half and descends in the second.
TEST(Parts, HalvesOfAClimbAndADescentAreTheClimbAndTheDescent) {
  const HeightRecord record = with_columns(integral);
  const HeightNoise noise = white_noise();
  const HeightPrior prior = level_isobars();
  const Workers workers(pcor::serial_communicator(), 1);
  const HeightUnknowns none = HeightUnknowns::Zero();
  const auto by_direction = corrections_of_climbs_and_descents({record}, noise, prior, none, workers);
  const auto by_time = corrections_of_halves({record}, noise, prior, none, workers);
  ASSERT_EQ(by_time.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    // The step at the middle belongs to the climb, but to the second half.
    EXPECT_NEAR(by_time[k].correction, by_direction[k].correction, 0.3 * by_direction[k].standard_error);
    EXPECT_NEAR(by_time[k].standard_error / by_direction[k].standard_error, 1.0, 0.1);
  }
  EXPECT_GT(std::abs(by_time[0].correction - by_time[1].correction), 3.0 * by_time[0].difference_error);
}

}  // namespace
