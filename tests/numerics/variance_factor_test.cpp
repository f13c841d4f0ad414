#include "numerics/variance_factor.hpp"

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <cmath>
#include <random>
#include <vector>

using pcor::internal::part_of_rows;
using pcor::internal::variance_factor;

namespace {

constexpr Eigen::Index rows_of_part = 50;
constexpr Eigen::Index columns = 3;

struct Fit {
  std::vector<pcor::internal::InformationPart> parts{};
  Eigen::MatrixXd covariance{};
};

/// Fit to parts of 50 white rows. @param errors of the coefficients in each part, alternating in sign
/// @param deviation of the noise @param scale of the columns, whose coefficients have other units
Fit fit_of(int parts, const Eigen::Vector3d& errors, double deviation, const Eigen::Vector3d& scale,
           unsigned seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<Eigen::MatrixXd> products;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(columns + 1, columns + 1);
  for (int part = 0; part < parts; ++part) {
    Eigen::MatrixXd rows =
        Eigen::MatrixXd::NullaryExpr(rows_of_part, columns + 1, [&](auto...) { return normal(engine); });
    rows.col(columns) *= deviation;
    rows.col(columns) += (part % 2 == 0 ? 1.0 : -1.0) * rows.leftCols(columns) * errors;
    rows.leftCols(columns) *= scale.asDiagonal();
    products.emplace_back(rows.transpose() * rows);
    sum += products.back();
  }
  Fit fit;
  fit.covariance = sum.topLeftCorner(columns, columns).inverse();
  const Eigen::VectorXd solution = fit.covariance * sum.col(columns).head(columns);
  for (const Eigen::MatrixXd& each : products) fit.parts.push_back(part_of_rows(each, solution));
  return fit;
}

double factor_of(const Fit& fit, Eigen::Index count, double before = 1.0) {
  return variance_factor(fit.parts, fit.covariance, count, before);
}

TEST(VarianceFactor, IsOneWherePartsAgree) {
  double sum = 0.0;
  constexpr int fits = 200;
  for (unsigned seed = 0; seed < fits; ++seed)
    sum += factor_of(fit_of(8, {0, 0, 0}, 1.0, {1, 1, 1}, seed), columns);
  // The factor is never below 1; chi2 of 24 degrees of freedom, with four of the prior, exceeds its mean by
  // 0.1.
  EXPECT_NEAR(sum / fits, 1.1, 0.05);
}

TEST(VarianceFactor, IsTheVarianceOfTheNoise) {
  double sum = 0.0;
  constexpr int fits = 50;
  for (unsigned seed = 0; seed < fits; ++seed)
    sum += factor_of(fit_of(20, {0, 0, 0}, 5.0, {1, 1, 1}, seed), columns);
  // The prior has 4 of 64 degrees of freedom; the mean of 50 variances from 60 each has an error of 2.6 %.
  EXPECT_NEAR(sum / fits, (4.0 + 60.0 * 25.0) / 64.0, 3.0 * 0.026 * 25.0);
}

TEST(VarianceFactor, SeesPartsThatDisagree) {
  // Half of the parts differ from the others by 2 * 0.5, each with a standard error of 1 / sqrt(50).
  EXPECT_GT(factor_of(fit_of(8, {0.5, 0.5, 0.5}, 1.0, {1, 1, 1}, 1), columns), 8.0);
}

TEST(VarianceFactor, DoesNotDependOnUnits) {
  const double factor = factor_of(fit_of(4, {0.5, 0.5, 0.5}, 1.0, {1, 1, 1}, 1), columns);
  // Rounding of sums of 200 rows whose squares differ by 16 orders of magnitude.
  EXPECT_NEAR(factor_of(fit_of(4, {0.5, 0.5, 0.5}, 1.0, {1e-4, 1.0, 1e4}, 1), columns), factor,
              1e-4 * factor);
}

TEST(VarianceFactor, CountsTheFactorThatRowsContain) {
  Fit fit = fit_of(8, {0.5, 0.5, 0.5}, 1.0, {1, 1, 1}, 1);
  const double factor = factor_of(fit, columns);
  constexpr double before = 3.0;
  for (auto& [information, score] : fit.parts) {
    information /= before;
    score /= before;
  }
  fit.covariance *= before;
  EXPECT_NEAR(factor_of(fit, columns, before), factor, 1e-9 * factor);  // the same sums, rounded
}

TEST(VarianceFactor, IgnoresNuisances) {
  const Fit fit = fit_of(8, {0, 0, 1}, 1.0, {1, 1, 1}, 1);
  EXPECT_GT(factor_of(fit, columns), 5.0 * factor_of(fit, columns - 1));
}

}  // namespace
