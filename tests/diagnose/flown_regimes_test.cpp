// Samples of each regime that the flights flew.
#include "diagnose/flown_regimes.hpp"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace pcor::internal {
namespace {

constexpr double step = 4.0;  // s: every record is a bin
constexpr Eigen::Index width = 3;

/// Flights of 1000 s, with rows at random.
class Flights {
 public:
  void fly(const std::string& name, const std::vector<Interval>& intervals, double masked_from = 1000.0,
           std::size_t reference = 0) {
    std::vector<double> given;
    auto samples = std::make_shared<FlightSamples>();
    samples->name = name;
    samples->intervals = intervals;
    for (double time = 0.0; time < 1000.0; time += step) {
      samples->time.push_back(time);
      given.push_back(time < masked_from ? 0.0 : std::numeric_limits<double>::quiet_NaN());
    }
    bins_.emplace_back(given, samples->time, step);
    FlightColumns columns;
    columns.samples = samples;
    columns.reference = reference;
    columns_.push_back(std::move(columns));
    scores_.bin.emplace_back();
    scores_.rows.emplace_back(
        Eigen::MatrixXd::NullaryExpr(static_cast<Eigen::Index>(bins_.back().size()), width + 1,
                                     [this](Eigen::Index, Eigen::Index) { return normal_(engine_); }));
  }

  std::vector<FlownRegime> regimes() {
    scores_.share = FlightPartition(columns_.size());
    return flown_regimes(scores_, [this](std::size_t f) { return FlightInBins{columns_[f], bins_[f]}; });
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

TEST(FlownRegimes, DurationAndInformationAreMeansOverIntervals) {
  Flights flights;
  flights.fly("first.nc", {ground, {Regime::level, 100.0, 900.0}, {Regime::yaw_manoeuvre, 200.0, 320.0}});
  flights.fly("second.nc",
              {ground, {Regime::yaw_manoeuvre, 200.0, 300.0}, {Regime::yaw_manoeuvre, 500.0, 580.0}});
  const std::vector<FlownRegime> regimes = flights.regimes();
  ASSERT_EQ(regimes.size(), 1U) << "neither on the ground nor level";
  const FlownRegime& yaw = regimes[0];
  EXPECT_EQ(yaw.regime, Regime::yaw_manoeuvre);
  EXPECT_DOUBLE_EQ(yaw.duration, 100.0);
  EXPECT_EQ(yaw.flight, "second.nc");
  const Eigen::MatrixXd sum = flights.information(0, 200.0, 320.0) + flights.information(1, 200.0, 300.0) +
                              flights.information(1, 500.0, 580.0);
  EXPECT_TRUE(yaw.information.isApprox(sum / 3.0));
}

TEST(FlownRegimes, TurnWithinAClimbIsCountedSeparately) {
  Flights flights;
  flights.fly("first.nc", {ground, climb, {Regime::turn, 200.0, 400.0}});
  const std::vector<FlownRegime> regimes = flights.regimes();
  ASSERT_EQ(regimes.size(), 2U);
  EXPECT_EQ(regimes[0].regime, Regime::climb);
  EXPECT_DOUBLE_EQ(regimes[0].duration, 600.0);
  EXPECT_DOUBLE_EQ(regimes[1].duration, 200.0);
  EXPECT_TRUE(
      (regimes[0].information + regimes[1].information).isApprox(flights.information(0, 100.0, 900.0)));
}

TEST(FlownRegimes, RegimesWithoutSamplesAreOmitted) {
  Flights flights;
  flights.fly("first.nc", {ground, climb, {Regime::circle, 700.0, 850.0}}, 600.0);
  const std::vector<FlownRegime> regimes = flights.regimes();
  ASSERT_EQ(regimes.size(), 1U);
  EXPECT_EQ(regimes[0].regime, Regime::climb);
}

TEST(FlownRegimes, FlightWithTwoReferencesCountsOnce) {
  Flights flights;
  flights.fly("first.nc", {climb});
  flights.fly("first.nc", {climb}, 1000.0, 1);
  const std::vector<FlownRegime> regimes = flights.regimes();
  ASSERT_EQ(regimes.size(), 1U);
  EXPECT_DOUBLE_EQ(regimes[0].duration, 800.0);
  EXPECT_TRUE(regimes[0].information.isApprox(flights.information(0, 100.0, 900.0) +
                                              flights.information(1, 100.0, 900.0)));
}

}  // namespace
}  // namespace pcor::internal
