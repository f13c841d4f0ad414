#include "campaign/maximum_score.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "numerics/chi_squared.hpp"

namespace {

using pcor::internal::chi_squared_value;
using pcor::internal::Directions;
using pcor::internal::quantile_of_maximum;

constexpr double probability = 0.95;
constexpr std::size_t draws = 40000;
// Standard error of the 0.95 quantile of chi2 with one degree of freedom from 40,000 draws:
// sqrt(p (1 - p) / n) / density = 0.0011 / 0.030 = 0.037. The tolerance is four of these.
constexpr double tolerance = 0.16;

double quantile(const Eigen::MatrixXd& covariance, const std::vector<Directions>& directions) {
  return quantile_of_maximum(covariance, directions, probability, draws, 1);
}

TEST(MaximumScore, OneColumnHasTheQuantileOfChiSquared) {
  EXPECT_NEAR(quantile(Eigen::MatrixXd::Identity(1, 1), {{1, 1}}), chi_squared_value(1.0 - probability, 1.0),
              tolerance);
}

TEST(MaximumScore, IndependentGroupsExceedOneGroup) {
  constexpr Eigen::Index count = 10;
  const double of_each = 1.0 - std::pow(probability, 1.0 / static_cast<double>(count));
  EXPECT_NEAR(quantile(Eigen::MatrixXd::Identity(count, count), std::vector<Directions>(count, {1, 1})),
              chi_squared_value(of_each, 1.0), tolerance);  // standard error 0.040: the density is 0.027
}

TEST(MaximumScore, EqualGroupsCountAsOne) {
  EXPECT_NEAR(quantile(Eigen::MatrixXd::Ones(5, 5), std::vector<Directions>(5, {1, 1})),
              chi_squared_value(1.0 - probability, 1.0), tolerance);
}

TEST(MaximumScore, GroupsOfSeveralDirectionsAreMeasuredAsOfOne) {
  EXPECT_NEAR(quantile(Eigen::MatrixXd::Identity(3, 3), {{3, 3}}), chi_squared_value(1.0 - probability, 1.0),
              tolerance);
}

TEST(MaximumScore, ImitatedGroupsDoNotCount) {
  EXPECT_EQ(quantile(Eigen::MatrixXd::Identity(2, 2), {{2, 0}}), 0.0);
}

}  // namespace
