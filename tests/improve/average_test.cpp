#include "improve/average.hpp"

#include <gtest/gtest.h>
#include <pcor/roles/with_effects.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "support/made_samples.hpp"

using pcor::ModelFile;
using pcor::internal::averaged;
using pcor::internal::harmless_share;
using pcor::internal::Mixture;
using pcor::internal::spread_of;

namespace {

using Series = std::vector<double>;

/// A model with static-constant a0 and one other static effect of one coefficient, with their deviations.
ModelFile model(double a0, double a0_error, const std::string& effect, double value, double error) {
  ModelFile file = pcor::with_effects(made::model({"static-constant"}), {{effect, {value}}});
  file.model.effects[0].parameters = {a0};
  file.fits = {{{false, a0_error}}, {{false, error}}};
  return file;
}

/// Variance of u * a0 + v * b + w * c.
double variance(const ModelFile& file, const std::vector<double>& weights) {
  const std::vector<double> covariance = uncertainty_of(file).covariance;
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    for (std::size_t j = 0; j < weights.size(); ++j)
      sum += weights[i] * weights[j] * covariance[i * weights.size() + j];
  }
  return sum;
}

double rms_off(const Series& a, double share, const Series& mean) {
  double squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) squares += std::pow(share * mean[i] - a[i], 2);
  return std::sqrt(squares / static_cast<double>(a.size()));
}

}  // namespace

TEST(Averaged, HasTheMomentsOfTheMixture) {
  const ModelFile one = model(0.004, 0.0002, "static-mach", 0.01, 0.001);
  const ModelFile other = model(0.006, 0.0001, "static-beta-odd", -0.02, 0.003);
  const ModelFile mean = averaged(one, {{{{one, 0.7}, {other, 0.3}}}});
  ASSERT_EQ(mean.model.effects.size(), 3U);
  // What the models say of delta-p where the three effects are `weights` of their coefficients.
  const std::vector<double> weights{1.0, 0.35, 0.1};
  const double of_one = 0.004 + 0.35 * 0.01;
  const double of_other = 0.006 - 0.1 * 0.02;
  double of_mean = 0.0;
  for (std::size_t e = 0; e < 3; ++e) of_mean += weights[e] * mean.model.effects[e].parameters[0];
  EXPECT_NEAR(of_mean, 0.7 * of_one + 0.3 * of_other, 1e-15);
  // The law of total variance.
  const double within = 0.7 * (std::pow(0.0002, 2) + std::pow(0.35 * 0.001, 2)) +
                        0.3 * (std::pow(0.0001, 2) + std::pow(0.1 * 0.003, 2));
  const double between = 0.7 * 0.3 * std::pow(of_one - of_other, 2);
  EXPECT_NEAR(variance(mean, weights), within + between, 1e-12 * within);
  EXPECT_FALSE(mean.fit(0, 0).fixed);
  EXPECT_TRUE(mean.fit(1, 0).fixed);
  EXPECT_TRUE(mean.fit(2, 0).fixed);
}

TEST(Averaged, KnowsOfWhatIsNotApplied) {
  const ModelFile one = model(0.004, 0.0, "static-mach", 0.01, 0.0);
  const ModelFile other = model(0.004, 0.0, "static-mach", -0.006, 0.0);
  ModelFile without = model(0.004, 0.0, "static-mach", 0.0, 0.0);
  for (const double share : {0.0, 0.4, 1.0}) {
    const ModelFile mean = averaged(one, {{{{one, 0.75}, {other, 0.25}}, without, share}});
    const double delivered = share * (0.75 * 0.01 - 0.25 * 0.006);
    EXPECT_NEAR(mean.model.effects[1].parameters[0], delivered, 1e-15) << share;
    const double square = 0.75 * std::pow(0.01 - delivered, 2) + 0.25 * std::pow(-0.006 - delivered, 2);
    EXPECT_NEAR(*mean.fit(1, 0).standard_error, std::sqrt(square), 1e-12) << share;
  }
}

TEST(Averaged, OfOneModelIsThatModel) {
  const ModelFile one = model(0.004, 0.0002, "static-mach", 0.01, 0.001);
  const ModelFile same = averaged(one, {{{{one, 1.0}}}});
  EXPECT_EQ(same.model.effects[1].parameters, one.model.effects[1].parameters);
  EXPECT_NEAR(*same.fit(1, 0).standard_error, 0.001, 1e-15);
  EXPECT_FALSE(same.fit(1, 0).fixed);
}

TEST(Averaged, IndependentMixturesAddTheirDifferences) {
  ModelFile best = model(0.004, 0.0, "static-mach", 0.01, 0.0);
  best = pcor::with_effects(best, {{"static-beta-odd", {0.03}}});
  ModelFile without_mach = best;
  without_mach.model.effects[1].parameters = {0.0};
  ModelFile without_beta = best;
  without_beta.model.effects[2].parameters = {0.0};
  const ModelFile mean =
      averaged(best, {{{{best, 0.75}, {without_mach, 0.25}}}, {{{best, 0.5}, {without_beta, 0.5}}}});
  EXPECT_NEAR(mean.model.effects[0].parameters[0], 0.004, 1e-15);
  EXPECT_NEAR(mean.model.effects[1].parameters[0], 0.0075, 1e-15);
  EXPECT_NEAR(mean.model.effects[2].parameters[0], 0.015, 1e-15);
  // Two-point distributions: the deviation is the difference times the root of the product of the weights.
  EXPECT_NEAR(*mean.fit(1, 0).standard_error, 0.01 * std::sqrt(0.75 * 0.25), 1e-12);
  EXPECT_NEAR(*mean.fit(2, 0).standard_error, 0.03 * 0.5, 1e-12);
}

TEST(HarmlessShare, IsAllOfWhatRivalsAgreeOn) {
  EXPECT_EQ(harmless_share({{1.0, 1.2, 0.8}}, {1.0}, 0.0), 1.0);
  EXPECT_EQ(harmless_share({{1.0, 1.2, 0.8}, {1.1, 1.0, 0.9}}, {0.4, 0.6}, 0.0), 1.0);
  EXPECT_EQ(harmless_share({{0.0, 0.0}, {0.0, 0.0}}, {0.4, 0.6}, 0.0), 1.0);
}

TEST(HarmlessShare, IsNothingWhereARivalWantsNothingOrTheOpposite) {
  EXPECT_EQ(harmless_share({{1.0, 1.2, 0.8}, {0.0, 0.0, 0.0}}, {0.9, 0.1}, 0.0), 0.0);
  EXPECT_EQ(harmless_share({{1.0, 1.2, 0.8}, {-0.5, -0.6, -0.4}}, {0.9, 0.1}, 0.0), 0.0);
}

TEST(HarmlessShare, GoesAsFarAsNoRivalIsWorseOff) {
  const std::vector<Series> rivals{{1.0, 1.2, 0.8}, {0.2, -0.1, 0.3}, {0.5, 0.1, 0.4}};
  const std::vector<double> weights{0.6, 0.3, 0.1};
  for (const double tolerance : {0.0, 0.03, 0.1}) {
    const double share = harmless_share(rivals, weights, tolerance);
    Series mean(3, 0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < 3; ++i) mean[i] += weights[k] * rivals[k][i];
    }
    double worst = -1.0;
    for (const Series& rival : rivals)
      worst = std::max(worst, rms_off(rival, share, mean) - rms_off(rival, 0.0, mean) - tolerance);
    EXPECT_NEAR(worst, 0.0, 1e-12) << "one rival is at its limit, none beyond";
    EXPECT_GT(share, 0.0);
    EXPECT_LT(share, 1.0);
  }
}

TEST(HarmlessShare, LeavesOutWhatIsMissing) {
  EXPECT_EQ(harmless_share({{1.0, NAN}, {1.2, NAN}}, {0.5, 0.5}, 0.0), 1.0);
}

TEST(SpreadOf, IsTheDeviationBetweenRivals) {
  EXPECT_NEAR(spread_of({{1.0, 1.0}, {2.0, 2.0}}, {0.5, 0.5}), 0.5, 1e-15);
  EXPECT_EQ(spread_of({{1.0, 3.0}, {1.0, 3.0}}, {0.5, 0.5}), 0.0);
}
