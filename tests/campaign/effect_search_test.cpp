// The search for missing effects on columns that are made up, against dense least squares and known truths.
#include "campaign/effect_search.hpp"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "numerics/chi_squared.hpp"
#include "support/bins.hpp"

using namespace pcor::internal;
using pcor::FlightPartition;
using pcor::test::bin_step;

using pcor::Bounds;
using testing::AnyOf;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

namespace {

constexpr Eigen::Index base = 2;

/// Columns with memory, a base of a constant and a line, and a residual of noise to which effects are added.
struct Problem {
  std::vector<Binning> bins;
  Eigen::MatrixXd columns;
  Eigen::VectorXd residual;
  NoiseModel noise;
  std::vector<ColumnGroup> groups;
  WhitenedSystem scores;

  /// @param common how much of one series every column has; @param offset how much of the base is in the
  /// residual, hPa
  Problem(Eigen::Index rows, Eigen::Index candidates, unsigned seed, double common = 0.0, double offset = 0.0)
      : columns(rows, base + candidates), residual(rows) {
    bins.emplace_back(std::vector<double>(static_cast<std::size_t>(rows), 0.0), time(rows), bin_step);
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> normal;
    const auto series = [&](double memory) {
      Eigen::VectorXd values(rows);
      double value = normal(engine);
      for (double& each : values) {
        each = value;
        value = memory * value + std::sqrt(1.0 - memory * memory) * normal(engine);
      }
      return values;
    };
    columns.col(0).setOnes();
    columns.col(1).setLinSpaced(-1.0, 1.0);
    const Eigen::VectorXd shared = series(0.8);
    for (Eigen::Index c = 0; c < candidates; ++c)
      columns.col(base + c) = common * shared + std::sqrt(1.0 - common * common) * series(0.8);
    residual = offset * (3.0 * columns.col(0) - columns.col(1));
    for (double& each : residual) each += 0.5 * normal(engine);
    noise.level = {Eigen::VectorXd::Constant(rows, 0.5)};
  }

  static std::vector<double> time(Eigen::Index rows) {
    std::vector<double> time(static_cast<std::size_t>(rows));
    for (std::size_t i = 0; i < time.size(); ++i) time[i] = bin_step * static_cast<double>(i);
    return time;
  }

  /// The column of a candidate.
  Eigen::MatrixXd::ColXpr candidate(Eigen::Index c) { return columns.col(base + c); }

  /// Groups of as many columns each.
  void group_by(Eigen::Index count) {
    for (Eigen::Index c = 0; c < columns.cols() - base; c += count) {
      ColumnGroup& group = groups.emplace_back();
      group.first = c;
      group.count = count;
      group.effect = groups.size();
      group.bounds.resize(static_cast<std::size_t>(count));
    }
  }

  EffectSearch search() {
    if (groups.empty()) group_by(1);
    scores = whiten_system(FlightPartition(1), bins, {columns}, {residual}, noise);
    return EffectSearch(scores, base, groups);
  }
};

SearchResult run(Problem& problem, const SearchOptions& options = {}) {
  const EffectSearch search = problem.search();
  return search.run(options);
}

/// Coefficients of some columns by a dense decomposition, and their covariance for a noise of variance 1.
struct Dense {
  Eigen::VectorXd estimate;
  Eigen::MatrixXd covariance;
  double variance = 0.0;  // variance of the remaining residuals, in units of the noise

  Dense(const Problem& problem, const std::vector<Eigen::Index>& indices) {
    const Eigen::MatrixXd white = problem.columns(Eigen::all, indices) / problem.noise.level[0][0];
    const Eigen::VectorXd right = problem.residual / problem.noise.level[0][0];
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> decomposition(white);
    estimate = decomposition.solve(right);
    covariance = (white.transpose() * white).inverse();
    variance = (right - white * estimate).squaredNorm() /
               static_cast<double>(right.size() - static_cast<Eigen::Index>(indices.size()));
  }
};

}  // namespace

TEST(EffectSearch, FindsTheOnlyColumn) {
  for (const double size : {0.3, -0.3}) {
    Problem problem(600, 20, 1, 0.7);
    problem.residual += size * problem.candidate(7);
    const EffectSearch search = problem.search();
    const SearchResult result = search.run({});
    ASSERT_THAT(result.chosen, ElementsAre(7U));
    const GroupScore score = search.score(7, {});
    // The error of the estimate is about 0.5/sqrt(600 * 0.5) = 0.03.
    EXPECT_NEAR(score.estimate[0], size, 4.0 * std::sqrt(score.covariance(0, 0)));
    EXPECT_LT(std::sqrt(score.covariance(0, 0)), 0.04);
    EXPECT_GT(score.chi2, result.threshold);
    EXPECT_LT(result.p_values[0], 0.003);
  }
}

// A model whose own coefficients are off leaves much that they explain: it must not hide what is missing.
TEST(EffectSearch, BaseEffectsHideNoColumn) {
  for (const double offset : {0.0, 0.2, 1.0, 5.0}) {
    Problem problem(600, 20, 1, 0.7, offset);
    problem.residual += 0.3 * problem.candidate(7);
    EXPECT_THAT(run(problem).chosen, ElementsAre(7U)) << offset;
  }
}

TEST(EffectSearch, FindsAPair) {
  Problem problem(600, 20, 2, 0.5);
  problem.residual += 0.3 * problem.candidate(4) - 0.25 * problem.candidate(15);
  EXPECT_THAT(run(problem).chosen, UnorderedElementsAre(4U, 15U));
}

// The third explains more than each of the two alone, and no more than both together.
TEST(EffectSearch, FindsAPairDespiteAColumnNearTheirSum) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Problem problem(900, 12, seed);
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> normal;
    problem.candidate(9) = problem.candidate(2) + problem.candidate(5);
    for (double& each : problem.candidate(9)) each += 0.7 * normal(engine);
    problem.residual += 0.4 * (problem.candidate(2) + problem.candidate(5));
    ASSERT_GT(problem.search().score(9, {}).chi2, problem.search().score(2, {}).chi2);
    EXPECT_THAT(run(problem).chosen, UnorderedElementsAre(2U, 5U)) << seed;
  }
}

TEST(EffectSearch, StrongestEffectIsFirst) {
  Problem problem(900, 10, 3);
  problem.residual += 0.2 * problem.candidate(1) + 0.6 * problem.candidate(8);
  EXPECT_THAT(run(problem).chosen, ElementsAre(8U, 1U));
}

// The strong effect has 1,000 standard errors, the weak one 12: a relative error of 2 % of a linear search.
TEST(EffectSearch, AnEffectWithinTheErrorOfTheLinearSearchIsFoundAfterTheStrongOne) {
  Problem problem(600, 20, 3);
  problem.residual += 0.25 * problem.candidate(7);
  EXPECT_THAT(run(problem).chosen, ElementsAre(7));
  problem.residual += 20.0 * problem.candidate(4);
  EXPECT_THAT(run(problem).chosen, ElementsAre(4));
  problem.residual -= 20.0 * problem.candidate(4);
  EXPECT_THAT(run(problem).chosen, ElementsAre(7));
}

// Two similar effects of together 100 standard errors, each small compared with the other.
TEST(EffectSearch, OneOfTwoSimilarEffectsStaysBesideAStrongOne) {
  Problem problem(600, 20, 3);
  problem.candidate(8) = 0.98 * problem.candidate(7) + 0.2 * problem.candidate(8);
  problem.residual += 20.0 * problem.candidate(4) + problem.candidate(7) + problem.candidate(8);
  EXPECT_THAT(run(problem).chosen, ElementsAre(4, AnyOf(7, 8)));
}

// The same sizes, each effect seen by one of two references.
TEST(EffectSearch, AnEffectThatAnotherReferenceSeesIsNotAnErrorOfLinearity) {
  Problem problem(600, 20, 3);
  problem.candidate(4).tail(300).setZero();
  problem.candidate(7).head(300).setZero();
  problem.residual += 20.0 * problem.candidate(4) + 0.35 * problem.candidate(7);
  problem.group_by(1);
  const auto halves = [](const auto& all) {
    return std::vector<std::decay_t<decltype(all.eval())>>{all.topRows(300), all.bottomRows(300)};
  };
  std::vector<Binning> bins;
  for (int half = 0; half < 2; ++half)
    bins.emplace_back(std::vector<double>(300, 0.0), problem.time(300), bin_step);
  NoiseModel noise = problem.noise;
  noise.level = std::vector<Eigen::VectorXd>(2, Eigen::VectorXd::Constant(300, 0.5));
  const WhitenedSystem scores =
      whiten_system(FlightPartition(2), bins, halves(problem.columns), halves(problem.residual), noise);
  const EffectSearch search(scores, base, problem.groups);
  SearchOptions options;
  EXPECT_THAT(search.run(options).chosen, ElementsAre(4));
  options.references = {0, 1};
  EXPECT_THAT(search.run(options).chosen, ElementsAre(4, 7));
}

// One part in 40 is its own, 1/1600 of the variance: the base imitates it nearly, and yet it is seen.
TEST(EffectSearch, ColumnNearlyInTheBaseIsFound) {
  Problem problem(600, 5, 4);
  problem.candidate(3) = 40.0 * problem.columns.col(1) + 0.577 * problem.candidate(3);
  problem.residual += 2.0 * problem.candidate(3);
  const EffectSearch search = problem.search();
  EXPECT_FALSE(search.is_absorbed(3));
  EXPECT_NEAR(search.remaining(3), 0.577 * 0.577 / (1600.0 / 3.0), 2e-4);
  EXPECT_THAT(search.run({}).chosen, ElementsAre(3U));
}

TEST(EffectSearch, ColumnsInTheBaseAreAbsorbed) {
  Problem problem(600, 5, 4);
  // One part in 1e4 is its own: less than single precision holds of a column.
  problem.candidate(3) = 1e4 * problem.columns.col(1) + 0.577 * problem.candidate(3);
  problem.residual += 2.0 * problem.candidate(3);
  const EffectSearch search = problem.search();
  EXPECT_TRUE(search.is_absorbed(3));
  EXPECT_LT(search.remaining(3), 1e-6);
  EXPECT_EQ(search.score(3, {}).chi2, 0.0);
  EXPECT_THAT(search.run({}).chosen, testing::Not(testing::Contains(3U)));
  for (const std::size_t other : {0U, 1U, 2U, 4U}) {
    EXPECT_FALSE(search.is_absorbed(other));
    EXPECT_GT(search.remaining(other), 0.8);
  }
}

// The base imitates the larger column of the group, so that its part of the contribution does not count.
TEST(EffectSearch, RemainingShareIsThatOfTheWholeContribution) {
  Problem problem(2000, 5, 41);
  problem.candidate(0) = 2.0 * problem.columns.col(1);
  problem.group_by(1);
  problem.groups[0].count = 2;
  problem.groups[0].bounds = {Bounds{}, Bounds{}};
  problem.groups.erase(problem.groups.begin() + 1);
  const EffectSearch search = problem.search();
  const Eigen::Vector2d coefficients(3.0, 0.2);
  const Eigen::VectorXd whole = problem.columns.middleCols(base, 2) * coefficients;
  const Eigen::MatrixXd of_base = problem.columns.leftCols(base);
  const Eigen::VectorXd remaining = whole - of_base * of_base.colPivHouseholderQr().solve(whole);
  EXPECT_GT(search.remaining(0), 0.9) << "the best direction of the group is outside the base";
  EXPECT_NEAR(search.remaining(0, coefficients), remaining.squaredNorm() / whole.squaredNorm(),
              1e-9);  // rounding of sums of 2000 products
}

TEST(EffectSearch, EstimatesOutsideBoundsAreRejected) {
  Problem problem(600, 8, 5);
  problem.residual -= 0.5 * problem.candidate(3);
  problem.group_by(1);
  problem.groups[3].bounds = {{0.0, 1.0}};
  const EffectSearch search = problem.search();
  EXPECT_FALSE(search.score(3, {}).possible);
  EXPECT_THAT(search.run({}).chosen, testing::Not(testing::Contains(3U)));
  problem.groups[3].bounds = {{-1.0, 0.0}};
  EXPECT_THAT(problem.search().run({}).chosen, ElementsAre(3U));
}

TEST(EffectSearch, AnEstimateWithinTwoErrorsOfItsBoundIsPossible) {
  Problem problem(600, 3, 6);
  problem.residual += 0.3 * problem.candidate(1);
  problem.group_by(1);
  const GroupScore score = problem.search().score(1, {});
  const double error = std::sqrt(score.covariance(0, 0));
  problem.groups[1].bounds = {{score.estimate[0] + 1.9 * error, 10.0}};
  EXPECT_TRUE(problem.search().score(1, {}).possible);
  problem.groups[1].bounds = {{score.estimate[0] + 2.1 * error, 10.0}};
  EXPECT_FALSE(problem.search().score(1, {}).possible);
}

// An effect of a typical size is more likely than a nearly equal one at a hundred times its typical size.
TEST(EffectSearch, EffectOfTypicalSizeIsPreferred) {
  Problem problem(600, 6, 21);
  problem.candidate(2) = 0.99 * problem.candidate(1) + 0.14 * problem.candidate(2);
  problem.residual += 0.3 * problem.candidate(1);
  problem.group_by(1);
  problem.groups[1].typical = {0.3};
  problem.groups[2].typical = {0.003};
  const EffectSearch search = problem.search();
  EXPECT_GT(search.evidence({1}), search.evidence({2}) + 4.0);
  EXPECT_THAT(search.run({}).chosen, ElementsAre(1U));
  // But no size is impossible: without a rival, the effect is found.
  Problem alone(600, 6, 22);
  alone.residual += 0.3 * alone.candidate(2);
  alone.group_by(1);
  alone.groups[2].typical = {0.01};
  EXPECT_THAT(alone.search().run({}).chosen, ElementsAre(2U));
  // By GPS alone the atmosphere is a more likely cause of such a size.
  alone.groups[2].max_relative_size = 10.0;
  EXPECT_FALSE(alone.search().score(2, {}).possible);
  EXPECT_THAT(alone.search().run({}).chosen, IsEmpty());
  alone.groups[2].typical = {0.03};
  EXPECT_THAT(alone.search().run({}).chosen, ElementsAre(2U));
}

// The marginal likelihood of one column in normal noise of known size: chi2, size and error by the formula
// of conjugate normal distributions. That the size of the noise is not known adds chi2^2/n.
TEST(EffectSearch, EvidenceOfOneColumnEqualsTheFormula) {
  Problem problem(4000, 1, 23);
  problem.residual += 0.05 * problem.candidate(0);
  problem.group_by(1);
  problem.groups[0].typical = {0.05};
  const EffectSearch search = problem.search();
  const GroupScore score = search.score(0, {});
  const double v = score.covariance(0, 0);
  const double b = score.estimate[0];
  // Mixture prior: each share of all effects has sizes with this multiple of three typical sizes as spread.
  double known = 0.0;
  for (const auto& [times, share] :
       {std::pair{1.0, 0.65}, std::pair{0.1, 0.1}, std::pair{3.0, 0.2}, std::pair{10.0, 0.05}}) {
    const double tau2 = std::pow(times * 3.0 * 0.05, 2);
    const double one = b * b * tau2 / (2.0 * v * (v + tau2)) - 0.5 * std::log1p(tau2 / v);
    known = std::max(known, one + std::log(share));
  }
  EXPECT_NEAR(search.evidence({0}), known, 0.02 * known);
}

// A set of two is dearer than the one that does as much.
TEST(EffectSearch, OneEffectIsPreferredToAnEquivalentPair) {
  for (unsigned seed = 31; seed <= 40; ++seed) {
    Problem problem(900, 12, seed);
    problem.candidate(9) = problem.candidate(2) + problem.candidate(5);
    for (Eigen::Index i = 0; i < 900; i += 3) problem.candidate(9)[i] += 0.2;
    problem.residual += 0.4 * problem.candidate(9);
    EXPECT_THAT(run(problem).chosen, ElementsAre(9U)) << seed;
  }
}

TEST(EffectSearch, FindsAGroupOfTwoColumns) {
  Problem problem(600, 12, 7, 0.5);
  problem.group_by(2);
  problem.residual += 0.3 * problem.candidate(8) - 0.3 * problem.candidate(9);
  const EffectSearch search = problem.search();
  ASSERT_THAT(search.run({}).chosen, ElementsAre(4U));
  const GroupScore score = search.score(4, {});
  EXPECT_EQ(score.degrees_of_freedom, 2.0);
  EXPECT_LT(score.chi2_one_dof, score.chi2);
  EXPECT_NEAR(score.estimate[0], 0.3, 4.0 * std::sqrt(score.covariance(0, 0)));
  EXPECT_NEAR(score.estimate[1], -0.3, 4.0 * std::sqrt(score.covariance(1, 1)));
}

// Whose columns are one and the same has one direction.
TEST(EffectSearch, AGroupOfEqualColumnsHasOneDegreeOfFreedom) {
  Problem problem(600, 2, 8);
  problem.candidate(1) = 3.0 * problem.candidate(0);
  problem.residual += 0.5 * problem.candidate(0);
  problem.group_by(2);
  const EffectSearch search = problem.search();
  const GroupScore score = search.score(0, {});
  EXPECT_EQ(score.degrees_of_freedom, 1.0);
  // Together they are the effect; four errors of 0.02.
  EXPECT_NEAR(score.estimate[0] + 3.0 * score.estimate[1], 0.5, 0.1);
}

TEST(EffectSearch, OnlyOneShapeOfAnEffectIsChosen) {
  Problem problem(600, 6, 9);
  problem.residual += 0.4 * problem.candidate(0) + 0.4 * problem.candidate(1);
  problem.group_by(1);
  problem.groups[1].effect = problem.groups[0].effect;
  EXPECT_THAT(run(problem).chosen, testing::AnyOf(ElementsAre(0U), ElementsAre(1U)));
}

TEST(EffectSearch, EstimatesEqualDenseLeastSquares) {
  Problem problem(300, 6, 10, 0.6, 1.0);
  // Units differ: hPa, degrees, per mille.
  problem.candidate(2) *= 1e4;
  problem.candidate(5) *= 1e-5;
  problem.residual += 3e-5 * problem.candidate(2) - 2e4 * problem.candidate(5);
  const EffectSearch search = problem.search();
  const auto [estimate, covariance] = search.fit({2, 5});
  const Dense dense(problem, {0, 1, base + 2, base + 5});
  // Rounding of normal equations whose condition, with scaled columns, is below 1e3.
  for (Eigen::Index k = 0; k < 4; ++k) {
    EXPECT_NEAR(estimate[k], dense.estimate[k], 1e-9 * std::abs(dense.estimate[k])) << k;
    const double error = std::sqrt(dense.variance * dense.covariance(k, k));
    EXPECT_NEAR(std::sqrt(covariance(k, k)), error, 1e-8 * error) << k;
  }
  EXPECT_NEAR(search.variance({2, 5}), dense.variance, 1e-9 * dense.variance);
  EXPECT_NEAR(dense.variance, 1.0, 0.3);  // 300 samples: deviation 0.08

  // A score given another column: the same estimate, and its square over its variance.
  const GroupScore score = search.score(5, {2});
  EXPECT_NEAR(score.estimate[0], dense.estimate[3], 1e-8 * std::abs(dense.estimate[3]));
  const Dense without(problem, {0, 1, base + 2});
  EXPECT_NEAR(score.chi2, dense.estimate[3] * dense.estimate[3] / (without.variance * dense.covariance(3, 3)),
              1e-7 * score.chi2);
  EXPECT_NEAR(score.chi2, search.score(5, {5, 2}).chi2, 1e-9 * score.chi2);
}

// 0.3 % of flights without any effect may be claimed: 1.2 of 400, and more than 6 once in 4000 times.
TEST(EffectSearch, NoiseGivesNoFinding) {
  int claims = 0;
  double threshold = 0.0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    Problem problem(300, 30, 1000 + seed, 0.7);
    SearchOptions options;
    options.draws = 2000;
    options.seed = seed;
    const SearchResult result = run(problem, options);
    claims += result.chosen.empty() ? 0 : 1;
    threshold += result.threshold / 400.0;
  }
  EXPECT_LE(claims, 6);
  // For one column 0.3 % exceed 8.81, for thirty independent ones 15.1 (Bonferroni).
  EXPECT_GT(threshold, 8.81);
  EXPECT_LT(threshold, 15.3);
}

// Without the sign flips, which only remove findings, chance has its nominal rate: 20 of 400 at 5 %,
// deviation 4.4.
TEST(EffectSearch, ThresholdHasTheStatedFalseAlarmRate) {
  int above = 0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    Problem problem(300, 12, 5000 + seed, 0.7);
    SearchOptions options;
    options.draws = 2000;
    options.confidence = 0.95;
    options.seed = seed;
    const EffectSearch search = problem.search();
    const double threshold = search.run(options).threshold;
    double best = 0.0;
    for (std::size_t g = 0; g < 12; ++g) best = std::max(best, search.score(g, {}).chi2_one_dof);
    above += best > threshold ? 1 : 0;
  }
  EXPECT_GE(above, 20 - 14);
  EXPECT_LE(above, 20 + 14);
}

TEST(EffectSearch, NoiseWithHeavyTailsIsNotAnEffect) {
  int claims = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    Problem problem(300, 30, 9000 + seed, 0.5);
    // Three bins in a row that are ten times the noise: a single event.
    problem.residual.segment(100 + seed % 100, 3).array() += 5.0;
    SearchOptions options;
    options.draws = 1000;
    claims += run(problem, options).chosen.empty() ? 0 : 1;
  }
  // One event is not significant. Flipped signs let 5 % of such flights through, 10 of 200 with a deviation
  // of 3.1.
  EXPECT_LE(claims, 19);
}

// Draws in the directions of eigenvectors, which rounding errors choose, gave thresholds up to 7 % apart.
TEST(EffectSearch, ThresholdOfGroupsDoesNotDependOnRoundingErrors) {
  for (const Eigen::Index count : {1, 2, 3}) {
    std::vector<double> thresholds;
    for (const double disturbance : {0.0, 1e-15, -2e-15}) {
      Problem problem(600, 12, 5, 0.7);
      problem.group_by(count);
      for (Eigen::Index c = 0; c < 12; ++c)
        problem.candidate(c) *= 1.0 + disturbance * static_cast<double>(c);
      thresholds.push_back(run(problem).threshold);
    }
    EXPECT_NEAR(thresholds[1], thresholds[0], 1e-9) << count << ": rounding, amplified by the whitening";
    EXPECT_NEAR(thresholds[2], thresholds[0], 1e-9) << count;
  }
}

TEST(EffectSearch, RepeatedRunsGiveTheSameResult) {
  Problem problem(300, 20, 11, 0.5);
  problem.residual += 0.3 * problem.candidate(6);
  const SearchResult first = run(problem);
  const SearchResult second = run(problem);
  EXPECT_EQ(first.chosen, second.chosen);
  EXPECT_EQ(first.threshold, second.threshold);
  EXPECT_EQ(first.p_values, second.p_values);
}

TEST(EffectSearch, GivenThresholdAndMaximumNumberAreApplied) {
  Problem problem(600, 10, 12);
  for (Eigen::Index c = 0; c < 6; ++c) problem.residual += 0.5 * problem.candidate(c);
  SearchOptions options;
  options.threshold = 9.0;
  options.max_effects = 3;
  EXPECT_LE(run(problem, options).chosen.size(), 3U);
  options.threshold = 1e6;
  EXPECT_THAT(run(problem, options).chosen, IsEmpty());
}

TEST(EffectSearch, EmptySearchFindsNoColumn) {
  Problem problem(300, 0, 13);
  const EffectSearch search = problem.search();
  EXPECT_THAT(search.run({}).chosen, IsEmpty());
  EXPECT_NEAR(search.variance({}), 1.0, 0.4);
}

TEST(Correlation, SignIsThatOfTheColumns) {
  Problem problem(2000, 4, 14);
  problem.candidate(1) = 0.8 * problem.candidate(0) + 0.6 * problem.candidate(1);
  problem.candidate(2) = -0.8 * problem.candidate(0) + 0.6 * problem.candidate(2);
  const EffectSearch search = problem.search();
  // Samples with a memory of 0.8 count like 2000/9, so correlations of 0 have a deviation of 0.07.
  EXPECT_NEAR(search.correlation(0, 1, {}), 0.8, 0.1);
  EXPECT_NEAR(search.correlation(0, 2, {}), -0.8, 0.1);
  EXPECT_NEAR(search.correlation(1, 0, {}), search.correlation(0, 1, {}), 1e-12);
  EXPECT_NEAR(search.correlation(0, 3, {}), 0.0, 0.3);
  // The common part of the two is removed.
  EXPECT_NEAR(search.correlation(1, 2, {0}), 0.0, 0.3);
}

TEST(Correlation, UsesColumnsWithoutTheirPartInTheBase) {
  Problem problem(1000, 2, 15);
  Eigen::MatrixXd parts = problem.columns.rightCols(2);
  const Eigen::MatrixXd of_base = problem.columns.leftCols(2);
  parts -= of_base * of_base.householderQr().solve(parts);
  const double expected = parts.col(0).dot(parts.col(1)) / parts.col(0).norm() / parts.col(1).norm();
  problem.candidate(0) += 5.0 * problem.columns.col(1);
  problem.candidate(1) += 5.0 * problem.columns.col(1);
  EXPECT_NEAR(problem.search().correlation(0, 1, {}), expected, 1e-9);
}

TEST(RowsAfter, AreOrthogonalToBaseAndOtherFindings) {
  Problem problem(400, 6, 16, 0.7);
  problem.residual += 0.5 * problem.candidate(1) + 0.3 * problem.candidate(4);
  const EffectSearch search = problem.search();
  const Eigen::VectorXd rows = search.rows_after(1, {1, 4})[0];
  const Eigen::MatrixXd white = problem.columns / problem.noise.level[0][0];
  for (const Eigen::Index column : {Eigen::Index{0}, Eigen::Index{1}, base + 4})
    EXPECT_NEAR(rows.dot(white.col(column)) / rows.norm() / white.col(column).norm(), 0.0, 1e-9) << column;
  // Their product with the residual is the evidence, in units of the remaining noise.
  const double evidence = rows.dot(problem.residual) / problem.noise.level[0][0];
  const GroupScore score = search.score(1, {4});
  EXPECT_NEAR(evidence, score.chi2 * search.variance({4}), 1e-8 * evidence);
}

TEST(Chi2OneDof, HasTheSameTailProbability) {
  for (const double degrees_of_freedom : {1.0, 2.0, 3.0, 6.0}) {
    double before = -1.0;
    for (double chi2 = 0.0; chi2 < 900.0; chi2 += 0.5) {
      const double equivalent = chi2_one_dof(chi2, degrees_of_freedom);
      EXPECT_GE(equivalent, before);
      EXPECT_LE(equivalent, chi2 + 1e-12);
      before = equivalent;
      if (chi2 > 0.0 && chi2 < 500.0) {
        const double tail = chi_squared_tail(chi2, degrees_of_freedom);
        EXPECT_NEAR(chi_squared_tail(equivalent, 1.0), tail, 1e-7 * tail)
            << degrees_of_freedom << " " << chi2;
      }
    }
  }
  // Tables: 5 % of two degrees is 5.991, of one 3.841.
  EXPECT_NEAR(chi2_one_dof(5.991, 2.0), 3.841, 1e-3);
  EXPECT_NEAR(chi_squared_tail(12.592, 6.0), 0.05, 1e-5);
}

// An effect whose shape in nature differs from the formula leaves a rest; a second effect that resembles that
// rest is not named where the uncertainty of the shape explains it, and another second effect is.
TEST(EffectSearch, UncertainShapeIsNotASecondEffect) {
  Problem problem(600, 4, 31);
  const Eigen::VectorXd rest = problem.candidate(3);  // column of the uncertain shape of the first effect
  problem.candidate(1) = rest + 0.2 * problem.candidate(1);
  problem.residual += 2.0 * problem.candidate(0) + 0.5 * rest + 0.4 * problem.candidate(2);
  problem.group_by(1);
  problem.groups.pop_back();
  const EffectSearch exact = problem.search();
  EXPECT_THAT(exact.run({}).chosen, UnorderedElementsAre(0U, 1U, 2U));
  const double evidence = exact.score(0, {}).chi2;
  problem.groups[0].shape_first = 3;
  problem.groups[0].shape_count = 1;
  const EffectSearch search = problem.search();
  EXPECT_THAT(search.run({}).chosen, UnorderedElementsAre(0U, 2U));
  // The first effect keeps its evidence.
  EXPECT_DOUBLE_EQ(search.score(0, {}).chi2, evidence);
}

// A column of an uncertain shape that is zero except for rounding changes no result.
TEST(EffectSearch, ShapeOfRoundingErrorsExplainsNothing) {
  Problem problem(600, 4, 31);
  problem.residual += 2.0 * problem.candidate(0) + 0.4 * problem.candidate(2);
  problem.candidate(3) *= 1e-15;
  problem.group_by(1);
  problem.groups.pop_back();
  const double variance = problem.search().variance({0, 2});
  const double evidence = problem.search().evidence({0, 2});
  problem.groups[0].shape_first = 3;
  problem.groups[0].shape_count = 1;
  const EffectSearch search = problem.search();
  EXPECT_DOUBLE_EQ(search.variance({0, 2}), variance);
  EXPECT_DOUBLE_EQ(search.evidence({0, 2}), evidence);
}

// An effect that resembles the uncertain shape of one finding is not a rival of another finding.
TEST(EffectSearch, UncertainShapeIsNotARivalOfAnotherFinding) {
  Problem problem(600, 4, 31);
  const Eigen::VectorXd rest = problem.candidate(3);
  problem.candidate(1) = rest + 0.2 * problem.candidate(1);
  problem.residual += 2.0 * problem.candidate(0) + 0.8 * rest + 0.4 * problem.candidate(2);
  problem.group_by(1);
  problem.groups.pop_back();
  problem.groups[0].shape_first = 3;
  problem.groups[0].shape_count = 1;
  const EffectSearch search = problem.search();
  EXPECT_GT(search.evidence({0, 1}, {}), search.evidence({0, 2}, {}));
  EXPECT_GT(search.evidence({0, 2}, {0}), search.evidence({0, 1}, {0}) + 10.0);
}

// The typical shape of an effect is preferred on its own system; another system is another finding.
TEST(EffectSearch, UsualShapeIsPreferredOnlyOnTheSameSystem) {
  Problem problem(600, 2, 31);
  problem.candidate(1) = problem.candidate(0) + 0.03 * problem.candidate(1);
  problem.residual += 1.0 * problem.candidate(1);
  problem.group_by(1);
  problem.groups[1].effect = problem.groups[0].effect;
  EXPECT_THAT(run(problem).chosen, ElementsAre(0U));
  problem.groups[1].system = 1;
  EXPECT_THAT(run(problem).chosen, ElementsAre(1U));
}
