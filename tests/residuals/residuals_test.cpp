#include <gmock/gmock.h>
#include <pcor/residuals/residuals.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "support/data.hpp"
#include "support/short_flight.hpp"

using pcor::Mask;
using pcor::MaskOptions;
using pcor::ModelDefinition;
using pcor::Quantity;
using pcor::Reference;
using pcor::Residuals;
using pcor::test::data_directory;
using pcor::test::laser_model;
using pcor::test::short_flight;
using testing::HasSubstr;

namespace {

Residuals residuals_of_flight(const ModelDefinition& model, const Reference& reference,
                              const MaskOptions& options = {}) {
  const auto samples = std::make_shared<const pcor::FlightSamples>(
      pcor::read_samples(pcor::Flight(short_flight()), model, reference, options));
  return Residuals(samples, model, reference, options);
}

std::shared_ptr<pcor::FlightSamples> samples_with_laser(const ModelDefinition& model) {
  return std::make_shared<pcor::FlightSamples>(
      pcor::read_samples(pcor::Flight(short_flight()), model, *pcor::lams_reference()));
}

ModelDefinition other_system() {
  return pcor::read_model(data_directory / "models" / "c130-psfrd-eq18.toml");
}

std::vector<std::size_t> used(const Residuals& residuals) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (residuals.mask()[i] == Mask::none) indices.push_back(i);
  }
  return indices;
}

double rms_of(const Residuals& residuals, const std::vector<double>& values) {
  double squares = 0.0;
  const std::vector<std::size_t> indices = used(residuals);
  for (const std::size_t i : indices) squares += values[i] * values[i];
  return std::sqrt(squares / static_cast<double>(indices.size()));
}

void expect_derivatives(const Residuals& tested) {
  const std::vector<std::size_t> indices = used(tested);
  ASSERT_GT(indices.size(), 500U);
  std::vector<std::size_t> requested(tested.parameters().size());
  std::iota(requested.begin(), requested.end(), 0);
  std::vector<double> values(indices.size());
  std::vector<double> derivatives(indices.size() * requested.size());
  const std::vector<double>& at = tested.parameters();
  tested.evaluate(indices, at.data(), requested, values.data(), derivatives.data());
  const std::vector<double> all = tested.values(at.data());
  for (std::size_t i = 0; i < indices.size(); ++i) EXPECT_NEAR(values[i], all[indices[i]], 1e-10);
  for (std::size_t k = 0; k < requested.size(); ++k) {
    // A centred difference over 3e-4 hPa: rounding leaves 1e-9 of the derivative, curvature less than 1e-6.
    double largest = 0.0;
    for (std::size_t i = 0; i < indices.size(); ++i)
      largest = std::max(largest, std::abs(derivatives[k * indices.size() + i]));
    ASSERT_GT(largest, 0.0) << k;
    const double step = 3e-4 / largest;
    std::vector<double> moved = at;
    moved[k] = at[k] + step;
    const std::vector<double> above = tested.values(moved.data());
    moved[k] = at[k] - step;
    const std::vector<double> below = tested.values(moved.data());
    for (std::size_t i = 0; i < indices.size(); i += 7) {
      const double difference = (above[indices[i]] - below[indices[i]]) / (2.0 * step);
      EXPECT_NEAR(derivatives[k * indices.size() + i], difference, 1e-5 * largest) << k;
    }
  }
}

}  // namespace

TEST(Residuals, TrueReferenceLeavesSensorNoise) {
  const Residuals tested = residuals_of_flight(laser_model(), *pcor::pressure_reference("TRUE_PS"));
  // The model has the law of the truth: the remainder is the noise of PSFD, 0.01 to 0.02 hPa, and a little
  // from the other sensors of the law.
  EXPECT_LT(rms_of(tested, tested.values(tested.parameters().data())), 0.03);
}

TEST(Residuals, LamsResidualIsLaserMinusModelDefect) {
  const Residuals tested = residuals_of_flight(laser_model(), *pcor::lams_reference());
  const double* const at = tested.parameters().data();
  const std::vector<double> values = tested.values(at);
  const std::vector<double> laser = tested.quantity(Quantity::lams_static_defect, at);
  const std::vector<double> model = tested.quantity(Quantity::static_defect, at);
  const std::vector<double> requested = tested.target_defect(at);
  for (const std::size_t i : used(tested)) {
    EXPECT_NEAR(values[i], laser[i] - model[i], 1e-12);
    EXPECT_NEAR(requested[i], laser[i], 1e-12);
  }
}

TEST(Residuals, ExchangedSystemsGiveOppositeResiduals) {
  const Residuals forth = residuals_of_flight(laser_model(), *pcor::static_system_reference(other_system()));
  const Residuals back = residuals_of_flight(other_system(), *pcor::static_system_reference(laser_model()));
  const std::vector<double> a = forth.values(forth.parameters().data());
  const std::vector<double> b = back.values(back.parameters().data());
  for (const std::size_t i : used(forth)) EXPECT_NEAR(a[i], -b[i], 1e-11);
}

TEST(Residuals, DerivativesIncludeTheWholeChain) {
  ModelDefinition model = laser_model();
  for (const char* id : {"static-mach2", "lams-elevation", "recovery-factor", "static-lag"})
    model.model.effects.push_back(pcor::neutral_effect(id));
  pcor::ModelEffect bend;
  bend.id = "bend";
  bend.formula = "k * exp(-(attack - c)^2)";
  bend.parameter_names = {"k", "c"};
  bend.parameters = {0.3, 2.0};
  model.model.effects.push_back(bend);
  const Residuals tested = residuals_of_flight(model, *pcor::lams_reference());
  const std::vector<bool> linear{true, true, true, true, false, false, false, false, false};
  EXPECT_EQ(tested.is_linear(), linear);
  expect_derivatives(tested);
}

TEST(Residuals, DerivativesIncludeTheReferenceParameters) {
  const Residuals tested = residuals_of_flight(laser_model(), *pcor::static_system_reference(other_system()));
  ASSERT_EQ(tested.parameters().size(), 6U);
  expect_derivatives(tested);
  EXPECT_EQ(tested.parameters()[4], other_system().model.effects[1].parameters[0]);
}

TEST(Residuals, SensorResidualsEqualPressureResidualsToFirstOrder) {
  // With a recovery thermometer the temperature varies with the Mach number, with an ambient one it does
  // not.
  for (const bool with_recovery : {true, false}) {
    ModelDefinition model = laser_model();
    if (!with_recovery) {
      model.variables.erase(Quantity::recovery_temperature);
      model.variables[Quantity::ambient_temperature] = "TRUE_AT";
      model.model.lams.approach = pcor::LamsApproach::with_temperature;
    }
    // The laser differs by 1 cm/s from the model's airspeed.
    const auto samples = samples_with_laser(model);
    const Residuals recorded(samples, model, *pcor::lams_reference());
    const auto [sensor, predicted] = *recorded.predicted_sensor(recorded.parameters().data());
    const auto changed = std::make_shared<pcor::FlightSamples>(*samples);
    std::vector<double>& speeds = *changed->model.find(sensor);
    speeds = predicted;
    for (double& speed : speeds) speed += 0.01;
    const Residuals tested(changed, model, *pcor::lams_reference());
    const std::vector<std::size_t> indices = used(tested);
    ASSERT_GT(indices.size(), 500U);
    std::vector<double> pressure(indices.size());
    std::vector<double> at_sensor(indices.size());
    const double* const at = tested.parameters().data();
    tested.evaluate(indices, at, {}, pressure.data(), nullptr);
    tested.evaluate_at_sensor(indices, at, {}, at_sensor.data(), nullptr);
    // The second-order part is 1 cm/s over the airspeed, 1e-4.
    for (std::size_t i = 0; i < indices.size(); ++i)
      EXPECT_NEAR(at_sensor[i] / pressure[i], 1.0, 3e-4) << (with_recovery ? "recovery" : "ambient");
  }
}

TEST(Masks, EveryUnusedSampleHasAReason) {
  MaskOptions options;
  options.exclude = {pcor::Regime::climb};
  const Residuals tested = residuals_of_flight(laser_model(), *pcor::lams_reference(), options);
  const auto counts = tested.mask_counts();
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::size_t{0}), tested.size());
  EXPECT_GT(counts[static_cast<std::size_t>(Mask::ground)], 0U);
  EXPECT_GT(counts[static_cast<std::size_t>(Mask::flaps)], 0U);
  EXPECT_GT(counts[static_cast<std::size_t>(Mask::regime)], 0U);
  const std::vector<pcor::RegimeSet> regimes =
      pcor::regimes_of_samples(tested.samples().time, tested.samples().intervals);
  for (const std::size_t i : used(tested)) {
    EXPECT_FALSE(regimes[i][static_cast<std::size_t>(pcor::Regime::climb)]);
    EXPECT_FALSE(regimes[i][static_cast<std::size_t>(pcor::Regime::ground)]);
    EXPECT_GE(tested.samples().motion.airspeed[i], options.min_airspeed);
  }
}

TEST(Masks, ExcludedTimesApplyToEveryFlight) {
  MaskOptions options;
  options.intervals.emplace().flight = "another.nc";
  const Residuals whole = residuals_of_flight(laser_model(), *pcor::lams_reference(), options);
  const std::vector<double>& time = whole.samples().time;
  const std::size_t first = used(whole)[100];
  options.excluded_times = {{time[first], time[first + 10], ""}};
  const Residuals tested = residuals_of_flight(laser_model(), *pcor::lams_reference(), options);
  for (std::size_t i = first - 1; i <= first + 10; ++i)
    EXPECT_EQ(tested.mask()[i] == Mask::excluded, i >= first && i < first + 10) << i;
}

TEST(Masks, MissingOrWrongLaserIsExcluded) {
  const ModelDefinition model = laser_model();
  const auto samples = samples_with_laser(model);
  const std::vector<std::size_t> indices = used(Residuals(samples, model, *pcor::lams_reference()));
  std::vector<double>& speeds = *samples->model.find(Quantity::lams_airspeed);
  speeds[indices[100]] = std::nan("");
  speeds[indices[101]] += 30.0;
  const Residuals tested(samples, model, *pcor::lams_reference());
  EXPECT_EQ(tested.mask()[indices[100]], Mask::reference);
  EXPECT_EQ(tested.mask()[indices[101]], Mask::laser_unlocked);
  EXPECT_EQ(tested.mask()[indices[102]], Mask::none);
}

TEST(Masks, MissingInputsAreMasked) {
  const ModelDefinition model = laser_model();
  const auto samples = samples_with_laser(model);
  const std::vector<std::size_t> indices = used(Residuals(samples, model, *pcor::lams_reference()));
  (*samples->model.find(Quantity::static_pressure))[indices[200]] = std::nan("");
  (*samples->model.find(Quantity::attack_differential_pressure))[indices[201]] = std::nan("");
  (*samples->model.find(Quantity::recovery_temperature))[indices[202]] = std::nan("");
  const Residuals tested(samples, model, *pcor::lams_reference());
  EXPECT_EQ(tested.mask()[indices[200]], Mask::missing);
  EXPECT_EQ(tested.mask()[indices[201]], Mask::missing);
  EXPECT_EQ(tested.mask()[indices[202]], Mask::reference) << "the law needs no thermometer, the laser does";
}
