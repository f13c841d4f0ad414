// Laws of the rows that every fit and every diagnosis is made of.
#include "campaign/linear_rows.hpp"

#include <gmock/gmock.h>
#include <pcor/effects/catalogue.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

#include "campaign/model_parameters.hpp"
#include "support/short_flight.hpp"

using namespace pcor::internal;

using pcor::FlightSamples;
using pcor::Mask;
using pcor::ModelDefinition;
using pcor::Quantity;
using pcor::Reference;
using pcor::test::laser_model;
using pcor::test::short_flight;

namespace {

std::shared_ptr<FlightSamples> samples_of(const ModelDefinition& model, const Reference& reference) {
  return std::make_shared<FlightSamples>(read_samples(pcor::Flight(short_flight()), model, reference));
}

const std::shared_ptr<const Reference> lams = pcor::lams_reference();

/// The laser's model with an effect that is not at the static ports, in which nothing is linear.
ModelDefinition curved_model() {
  ModelDefinition model = laser_model();
  model.model.effects.push_back(pcor::neutral_effect("temp-offset"));
  return model;
}

/// The second pair of pressures, with the law of the first.
std::shared_ptr<const Reference> second_system(const ModelDefinition& model) {
  ModelDefinition other = model;
  other.model.name = "second";
  other.variables[Quantity::static_pressure] = "PSFRD";
  other.variables[Quantity::dynamic_pressure] = "QCFR";
  return pcor::static_system_reference(other);
}

LinearRows rows_of(const std::shared_ptr<const FlightSamples>& samples, const ModelDefinition& model,
                   const Reference& reference, const RowsSetup& setup) {
  return {pcor::Residuals(samples, model, reference), model, reference, setup};
}

LinearRows rows_of(const ModelDefinition& model, const Reference& reference) {
  return rows_of(samples_of(model, reference), model, reference, {Inputs::recorded, free_parameters(model)});
}

std::vector<std::size_t> all_parameters(const LinearRows& rows) {
  std::vector<std::size_t> all(rows.residuals().parameters().size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

Eigen::MatrixXd at_used(const LinearRows& rows, const std::vector<double>& parameters,
                        const std::vector<std::size_t>& requested, bool as_recorded = false) {
  return rows.evaluate(rows.used(), parameters.data(), requested, as_recorded);
}

/// Compares derivatives of residuals with centred differences of them.
void expect_derivatives(const LinearRows& rows) {
  const std::vector<double> start = rows.residuals().parameters();
  const std::vector<std::size_t> all = all_parameters(rows);
  const Eigen::MatrixXd found = at_used(rows, start, all);
  for (std::size_t p = 0; p < all.size(); ++p) {
    const Eigen::VectorXd column = found.col(static_cast<Eigen::Index>(p));
    const double largest = column.cwiseAbs().maxCoeff();
    ASSERT_GT(largest, 0.0) << p;
    // Over 0.01 hPa: the residual is curved by less than 1e-6 of its derivative, and of pressures of 1000 hPa
    // the last bit is 1e-13 hPa, 1e-11 of the difference.
    const double step = 0.01 / largest;
    std::vector<double> moved = start;
    moved[p] = start[p] + step;
    const Eigen::VectorXd above = at_used(rows, moved, {});
    moved[p] = start[p] - step;
    const Eigen::VectorXd below = at_used(rows, moved, {});
    EXPECT_LT(((above - below) / (2.0 * step) - column).cwiseAbs().maxCoeff(), 2e-6 * largest) << p;
  }
}

}  // namespace

TEST(LinearRows, DerivativesAreDifferencesOfResiduals) {
  for (const ModelDefinition& model : {laser_model(), curved_model()}) {
    const LinearRows rows = rows_of(model, *lams);
    EXPECT_EQ(rows.is_linear(), model.model.effects.size() == 3);
    expect_derivatives(rows);
  }
}

// Errors common to two systems cancel in their difference, and so does common noise.
TEST(LinearRows, TwoSystemRowsAreOppositeAtCommonPressures) {
  const ModelDefinition model = laser_model();
  const auto reference = second_system(model);
  const LinearRows rows = rows_of(model, *reference);
  EXPECT_TRUE(rows.is_linear());
  const std::vector<double>& start = rows.residuals().parameters();
  const Eigen::Index count = static_cast<Eigen::Index>(parameter_count(model.model));
  const Eigen::MatrixXd common = at_used(rows, start, all_parameters(rows));
  const Eigen::MatrixXd recorded = at_used(rows, start, all_parameters(rows), true);
  EXPECT_EQ(common.leftCols(count), -common.middleCols(count, count));
  EXPECT_NE(recorded.leftCols(count), -recorded.middleCols(count, count));
  EXPECT_EQ(common.rightCols(1), recorded.rightCols(1));
  // The pressures differ by less than a hundredth, and so do the derivatives.
  EXPECT_TRUE(common.isApprox(recorded, 0.01));
}

TEST(LinearRows, MeansEqualMeansOfSamplesInEachBin) {
  const ModelDefinition model = curved_model();
  const LinearRows rows = rows_of(model, *lams);
  const std::vector<double>& start = rows.residuals().parameters();
  const Eigen::VectorXd residual = at_used(rows, start, {});
  std::vector<double> series(rows.residuals().size(), std::nan(""));
  for (std::size_t i = 0; i < rows.used().size(); ++i)
    series[rows.used()[i]] = residual[static_cast<Eigen::Index>(i)];
  series[rows.used()[7]] = std::nan("");  // left out
  const Binning bins = rows.bins(series);
  ASSERT_GT(bins.size(), 100U);
  const std::vector<std::size_t> all = all_parameters(rows);
  const Eigen::MatrixXd samples = at_used(rows, start, all);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(bins.size()), samples.cols());
  for (std::size_t k = 0; k < bins.records().size(); ++k) {
    const auto used = std::lower_bound(rows.used().begin(), rows.used().end(), bins.records()[k]);
    EXPECT_NE(bins.records()[k], rows.used()[7]);
    expected.row(bins.bins()[k]) += samples.row(used - rows.used().begin()) / bins.counts()[bins.bins()[k]];
  }
  // Sums of four samples; registers hold samples in other groups, which moves the last bits.
  EXPECT_TRUE(rows.bin_means(bins, samples).isApprox(expected, 1e-12));
  EXPECT_EQ(bins.counts().sum(), static_cast<double>(bins.records().size()));
}

TEST(LinearRows, EverySampleHasUseOrReason) {
  const ModelDefinition model = laser_model();
  const auto samples = samples_of(model, *lams);
  samples->flaps.assign(samples->time.size(), 0.0);
  std::fill(samples->flaps.begin() + 300, samples->flaps.begin() + 320, 30.0);  // percent
  std::fill_n(samples->model.find(Quantity::lams_airspeed)->begin() + 400, 15, std::nan(""));
  constexpr double share = 0.25;
  const LinearRows rows = rows_of(samples, model, *lams, {Inputs::recorded, {}, share});
  const auto counts = rows.residuals().mask_counts();
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::size_t{0}), samples->time.size());
  for (std::size_t i = 300; i < 320; ++i) EXPECT_EQ(rows.mask()[i], Mask::flaps) << i;
  for (std::size_t i = 400; i < 415; ++i) EXPECT_EQ(rows.mask()[i], Mask::reference) << i;
  std::vector<std::size_t> both = rows.used();
  both.insert(both.end(), rows.held_out().begin(), rows.held_out().end());
  EXPECT_EQ(both.size(), counts[static_cast<std::size_t>(Mask::none)]);
  EXPECT_TRUE(std::is_sorted(both.begin(), both.end()));
  for (const std::size_t i : both) EXPECT_EQ(rows.mask()[i], Mask::none) << i;
  EXPECT_EQ(rows.used().size(),
            static_cast<std::size_t>(std::llround(share * static_cast<double>(both.size()))));
}

TEST(LinearRows, StageUsesOnlySamplesInItsIntervals) {
  const ModelDefinition model = laser_model();
  const auto samples = samples_of(model, *lams);
  const double begin = samples->time.front();
  const auto at = [begin](double first, double last) {
    pcor::Interval interval;
    interval.regime = pcor::Regime::turn;
    interval.begin = begin + first;
    interval.end = begin + last;
    return interval;
  };
  // The second overlaps the first and contains the samples after it; the third contains no samples.
  samples->intervals = {at(200.0, 230.0), at(220.0, 240.0), at(1e6, 2e6), at(500.0, 510.0)};
  const LinearRows rows = rows_of(samples, model, *lams, {Inputs::recorded, {}, 1.0, {pcor::Regime::turn}});
  ASSERT_EQ(rows.interval_count(), 3U);
  for (std::size_t i = 0; i < rows.used().size(); ++i) {
    const double time = samples->time[rows.used()[i]] - begin;
    const std::size_t expected = time < 230.0 ? 0 : time < 240.0 ? 1 : 2;
    EXPECT_EQ(rows.intervals()[rows.used()[i]], expected) << time;
  }
  EXPECT_LE(rows.used().size(), 50U);
  EXPECT_GT(rows.used().size(), 30U);
}

// With masks that are known residuals and derivatives are the same.
TEST(LinearRows, GivenMaskGivesTheSameRows) {
  const ModelDefinition model = curved_model();
  const auto samples = samples_of(model, *lams);
  const RowsSetup setup{Inputs::noise_free, free_parameters(model)};
  const LinearRows found = rows_of(samples, model, *lams, setup);
  const LinearRows given(pcor::Residuals(samples, model, *lams, found.mask()), model, *lams, setup);
  const std::vector<double>& start = found.residuals().parameters();
  EXPECT_EQ(given.used(), found.used());
  EXPECT_EQ(at_used(given, start, all_parameters(given)), at_used(found, start, all_parameters(found)));
  // The laser at which derivatives are taken is the prediction by the pressures at which they are taken.
  const auto inputs = std::make_shared<const pcor::FlightSamples>(found.inputs());
  const pcor::Residuals at_inputs(inputs, model, *lams, found.mask());
  const std::vector<double>& shown = *inputs->model.find(Quantity::lams_airspeed);
  EXPECT_THAT(shown, testing::Pointwise(testing::NanSensitiveDoubleEq(),
                                        at_inputs.predicted_sensor(start.data())->second));
}
