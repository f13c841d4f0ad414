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
#include "support/error_of.hpp"

using namespace pcor::internal;

namespace pcor {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

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

/// Compares derivatives of the static defect with differences: a step of a coefficient in which it is linear,
/// and of any size, gives the derivative.
void expect_derivatives_of(const Model& model, std::size_t effect) {
  constexpr std::size_t count = 2000;
  const Arrays recorded = random_samples(count, gv_roles);
  const std::vector<Batch::Input> inputs = inputs_of(recorded);
  const Batch batch(model, gv_roles);
  const Chain& chain = batch.chain();
  std::vector<double> defect(count);
  batch.run(inputs, {{Quantity::static_defect, defect.data()}}, count);
  for (std::size_t parameter = 0; parameter < chain.parameter_count_of(effect); ++parameter) {
    std::vector<double> found(count);
    const std::vector<Batch::Derivative> derivatives{{effect, parameter, found.data()}};
    if (!chain.is_defect_linear(effect, parameter)) {
      EXPECT_THAT(test::error_of([&] { batch.differentiate(inputs, derivatives, count); }),
                  test::IsError(Error::Code::usage, "not linear"));
      continue;
    }
    batch.differentiate(inputs, derivatives, count);
    std::vector<double> moved = chain.parameters();
    constexpr double step = 1e-4;
    moved[chain.first_parameter_of(effect) + parameter] += step;
    std::vector<double> stepped(count);
    batch.run(inputs, {{Quantity::static_defect, stepped.data()}}, count, moved.data());
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(std::isnan(found[i]), std::isnan(defect[i])) << i;
      // A step may make the defect larger than the dynamic pressure.
      if (std::isnan(stepped[i]) || std::isnan(found[i])) continue;
      // The difference of two defects is rounded to 1e-13 hPa, over the step of 1e-4.
      const double difference = (stepped[i] - defect[i]) / step;
      ASSERT_NEAR(found[i], difference, 1e-8 + 1e-9 * std::abs(difference))
          << model.effects[effect].id << " " << parameter << " of sample " << i;
    }
  }
}

TEST(Batch, DerivativesEqualDifferencesForEveryEffectAtTheStaticPorts) {
  std::size_t tested = 0;
  for (const EffectInfo& info : effect_info) {
    if (info.location != EffectLocation::static_defect) continue;
    Model model = gv();
    ModelEffect& effect = model.effects.emplace_back();
    effect.id = std::string(info.id);
    effect.scaling = {1, -1};
    for (std::size_t i = 0; i < info.parameter_count(); ++i)
      effect.parameters.push_back(info.parameters[i].neutral + 0.5 * info.parameters[i].typical);
    std::optional<Chain> chain = Chain::build(model, gv_roles, nullptr);
    if (!chain || chain->derives(Quantity::static_pressure_rate) || chain->derives(Quantity::time)) continue;
    ++tested;
    expect_derivatives_of(model, model.effects.size() - 1);
  }
  EXPECT_GE(tested, 8U);
}

TEST(Batch, DerivativesOfSurfaceAreItsSplines) {
  Model model = gv();
  ModelEffect effect;
  effect.id = "surface";
  effect.surface = Surface{{{{Quantity::attack, -1.0, 8.0, 5}, {Quantity::mach, 0.2, 0.8, 7}}}};
  effect.parameters.assign(effect.surface->parameter_count(), 0.0);
  for (std::size_t i = 0; i < effect.parameters.size(); ++i)
    effect.parameters[i] = 1e-3 * static_cast<double>(i % 5);
  model.effects.push_back(effect);
  expect_derivatives_of(model, model.effects.size() - 1);
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
