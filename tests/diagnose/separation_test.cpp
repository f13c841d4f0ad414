// Separation by more flying, compared with probabilities by simulation and with laws of repeated regimes;
// samples of each regime that the flights flew.
#include "diagnose/separation.hpp"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <pcor/effects/catalogue.hpp>
#include "support/bins.hpp"

namespace pcor::internal {
namespace {

using test::bin_step;
using testing::HasSubstr;
using testing::Not;

enum : Eigen::Index { base, effect, rival, columns };

/// Rows in which the columns of effect and rival have a given correlation.
Eigen::MatrixXd rows_of(Eigen::Index count, double correlation, unsigned seed = 1) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd rows = Eigen::MatrixXd::NullaryExpr(
      count, columns, [&](Eigen::Index, Eigen::Index) { return normal(engine); });
  rows.col(rival) =
      correlation * rows.col(effect) + std::sqrt(1.0 - correlation * correlation) * rows.col(rival);
  return rows;
}

RegimeStatistics regime_of(Regime regime, const Eigen::MatrixXd& rows, double duration = 90.0) {
  return {regime, duration, rows.transpose() * rows, "second.nc"};
}

SeparationProblem rivalry_of(const Eigen::MatrixXd& rows, double size) {
  return {rows.transpose() * rows, 1.0, {effect}, Eigen::VectorXd::Constant(1, size), {{base, rival}}};
}

/// The sum of squares that a fit of some columns leaves.
double residual_squares(const Eigen::MatrixXd& rows, const std::vector<Eigen::Index>& fitted,
                        const Eigen::VectorXd& residual) {
  const Eigen::MatrixXd some = rows(Eigen::all, fitted);
  const Eigen::VectorXd estimate = (some.transpose() * some).ldlt().solve(some.transpose() * residual);
  return (residual - some * estimate).squaredNorm();
}

// A rival is separated where chi2 rises by more than 9 with it in the place of the effect.
TEST(Separation, PredictedProbabilityEqualsSimulatedFrequency) {
  constexpr int draws = 2000;
  const Eigen::MatrixXd now = rows_of(200, 0.99, 1);
  const Eigen::MatrixXd more = rows_of(100, 0.95, 2);
  for (const double size : {0.8, 1.0}) {
    const std::vector<RegimeStatistics> regimes{regime_of(Regime::circle, more)};
    const Plan plan = best_plan(regimes, rivalry_of(now, size));
    ASSERT_NE(plan.regime, nullptr);
    Eigen::MatrixXd all(now.rows() + plan.repeats * more.rows(), columns);
    all.topRows(now.rows()) = now;
    for (int i = 0; i < plan.repeats; ++i) all.middleRows(now.rows() + i * more.rows(), more.rows()) = more;
    std::mt19937_64 engine(3);
    std::normal_distribution<double> normal;
    int separated = 0;
    for (int draw = 0; draw < draws; ++draw) {
      const Eigen::VectorXd residual =
          size * all.col(effect) +
          Eigen::VectorXd::NullaryExpr(all.rows(), [&](Eigen::Index) { return normal(engine); });
      if (residual_squares(all, {base, rival}, residual) - residual_squares(all, {base, effect}, residual) >
          9.0)
        ++separated;
    }
    EXPECT_NEAR(plan.power, static_cast<double>(separated) / draws, 0.03) << size;
  }
}

TEST(Separation, RepeatsEqualLongerIntervals) {
  const SeparationProblem rivalry = rivalry_of(rows_of(100, 0.99), 0.5);
  double before = 0.0;
  for (const int length : {100, 200, 400, 800}) {
    const std::vector<RegimeStatistics> once{regime_of(Regime::circle, rows_of(length, 0.97, 4))};
    const Plan plan = best_plan(once, rivalry);
    const double power = std::min(plan.power, 0.95);  // power at which no more repeats are needed
    EXPECT_GE(power, before) << length;
    EXPECT_LE(power, 1.0);
    before = power;
    if (power < 0.95) continue;
    RegimeStatistics joined = once.front();
    joined.information *= plan.repeats;
    joined.duration *= plan.repeats;
    const std::vector<RegimeStatistics> of_joined{joined};
    const Plan longer = best_plan(of_joined, rivalry);
    EXPECT_EQ(longer.repeats, 1);
    EXPECT_DOUBLE_EQ(longer.power, plan.power);
    EXPECT_DOUBLE_EQ(longer.duration(), plan.duration());
  }
  EXPECT_EQ(before, 0.95);
}

TEST(Separation, PlanUsesTheRegimeWithMostInformationPerTime) {
  const SeparationProblem rivalry = rivalry_of(rows_of(100, 0.99), 1.0);
  const Eigen::MatrixXd rows = rows_of(200, 0.7, 5);
  std::vector<RegimeStatistics> regimes{regime_of(Regime::climb, rows_of(800, 0.9, 6), 1200.0),
                                        regime_of(Regime::circle, rows, 160.0)};
  Plan plan = best_plan(regimes, rivalry);
  ASSERT_EQ(plan.regime, &regimes[1]);
  EXPECT_THAT(advice_of(plan, "static-lag", neutral_effect("static-lag"), {"temp-lag"}).sentence,
              HasSubstr("fly 1 more circle of 2.7 min as on second.nc"));
  regimes[1].duration = 16000.0;
  plan = best_plan(regimes, rivalry);
  ASSERT_EQ(plan.regime, &regimes[0]);
}

TEST(Separation, WorstRivalDeterminesThePlan) {
  const Eigen::MatrixXd rows = rows_of(100, 0.99);
  const std::vector<RegimeStatistics> regimes{regime_of(Regime::yaw_manoeuvre, rows_of(400, 0.9, 7))};
  SeparationProblem rivalry = rivalry_of(rows, 1.0);
  const Plan of_one = best_plan(regimes, rivalry);
  rivalry.rests.push_back({base});  // a rival that imitates no effect
  const Plan of_two = best_plan(regimes, rivalry);
  EXPECT_EQ(of_two.repeats, of_one.repeats);
  EXPECT_EQ(of_two.power, of_one.power);
  const std::string text =
      advice_of(of_two, "static-lag", neutral_effect("static-lag"), {"temp-lag", "total-lag"}).sentence;
  EXPECT_THAT(text, HasSubstr("more yaw manoeuvre"));
  EXPECT_THAT(text, HasSubstr("static-lag from temp-lag and total-lag"));
}

TEST(Separation, CatalogueAdvisesIfNoRegimeHelps) {
  const ModelEffect lag = neutral_effect("static-lag");
  const std::string manoeuvre(effect_named("static-lag")->manoeuvre);
  const SeparationProblem rivalry = rivalry_of(rows_of(100, 1.0), 5.0);
  const std::vector<RegimeStatistics> indistinguishable{
      regime_of(Regime::pitch_manoeuvre, rows_of(100, 1.0, 8))};
  for (const std::vector<RegimeStatistics>& regimes : {indistinguishable, std::vector<RegimeStatistics>{}}) {
    const Plan plan = best_plan(regimes, rivalry);
    EXPECT_EQ(plan.regime, nullptr);
    EXPECT_EQ(plan.power, 0.0);
    // The manoeuvres of the catalogue separate effects, not systems.
    EXPECT_THAT(advice_of({}, "static-lag", lag, {"temp-lag", "reference:static-lag"}).sentence,
                HasSubstr("--reference"));
    const std::string text = advice_of(plan, "reference:static-lag", lag, {"temp-lag"}).sentence;
    EXPECT_THAT(text, HasSubstr(manoeuvre));
    EXPECT_THAT(text, Not(HasSubstr("%")));
  }
  ModelEffect user_effect;
  user_effect.id = "my-thrust";
  user_effect.formula = "k * ENGTRQ";
  EXPECT_THAT(general_advice("my-thrust", user_effect), testing::IsEmpty());
}

// More of the same regimes is not advised if the flights already nearly separate the effect.
TEST(Separation, RegimeWithLittleInformationIsNotAdvised) {
  const Eigen::MatrixXd rows = rows_of(300, 0.9);
  const std::vector<RegimeStatistics> nothing{regime_of(Regime::turn, 1e-3 * rows_of(10, 0.5, 9))};
  for (const double size : {0.4, 0.5})
    EXPECT_EQ(best_plan(nothing, rivalry_of(rows, size)).regime, nullptr) << size;
}

constexpr Eigen::Index width = 3;

/// Flights of 1000 s, with rows at random.
class FlownFlights {
 public:
  void fly(const std::string& name, const std::vector<Interval>& intervals, double masked_from = 1000.0,
           std::size_t reference = 0) {
    std::vector<double> given;
    auto samples = std::make_shared<FlightSamples>();
    samples->name = name;
    samples->intervals = intervals;
    for (double time = 0.0; time < 1000.0; time += bin_step) {
      samples->time.push_back(time);
      given.push_back(time < masked_from ? 0.0 : std::numeric_limits<double>::quiet_NaN());
    }
    bins_.emplace_back(given, samples->time, bin_step);
    FlightColumns& flight = columns_.emplace_back();
    flight.samples = samples;
    flight.reference = reference;
    scores_.bin.emplace_back();
    scores_.rows.emplace_back(
        Eigen::MatrixXd::NullaryExpr(static_cast<Eigen::Index>(bins_.back().size()), width + 1,
                                     [this](Eigen::Index, Eigen::Index) { return normal_(engine_); }));
  }

  std::vector<RegimeStatistics> regimes() {
    scores_.partition = FlightPartition(columns_.size());
    return regime_statistics(scores_, [this](std::size_t f) { return FlightInBins{columns_[f], bins_[f]}; });
  }

  /// Rows between two times.
  Eigen::MatrixXd information(std::size_t flight, double begin, double end) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(width, width);
    for (std::size_t i = 0; i < bins_[flight].size(); ++i) {
      const double time = bins_[flight].time()[i];
      const Eigen::VectorXd row = scores_.rows[flight].row(static_cast<Eigen::Index>(i)).head(width);
      if (time >= begin && time < end) sum += row * row.transpose();
    }
    return sum;
  }

 private:
  std::mt19937_64 engine_{1};
  std::normal_distribution<double> normal_;
  std::vector<FlightColumns> columns_;
  std::vector<Binning> bins_;
  WhitenedSystem scores_;
};

const Interval ground{Regime::ground, 0.0, 100.0};
const Interval climb{Regime::climb, 100.0, 900.0};

TEST(StatisticsOfRegimes, DurationAndInformationAreMeansOverIntervals) {
  FlownFlights flights;
  flights.fly("first.nc", {ground, {Regime::level, 100.0, 900.0}, {Regime::yaw_manoeuvre, 200.0, 320.0}});
  flights.fly("second.nc",
              {ground, {Regime::yaw_manoeuvre, 200.0, 300.0}, {Regime::yaw_manoeuvre, 500.0, 580.0}});
  const std::vector<RegimeStatistics> regimes = flights.regimes();
  ASSERT_EQ(regimes.size(), 1U) << "neither on the ground nor level";
  const RegimeStatistics& yaw = regimes[0];
  EXPECT_EQ(yaw.regime, Regime::yaw_manoeuvre);
  EXPECT_DOUBLE_EQ(yaw.duration, 100.0);
  EXPECT_EQ(yaw.flight, "second.nc");
  const Eigen::MatrixXd sum = flights.information(0, 200.0, 320.0) + flights.information(1, 200.0, 300.0) +
                              flights.information(1, 500.0, 580.0);
  EXPECT_TRUE(yaw.information.isApprox(sum / 3.0));
}

TEST(StatisticsOfRegimes, TurnWithinAClimbIsCountedSeparately) {
  FlownFlights flights;
  flights.fly("first.nc", {ground, climb, {Regime::turn, 200.0, 400.0}});
  const std::vector<RegimeStatistics> regimes = flights.regimes();
  ASSERT_EQ(regimes.size(), 2U);
  EXPECT_EQ(regimes[0].regime, Regime::climb);
  EXPECT_DOUBLE_EQ(regimes[0].duration, 600.0);
  EXPECT_DOUBLE_EQ(regimes[1].duration, 200.0);
  EXPECT_TRUE(
      (regimes[0].information + regimes[1].information).isApprox(flights.information(0, 100.0, 900.0)));
}

TEST(StatisticsOfRegimes, RegimesWithoutSamplesAreOmitted) {
  FlownFlights flights;
  flights.fly("first.nc", {ground, climb, {Regime::circle, 700.0, 850.0}}, 600.0);
  const std::vector<RegimeStatistics> regimes = flights.regimes();
  ASSERT_EQ(regimes.size(), 1U);
  EXPECT_EQ(regimes[0].regime, Regime::climb);
}

TEST(StatisticsOfRegimes, FlightWithTwoReferencesCountsOnce) {
  FlownFlights flights;
  flights.fly("first.nc", {climb});
  flights.fly("first.nc", {climb}, 1000.0, 1);
  const std::vector<RegimeStatistics> regimes = flights.regimes();
  ASSERT_EQ(regimes.size(), 1U);
  EXPECT_DOUBLE_EQ(regimes[0].duration, 800.0);
  EXPECT_TRUE(regimes[0].information.isApprox(flights.information(0, 100.0, 900.0) +
                                              flights.information(1, 100.0, 900.0)));
}

}  // namespace
}  // namespace pcor::internal
