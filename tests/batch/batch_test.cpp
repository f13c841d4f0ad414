#include <pcor/batch/batch.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/realtime/loop.hpp>
#include "batch/batch_kernel.hpp"
#include "numerics/missing.hpp"
#include "support/error_of.hpp"

using namespace pcor::internal;

namespace pcor {
namespace {

using internal::nan;

/// Recorded values, an array for each quantity.
using Arrays = std::map<Quantity, std::vector<double>>;

const std::vector<Quantity> derived{Quantity::static_defect,
                                    Quantity::corrected_static_pressure,
                                    Quantity::corrected_dynamic_pressure,
                                    Quantity::humidity,
                                    Quantity::corrected_mach,
                                    Quantity::ambient_temperature,
                                    Quantity::corrected_airspeed,
                                    Quantity::lams_static_defect,
                                    Quantity::lams_temperature,
                                    Quantity::lams_dynamic_pressure};

/// Samples over the envelopes of the C-130 and GV and beyond, each value missing now and then.
Arrays random_samples(std::size_t count, const std::vector<Quantity>& recorded) {
  std::mt19937_64 random(20141014);
  const auto between = [&random](double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
  };
  Arrays arrays;
  for (std::size_t i = 0; i < count; ++i) {
    const double p = between(120.0, 1050.0);
    const double mach = between(0.08, 0.9);
    const double temperature = between(200.0, 310.0);
    const MoistAir<double> air = dry_air<double>();
    const double q = dynamic_pressure_from_mach(p, mach, air);
    std::map<Quantity, double> sample{
        {Quantity::static_pressure, p},
        {Quantity::dynamic_pressure, q},
        {Quantity::recovery_temperature, recovery_temperature(temperature, mach, 0.97, air)},
        {Quantity::ambient_temperature, temperature},
        {Quantity::vapor_pressure, between(-0.05, 1.3) * vapor_pressure_over_water(temperature)},
        {Quantity::dew_point, temperature + between(-30.0, 3.0)},
        {Quantity::radome_dynamic_pressure, q * between(0.9, 1.1)},
        {Quantity::attack_differential_pressure, q * between(-0.3, 0.3)},
        {Quantity::sideslip_differential_pressure, q * between(-0.1, 0.1)},
        {Quantity::attack, between(-3.0, 10.0)},
        {Quantity::sideslip, between(-5.0, 5.0)},
        {Quantity::lams_airspeed, true_airspeed(mach, temperature, air) + between(-2.0, 2.0)},
        {Quantity::static_pressure_rate, between(-2.0, 2.0)},
        {extra_quantity(0), between(-1.0, 1.0)}};
    for (const Quantity quantity : recorded) {
      double value = sample.at(quantity);
      const double chance = between(0.0, 1.0);
      if (chance < 0.01) value = nan;
      if (chance > 0.99) value = -value;
      if (chance > 0.998) value = 0.0;
      if (chance > 0.999) value = std::numeric_limits<double>::infinity();
      arrays[quantity].push_back(value);
    }
  }
  return arrays;
}

std::vector<Batch::Input> inputs_of(const Arrays& arrays) {
  std::vector<Batch::Input> inputs;
  for (const auto& [quantity, values] : arrays) inputs.push_back({quantity, values.data()});
  return inputs;
}

std::vector<Batch::Output> outputs_of(Arrays& arrays) {
  std::vector<Batch::Output> outputs;
  for (auto& [quantity, values] : arrays) outputs.push_back({quantity, values.data()});
  return outputs;
}

Arrays in_batch(const Batch& batch, const Arrays& recorded, std::size_t count) {
  Arrays result;
  for (const Quantity quantity : derived) {
    if (batch.finds(quantity)) result[quantity].resize(count);
  }
  batch.run(inputs_of(recorded), outputs_of(result), count);
  return result;
}

Arrays in_loop(const Model& model, const std::vector<Quantity>& roles, const Arrays& recorded,
               std::size_t count, CorrectWith with) {
  std::string error;
  std::optional<Loop> loop = Loop::build(model, roles, 1.0, &error, with);
  EXPECT_TRUE(loop) << error;
  Arrays result;
  for (std::size_t i = 0; loop && i < count; ++i) {
    for (const auto& [quantity, values] : recorded) loop->state()[quantity] = values[i];
    loop->run(static_cast<double>(i));
    for (const Quantity quantity : derived) result[quantity].push_back(loop->state()[quantity]);
  }
  return result;
}

/// Rounding: 1e-13 of a value, and more at low speed for results of the Mach number, the difference of
/// nearly equal pressures.
double rounding(Quantity quantity, double value, double mach) {
  switch (quantity) {
    case Quantity::static_defect:
    case Quantity::lams_static_defect:
      return 2e-12;
    case Quantity::lams_dynamic_pressure:
      // p ((1 + x)^y - 1) of p up to 1000 hPa, if one lane beyond Mach 0.847 makes all lanes use powers.
      return 1e-12 + std::abs(value) * 1e-13;
    case Quantity::corrected_mach:
    case Quantity::corrected_airspeed:
    case Quantity::lams_temperature:
      return std::abs(value) * (1e-13 + 1e-14 / std::max(mach * mach, 1e-8));
    default:
      return std::abs(value) * 1e-13;
  }
}

/// `iteration` is how far from the end an iteration may stop, as a part of the value.
void expect_equal(const Arrays& found, const Arrays& expected, double iteration = 0.0) {
  for (const auto& [quantity, values] : expected) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      // Values missing in a batch are missing in the loop too.
      const double value = found.count(quantity) > 0 ? found.at(quantity)[i] : nan;
      if (std::isnan(value) && std::isnan(values[i])) continue;
      const double mach = expected.at(Quantity::corrected_mach)[i];
      const double allowed =
          rounding(quantity, values[i], mach) + iteration * std::max(1.0, std::abs(values[i]));
      ASSERT_NEAR(value, values[i], allowed) << info_of(quantity).name << " of sample " << i;
    }
  }
}

std::size_t values_in(const std::vector<double>& values) {
  return static_cast<std::size_t>(
      std::count_if(values.begin(), values.end(), [](double value) { return !std::isnan(value); }));
}

void expect_as_in_loop(const Model& model, const std::vector<Quantity>& roles,
                       CorrectWith with = CorrectWith::model) {
  constexpr std::size_t count = 10000;
  Arrays recorded = random_samples(count, roles);
  const Batch batch(model, roles, with);
  if (!batch.chain().extra_names().empty()) {
    recorded.merge(random_samples(count, {extra_quantity(0)}));
  }
  const Arrays expected = in_loop(model, roles, recorded, count, with);
  const Arrays found = in_batch(batch, recorded, count);
  // All lanes of a pack iterate until the last of them has arrived.
  const bool iterates = batch.chain().has_lams() && model.lams.approach == LamsApproach::iterated;
  expect_equal(found, expected, iterates ? 1e-7 : 0.0);
  EXPECT_GT(values_in(expected.at(Quantity::static_defect)), count / 2);
  if (batch.chain().has_lams()) {
    EXPECT_GT(values_in(expected.at(Quantity::lams_dynamic_pressure)), count / 2);
  }
}

const std::vector<Quantity> gv_roles{Quantity::static_pressure, Quantity::dynamic_pressure,
                                     Quantity::recovery_temperature, Quantity::vapor_pressure,
                                     Quantity::attack};

Model gv() {
  Model model;
  model.name = "gv";
  model.effects = {{"static-constant", {-0.012255}},
                   {"static-qp", {0.075372}},
                   {"static-mach3", {-0.087508}},
                   {"static-attack", {0.002148}}};
  model.recovery = {{0.9959, 0.0283, 0.0374, 0.0762}};
  model.policy.taper_below = 40.0;
  return model;
}

std::vector<Quantity> with_lams(std::vector<Quantity> roles) {
  roles.push_back(Quantity::lams_airspeed);
  return roles;
}

TEST(Batch, EqualsLoopForLawWithTaper) { expect_as_in_loop(gv(), gv_roles); }

TEST(Batch, EqualsLoopForRadomeAnglesDewPointAndMinimum) {
  Model model;
  model.effects = {{"static-constant", {0.0041}}, {"static-alpha", {0.0213}}, {"static-qp", {0.0308}}};
  model.sideslip_radome = {0.1, 12.0, 0.5};
  model.attack_radome = {5.8, 15.0, 1.0};
  model.policy.minimum = 0.5;
  model.recovery = {{0.95}};
  expect_as_in_loop(model,
                    {Quantity::static_pressure, Quantity::dynamic_pressure, Quantity::radome_dynamic_pressure,
                     Quantity::attack_differential_pressure, Quantity::sideslip_differential_pressure,
                     Quantity::recovery_temperature, Quantity::dew_point});
}

TEST(Batch, EqualsLoopForFormulaWithUserVariable) {
  Model model = gv();
  ModelEffect effect;
  effect.id = "fairing";
  effect.formula =
      "k * static_pressure * tanh(if(mach < 0.5, mach, 0.5 + sin(probe))) ^ 1.5 + pow(attack, m) * "
      "log10(mach)";
  effect.parameter_names = {"k", "m"};
  effect.parameters = {0.01, 2.0};
  model.effects.push_back(effect);
  expect_as_in_loop(model, gv_roles);
}

TEST(Batch, EqualsLoopInDryAirWithoutTemperature) {
  Model model = gv();
  model.moist = false;
  expect_as_in_loop(model, {Quantity::static_pressure, Quantity::dynamic_pressure, Quantity::attack});
}

TEST(Batch, EqualsLoopForEveryLamsApproach) {
  for (const LamsApproach approach : {LamsApproach::simultaneous, LamsApproach::iterated}) {
    Model model = gv();
    model.lams = {1.2, -0.4, approach};
    model.effects.push_back({"lams-elevation", {0.1}});
    model.effects.push_back({"recovery-factor", {0.003}});
    expect_as_in_loop(model, with_lams(gv_roles));
    expect_as_in_loop(model, with_lams(gv_roles), CorrectWith::lams);
    model.effects.push_back({"temp-calibration", {0.55, 0.01, -0.0001}});
    expect_as_in_loop(model, with_lams(gv_roles));
  }
  Model model = gv();
  model.lams.approach = LamsApproach::with_temperature;
  model.effects.push_back({"temp-calibration", {0.55, 0.01, -0.0001}});
  expect_as_in_loop(model, {Quantity::static_pressure, Quantity::dynamic_pressure, Quantity::attack,
                            Quantity::sideslip, Quantity::ambient_temperature, Quantity::lams_airspeed});
}

TEST(Batch, RateOfChangeIsAnInputArray) {
  Model model = gv();
  model.effects.push_back({"static-lag", {0.1}});
  EXPECT_THAT(test::error_of([&] { Batch(model, gv_roles); }),
              test::IsError(Error::Code::model, "'static_pressure_rate'"));
  std::vector<Quantity> roles = gv_roles;
  roles.push_back(Quantity::static_pressure_rate);
  expect_as_in_loop(model, roles);
}

TEST(Batch, WritesExactlyTheRequestedSamples) {
  const Batch batch(gv(), gv_roles);
  constexpr std::size_t maximum = 40;
  const Arrays recorded = random_samples(maximum, gv_roles);
  const Arrays whole = in_batch(batch, recorded, maximum);
  for (std::size_t count = 0; count < maximum; ++count) {
    std::vector<double> found(maximum + 1, 12345.0);
    batch.run(inputs_of(recorded), {{Quantity::corrected_airspeed, found.data()}}, count);
    for (std::size_t i = 0; i < count; ++i) {
      const double expected = whole.at(Quantity::corrected_airspeed)[i];
      // A compiler may fuse operations otherwise in the last turns of a loop: units in the last place.
      EXPECT_TRUE(std::abs(found[i] - expected) <= 1e-13 * std::abs(expected) ||
                  (std::isnan(found[i]) && std::isnan(expected)))
          << i;
    }
    EXPECT_EQ(found[count], 12345.0);
  }
}

TEST(Batch, CoefficientsCanBeReplaced) {
  Model other = gv();
  other.effects[1].parameters = {0.08};
  const Batch batch(gv(), gv_roles);
  const Arrays recorded = random_samples(100, gv_roles);
  std::vector<double> found(100);
  std::vector<double> ordered = batch.chain().parameters();
  std::replace(ordered.begin(), ordered.end(), 0.075372, 0.08);
  batch.run(inputs_of(recorded), {{Quantity::static_defect, found.data()}}, 100, ordered.data());
  const Arrays expected = in_batch(Batch(other, gv_roles), recorded, 100);
  EXPECT_THAT(found,
              testing::Pointwise(testing::NanSensitiveDoubleEq(), expected.at(Quantity::static_defect)));
}

/// Every quantity that an effect at the static ports reads, over a range in which the effects act.
Arrays samples_of_all_inputs(std::size_t count) {
  struct Range {
    Quantity quantity;
    double lower, upper;
  };
  constexpr Range ranges[] = {{Quantity::static_pressure, 400, 900},
                              {Quantity::dynamic_pressure, 20, 250},
                              {Quantity::radome_dynamic_pressure, 20, 250},
                              {Quantity::attack_differential_pressure, -20, 20},
                              {Quantity::sideslip_differential_pressure, -8, 8},
                              {Quantity::attack, -2, 8},
                              {Quantity::sideslip, -4, 4},
                              {Quantity::time, 0, 9000},
                              {Quantity::date, 4000, 4600},
                              {Quantity::normal_acceleration, 5, 15},
                              {Quantity::longitudinal_acceleration, -1, 1},
                              {Quantity::roll, -30, 30},
                              {Quantity::flaps, 0, 40},
                              {Quantity::engine_torque, 10, 90},
                              {Quantity::height_above_ground, 5, 100},
                              {Quantity::recovery_temperature, 240, 300},
                              {Quantity::vapor_pressure, 0.5, 3},
                              {Quantity::static_pressure_rate, -1, 1}};
  std::mt19937_64 random(1976);
  Arrays arrays;
  for (const Range& range : ranges) {
    std::uniform_real_distribution<double> value(range.lower, range.upper);
    for (std::size_t i = 0; i < count; ++i)
      arrays[range.quantity].push_back(i % 97 == index(range.quantity) % 97 ? nan : value(random));
  }
  return arrays;
}

std::vector<Quantity> quantities_of(const Arrays& arrays) {
  std::vector<Quantity> quantities;
  for (const auto& [quantity, values] : arrays) quantities.push_back(quantity);
  return quantities;
}

/// Runs a kernel for all derivatives of delta-p by coefficients of linear terms, together with delta-p.
std::vector<double> defect_and_derivatives(BatchKernel kernel, const Batch& batch, const Arrays& recorded,
                                           std::vector<std::vector<double>>& found) {
  const std::size_t count = recorded.begin()->second.size();
  const Chain& chain = batch.chain();
  std::vector<double> defect(count);
  const std::vector<Batch::Input> inputs = inputs_of(recorded);
  const Batch::Output output{Quantity::static_defect, defect.data()};
  std::vector<std::vector<double>> coefficients;
  std::vector<BatchDerivative> derivatives;
  for (std::size_t effect = 0; effect < chain.effect_count(); ++effect) {
    for (std::size_t p = 0; p < chain.parameter_count_of(effect); ++p) {
      if (!chain.is_static_sum_linear(effect, p)) continue;
      coefficients.push_back(chain.unit_coefficients(effect, p, chain.parameters().data()));
      derivatives.push_back({effect, p, nullptr, nullptr});
    }
  }
  found.assign(derivatives.size(), std::vector<double>(count));
  for (std::size_t k = 0; k < derivatives.size(); ++k) {
    derivatives[k].values = found[k].data();
    if (chain.surface_of(derivatives[k].effect) == nullptr)
      derivatives[k].coefficients = coefficients[k].data();
  }
  BatchJob job;
  job.chain = &chain;
  job.parameters = chain.parameters().data();
  job.runs.fill(true);
  job.inputs = inputs.data();
  job.input_count = inputs.size();
  job.outputs = &output;
  job.output_count = 1;
  job.derivatives = derivatives.data();
  job.derivative_count = derivatives.size();
  job.samples = count;
  kernel(job);
  return defect;
}

/// Compares derivatives of delta-p with differences, in every kernel: a step of any size of a coefficient of
/// a linear term gives the derivative. @return derivatives that differ from zero
std::size_t expect_derivatives_of(const Model& model, const Arrays& recorded) {
  const Batch batch(model, quantities_of(recorded));
  const Chain& chain = batch.chain();
  const std::size_t count = recorded.begin()->second.size();
  std::size_t differ = 0;
  for (const BatchKernel kernel : batch_kernels()) {
    std::vector<std::vector<double>> found;
    const std::vector<double> defect = defect_and_derivatives(kernel, batch, recorded, found);
    auto column = found.begin();
    for (std::size_t effect = 0; effect < chain.effect_count(); ++effect) {
      for (std::size_t p = 0; p < chain.parameter_count_of(effect); ++p) {
        if (!chain.is_static_sum_linear(effect, p)) continue;
        std::vector<double> moved = chain.parameters();
        constexpr double step = 1e-4;
        moved[chain.first_parameter_of(effect) + p] += step;
        std::vector<double> stepped(count);
        batch.run(inputs_of(recorded), {{Quantity::static_defect, stepped.data()}}, count, moved.data());
        moved[chain.first_parameter_of(effect) + p] -= 2.0 * step;
        std::vector<double> back(count);
        batch.run(inputs_of(recorded), {{Quantity::static_defect, back.data()}}, count, moved.data());
        double squares = 0.0;
        for (std::size_t i = 0; i < count; ++i) {
          EXPECT_EQ(std::isnan((*column)[i]), std::isnan(defect[i])) << i;
          // A step may make delta-p larger than the dynamic pressure.
          if (std::isnan(stepped[i]) || std::isnan(defect[i]) || std::isnan(back[i])) continue;
          // The difference of two values of delta-p is rounded to 1e-13 hPa, over the step of 1e-4.
          const double difference = (stepped[i] - defect[i]) / step;
          const double tolerance = 1e-8 + 1e-8 * std::abs(difference);
          // A step that reaches or leaves the minimum is not linear.
          if (std::abs(difference - (defect[i] - back[i]) / step) > 2.0 * tolerance) continue;
          EXPECT_NEAR((*column)[i], difference, tolerance)
              << model.effects[effect].id << " " << p << " of sample " << i;
          squares += difference * difference;
        }
        if (squares > 0.0) ++differ;
        ++column;
      }
    }
  }
  return differ / batch_kernels().size();
}

TEST(Batch, DerivativesEqualDifferencesForEveryEffectAtTheStaticPorts) {
  const Arrays recorded = samples_of_all_inputs(500);
  std::size_t linear = 0;
  for (const EffectInfo& info : effect_info) {
    if (info.location != EffectLocation::static_defect) continue;
    Model model = gv();
    model.policy = {};
    ModelEffect& effect = model.effects.emplace_back();
    effect.id = std::string(info.id);
    effect.scaling = {1, -1};
    for (std::size_t i = 0; i < info.parameter_count(); ++i) {
      const ParameterInfo& parameter = info.parameters[i];
      effect.parameters.push_back(parameter.shape ? 0.6 * parameter.neutral : 0.01 * parameter.typical);
      if (!parameter.shape) ++linear;
    }
    EXPECT_EQ(expect_derivatives_of(model, recorded),
              gv().effects.size() +
                  static_cast<std::size_t>(std::count_if(
                      info.parameters.begin(),
                      info.parameters.begin() + static_cast<std::ptrdiff_t>(info.parameter_count()),
                      [](const ParameterInfo& each) { return !each.shape; })))
        << info.id;
  }
  EXPECT_GE(linear, 18U);
}

TEST(Batch, DerivativesWithMinimumAndTaper) {
  const Arrays recorded = samples_of_all_inputs(300);
  Model model = gv();
  model.policy.taper_below = 60.0;
  model.policy.minimum = 0.5;
  EXPECT_EQ(expect_derivatives_of(model, recorded), gv().effects.size());
}

TEST(Batch, DerivativesOfSurfacesBesideOtherEffects) {
  const Arrays recorded = samples_of_all_inputs(300);
  Model model = gv();
  ModelEffect formula;
  formula.id = "fairing";
  formula.formula = "0.01 * attack";
  model.effects.push_back(formula);
  std::size_t coefficients = gv().effects.size();
  for (const std::size_t count : {5U, 7U}) {
    ModelEffect surface;
    surface.id = "surface-" + std::to_string(count);
    surface.surface = Surface{{{{Quantity::attack, -1.0, 7.0, count}, {Quantity::mach, 0.2, 0.7, 6}}}};
    for (std::size_t i = 0; i < surface.surface->parameter_count(); ++i)
      surface.parameters.push_back(1e-4 * static_cast<double>(i % 5));
    coefficients += surface.parameters.size();
    model.effects.push_back(surface);
    model.effects.push_back({"static-constant", {0.001}});
    model.effects.back().id = count == 5 ? "static-mach" : "static-mach2";
    ++coefficients;
  }
  EXPECT_EQ(expect_derivatives_of(model, recorded), coefficients);
}

TEST(Batch, DerivativesAreZeroAtTheMinimumOfThePolicy) {
  const Arrays recorded = samples_of_all_inputs(500);
  Model model = gv();
  model.policy = {};
  std::vector<double> defect(500);
  std::vector<double> column(500);
  const auto run = [&] {
    const Batch batch(model, quantities_of(recorded));
    batch.run(inputs_of(recorded), {{Quantity::static_defect, defect.data()}}, 500);
    batch.differentiate(inputs_of(recorded), {{0, 0, column.data()}}, 500);
  };
  run();
  std::vector<double> finite;
  std::copy_if(defect.begin(), defect.end(), std::back_inserter(finite),
               [](double value) { return !std::isnan(value); });
  ASSERT_GT(finite.size(), 100U);
  std::nth_element(finite.begin(), finite.begin() + static_cast<std::ptrdiff_t>(finite.size() / 2),
                   finite.end());
  const std::vector<double> unlimited = column;
  // Half of the samples are at the minimum.
  model.policy.minimum = finite[finite.size() / 2];
  const std::vector<double> free_defect = defect;
  run();
  std::size_t limited = 0;
  for (std::size_t i = 0; i < 500; ++i) {
    if (std::isnan(free_defect[i])) continue;
    const bool is_limited = free_defect[i] < model.policy.minimum;
    limited += is_limited ? 1 : 0;
    EXPECT_EQ(column[i], is_limited ? 0.0 : unlimited[i]) << i;
  }
  EXPECT_GT(limited, finite.size() / 3);
  EXPECT_LT(limited, finite.size());
}

TEST(Batch, DerivativesUseTheGivenCoefficients) {
  // A shape other than that of the model changes the derivative by the amplitude.
  const Arrays recorded = samples_of_all_inputs(50);
  Model model = gv();
  const EffectInfo& info = *effect_named("static-transonic");
  ModelEffect effect{std::string(info.id)};
  std::size_t amplitude = info.parameter_count();
  std::size_t shape = amplitude;
  for (std::size_t i = 0; i < info.parameter_count(); ++i) {
    effect.parameters.push_back(info.parameters[i].shape ? 0.6 : 0.01);
    (info.parameters[i].shape ? shape : amplitude) = i;
  }
  model.effects = {effect};
  const Batch batch(model, quantities_of(recorded));
  const auto sum_with = [&](double at) {
    std::vector<double> parameters = effect.parameters;
    parameters[shape] = at;
    std::vector<double> found(50);
    batch.differentiate(inputs_of(recorded), {{0, amplitude, found.data()}}, 50, parameters.data());
    double sum = 0.0;
    for (const double value : found) sum += std::isnan(value) ? 0.0 : std::abs(value);
    return sum;
  };
  EXPECT_GT(sum_with(0.3), 1.01 * sum_with(0.6));
}

TEST(Batch, DerivativesThatDoNotExistAreRefused) {
  const Arrays recorded = samples_of_all_inputs(10);
  std::vector<double> found(10);
  const auto expect_refused = [&](const Model& model, std::size_t effect, std::size_t parameter) {
    const Batch batch(model, quantities_of(recorded));
    EXPECT_THAT(test::error_of([&] {
                  batch.differentiate(inputs_of(recorded), {{effect, parameter, found.data()}}, 10);
                }),
                test::IsError(Error::Code::usage, "linear"));
  };
  const std::size_t effects = gv().effects.size();
  expect_refused(gv(), effects, 0);
  expect_refused(gv(), 0, 1);
  Model with_others = gv();
  ModelEffect formula;
  formula.id = "fairing";
  formula.formula = "k * attack";
  formula.parameter_names = {"k"};
  formula.parameters = {0.01};
  with_others.effects.push_back(formula);
  with_others.effects.push_back({"psfd-bias", {0.1}});
  expect_refused(with_others, effects, 0);
  expect_refused(with_others, effects + 1, 0);
  Arrays incomplete = recorded;
  const Batch batch(gv(), quantities_of(recorded));
  incomplete.erase(Quantity::attack);
  EXPECT_THAT(test::error_of([&] {
                batch.differentiate(inputs_of(incomplete), {{0, 0, found.data()}}, 10);
              }),
              test::IsError(Error::Code::variable, "'attack'"));
}

// Wider registers have separate kernels.
Arrays in_kernel(BatchKernel kernel, const Batch& batch, const Arrays& recorded, std::size_t count) {
  Arrays found;
  for (const Quantity quantity : derived) found[quantity].resize(count, 12345.0);
  const std::vector<Batch::Input> inputs = inputs_of(recorded);
  const std::vector<Batch::Output> outputs = outputs_of(found);
  BatchJob job;
  job.chain = &batch.chain();
  job.parameters = batch.chain().parameters().data();
  job.runs.fill(true);
  job.inputs = inputs.data();
  job.input_count = inputs.size();
  job.outputs = outputs.data();
  job.output_count = outputs.size();
  job.samples = count;
  kernel(job);
  return found;
}

TEST(Batch, EqualsLoopInEverySupportedKernel) {
  const std::vector<Quantity> roles = with_lams(gv_roles);
  const Batch batch(gv(), roles);
  constexpr std::size_t count = 1001;
  const Arrays recorded = random_samples(count, roles);
  const Arrays expected = in_loop(gv(), roles, recorded, count, CorrectWith::model);
  EXPECT_EQ(batch_kernels().back(), &run_batch);
  for (const BatchKernel kernel : batch_kernels())
    expect_equal(in_kernel(kernel, batch, recorded, count), expected);
}

TEST(Batch, EachFormulaFunctionMatchesLoopInEveryKernel) {
  const std::vector<double> values{0.3, -0.7,  0.0, 2.5, nan,  1.0,   -2.0,   17.0,  1e-3,
                                   0.5, -0.31, 4.0, 1e5, -7e4, 700.0, -745.0, 1e-300};
  const std::vector<Quantity> roles{Quantity::static_pressure, Quantity::dynamic_pressure};
  const Arrays recorded{{Quantity::static_pressure, std::vector<double>(values.size(), 700.0)},
                        {Quantity::dynamic_pressure, std::vector<double>(values.size(), 70.0)},
                        {extra_quantity(0), values}};
  for (const char* text : {"exp(x)", "log(x)", "log10(x)", "sqrt(x)", "abs(x)", "sin(x)", "cos(x)", "tan(x)",
                           "tanh(x)", "min(x, 1)", "max(x, -1)", "x^3", "x^-2", "x^1.5", "pow(2, x)",
                           "if(x < 0.4, x, 1/x)", "if(x >= 2.5, -x, 2)"}) {
    Model model;
    ModelEffect effect;
    effect.id = "function";
    effect.formula = "k * (" + std::string(text) + ")";
    effect.parameter_names = {"k"};
    effect.parameters = {0.01};
    model.effects = {effect};
    const Batch batch(model, roles);
    const Arrays expected = in_loop(model, roles, recorded, values.size(), CorrectWith::model);
    EXPECT_GT(values_in(expected.at(Quantity::static_defect)), 4U) << text;
    for (const BatchKernel kernel : batch_kernels()) {
      const Arrays found = in_kernel(kernel, batch, recorded, values.size());
      for (std::size_t i = 0; i < values.size(); ++i) {
        const double defect = found.at(Quantity::static_defect)[i];
        const double requested = expected.at(Quantity::static_defect)[i];
        if (std::isnan(defect) && std::isnan(requested)) continue;
        // Rounding of the functions of packs, and of a sine near its zeros.
        EXPECT_NEAR(defect, requested, 4e-15 * std::abs(requested) + 1e-17) << text << " of " << values[i];
      }
    }
  }
}

TEST(Batch, MissingValuesAreReported) {
  const Batch batch(gv(), gv_roles);
  Arrays recorded = random_samples(10, gv_roles);
  recorded.erase(Quantity::attack);
  EXPECT_THAT(test::error_of([&] { in_batch(batch, recorded, 10); }),
              test::IsError(Error::Code::variable, "'attack'"));
  EXPECT_THAT(test::error_of([] { Batch(gv(), {Quantity::static_pressure}); }),
              test::IsError(Error::Code::model, "'dynamic_pressure'"));
  EXPECT_THAT(test::error_of([] { Batch(gv(), gv_roles, CorrectWith::lams); }),
              test::IsError(Error::Code::model, "'lams_airspeed'"));
}

// Each supported output has the same value alone and among all others; any other output is refused. No value
// is missing because a stage was omitted.
TEST(Batch, SingleOutputEqualsJointOutputOrIsRefused) {
  for (const CorrectWith with : {CorrectWith::model, CorrectWith::lams}) {
    const std::vector<Quantity> roles = with_lams(gv_roles);
    const Batch batch(gv(), roles, with);
    constexpr std::size_t count = 50;
    const Arrays recorded = random_samples(count, roles);
    const Arrays together = in_batch(batch, recorded, count);
    for (std::size_t position = 0; position < state_capacity; ++position) {
      const auto quantity = static_cast<Quantity>(position);
      std::vector<double> values(count);
      const auto run = [&] { batch.run(inputs_of(recorded), {{quantity, values.data()}}, count); };
      if (!batch.finds(quantity)) {
        EXPECT_THAT(test::error_of(run), test::IsError(Error::Code::variable)) << position;
        continue;
      }
      run();
      EXPECT_GT(values_in(values), count / 2) << info_of(quantity).name;
      if (together.count(quantity) == 0) continue;
      EXPECT_THAT(values, testing::Pointwise(testing::NanSensitiveDoubleEq(), together.at(quantity)))
          << info_of(quantity).name;
    }
  }
}

TEST(Batch, UnrecordedAndHistoryInputsAreRefused) {
  const Batch batch(gv(), {Quantity::static_pressure, Quantity::dynamic_pressure, Quantity::attack});
  for (const Quantity quantity :
       {Quantity::corrected_airspeed, Quantity::lams_temperature, Quantity::height_step,
        Quantity::filtered_lams_temperature, Quantity::roll}) {
    EXPECT_FALSE(batch.finds(quantity)) << info_of(quantity).name;
  }
}

}  // namespace
}  // namespace pcor
