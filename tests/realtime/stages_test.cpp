// The declarations of the stages of a chain are true, so that loops and batches may rely on them.
#include <pcor/realtime/stages.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <string>

namespace pcor {
namespace {

double sample_value(Quantity quantity) {
  switch (quantity) {
    case Quantity::static_pressure:
      return 700.0;
    case Quantity::dynamic_pressure:
    case Quantity::radome_dynamic_pressure:
      return 67.0;
    case Quantity::lams_airspeed:
      return 122.0;
    case Quantity::vapor_pressure:
      return 3.0;
    default:
      return info_of(quantity).unit == "K" ? 275.0 + 0.01 * static_cast<double>(index(quantity)) : 1.5;
  }
}

// All of the catalogue, each with parameters of a size that is felt and breaks nothing.
Model every_effect(LamsApproach approach) {
  Model model;
  for (const EffectInfo& info : effect_info) {
    model.effects.push_back({std::string(info.id), std::vector<double>(info.parameter_count(), 1e-4)});
  }
  ModelEffect formula;
  formula.id = "of-the-user";
  formula.formula = "0.001 * pitch + 0.01 * PROBE";
  model.effects.push_back(formula);
  model.domain = {{"altitude", 0.0, 1.0}};
  model.lams.approach = approach;
  model.recovery = {{0.95}};
  model.attack_radome = {4.9, 13.4, 6.1};
  model.sideslip_radome = {0.1, 11.8, 0.0};
  return model;
}

Quantities roles_without(const Quantities& excluded) {
  Quantities roles;
  for (std::size_t i = 0; i < role_count; ++i) {
    const auto role = static_cast<Quantity>(i);
    if (std::find(excluded.begin(), excluded.end(), role) == excluded.end()) roles.push_back(role);
  }
  return roles;
}

bool is_in(const Quantities& quantities, std::size_t position) {
  return std::find(quantities.begin(), quantities.end(), static_cast<Quantity>(position)) != quantities.end();
}

// A stage gives the same results for any values in quantities outside its declared inputs, and changes only
// its declared outputs.
void expect_true_words(const Correction& correction) {
  State<double> before;
  for (const Quantity input : correction.chain.inputs()) {
    before[input] = index(input) < quantity_count ? sample_value(input) : 0.5;
  }
  for (const Rate& each : rates) before[each.rate] = 0.01;
  before[Quantity::airspeed_rate] = 0.4;
  before[Quantity::wetness] = 0.6;
  before[Quantity::time] = 100.0;
  std::size_t number = 0;
  Stages::each([&](auto stage) {
    SCOPED_TRACE(testing::Message() << "stage " << number++);
    const Quantities reads = stage.reads(correction);
    const Quantities writes = stage.writes(correction);
    const double* const parameters = correction.chain.parameters().data();
    NoQualityFlags none;
    State<double> after = before;
    State<double> other = before;
    for (std::size_t i = 0; i < state_capacity; ++i) {
      if (!is_in(reads, i)) other[static_cast<Quantity>(i)] = 1.1 * before[static_cast<Quantity>(i)] + 0.1;
    }
    const State<double> other_before = other;
    if (!writes.empty()) {
      stage.compute(correction, after, parameters, none);
      stage.compute(correction, other, parameters, none);
    }
    for (std::size_t i = 0; i < state_capacity; ++i) {
      const auto quantity = static_cast<Quantity>(i);
      if (is_in(writes, i)) {
        EXPECT_FALSE(is_missing(after[quantity])) << info_of(quantity).name;
        EXPECT_THAT(other[quantity], testing::NanSensitiveDoubleEq(after[quantity]))
            << info_of(quantity).name << " depends on an undeclared input";
      } else {
        EXPECT_THAT(other[quantity], testing::NanSensitiveDoubleEq(other_before[quantity]))
            << "place " << i << " is written but not declared";
      }
    }
    before = after;
  });
}

void expect_true_words(const Model& model, const Quantities& roles, CorrectWith with) {
  BindingError error;
  const std::optional<Chain> chain = Chain::build(model, roles, &error);
  ASSERT_TRUE(chain) << error.message();
  expect_true_words({*chain, with});
}

TEST(Stages, ReadAndWriteOnlyDeclaredQuantities) {
  for (const CorrectWith with : {CorrectWith::model, CorrectWith::lams}) {
    for (const LamsApproach approach : {LamsApproach::iterated, LamsApproach::simultaneous}) {
      const Model model = every_effect(approach);
      expect_true_words(
          model, roles_without({Quantity::ambient_temperature, Quantity::attack, Quantity::sideslip}), with);
      expect_true_words(model, roles_without({Quantity::ambient_temperature, Quantity::vapor_pressure}),
                        with);
    }
    expect_true_words(every_effect(LamsApproach::with_temperature), roles_without({}), with);
  }
}

/// Chain with flow angles of the radome, humidity by a mirror and a recovery temperature.
std::optional<Chain> chain_of_radome(Model model) {
  model.attack_radome = {4.9, 13.4, 6.1};
  model.sideslip_radome = {0.1, 11.8, 0.0};
  BindingError error;
  std::optional<Chain> chain =
      Chain::build(model,
                   roles_without({Quantity::mach, Quantity::attack, Quantity::sideslip,
                                  Quantity::vapor_pressure, Quantity::ambient_temperature}),
                   &error);
  EXPECT_TRUE(chain) << error.message();
  return chain;
}

// A quantity depends only on its declared sources.
TEST(Stages, DerivedQuantitiesDependOnDeclaredSourcesOnly) {
  Model model;
  model.effects = {{"static-alpha", {0.02}}, {"static-qp", {0.03}}, {"static-beta-odd", {0.01}},
                   {"static-mach2", {0.01}}, {"clock-skew", {0.1}}, {"humidity-error", {0.1}}};
  const std::optional<Chain> chain = chain_of_radome(std::move(model));
  ASSERT_TRUE(chain);
  State<double> state;
  for (const Quantity input : chain->inputs()) state[input] = sample_value(input);
  for (const Rate& each : rates) state[each.rate] = 0.01;
  NoQualityFlags none;
  for (const Quantity derived :
       {Quantity::dynamic_ratio, Quantity::mach, Quantity::attack_ratio, Quantity::sideslip_ratio,
        Quantity::attack, Quantity::sideslip, Quantity::vapor_pressure}) {
    State<double> before = state;
    chain->correct_inputs(before, chain->parameters().data(), none);
    const Quantities sources = MeasuredQuantities::sources(*chain, derived);
    for (const Quantity input : chain->inputs()) {
      State<double> after = state;
      after[input] = 1.01 * state[input];
      chain->correct_inputs(after, chain->parameters().data(), none);
      EXPECT_TRUE(after[derived] == before[derived] || is_in(sources, index(input)))
          << info_of(derived).name << " is moved by " << info_of(input).name;
    }
    EXPECT_FALSE(sources.empty()) << info_of(derived).name;
  }
}

TEST(Stages, RateOfTheAirspeedDependsOnDeclaredSourcesOnly) {
  Model model;
  model.effects = {{"static-alpha", {0.02}},      {"static-beta-odd", {0.01}}, {"load-factor", {0.1}},
                   {"psfd-thermal", {0.01, 0.0}}, {"humidity-error", {0.1}},   {"clock-skew", {0.1}}};
  const std::optional<Chain> chain = chain_of_radome(std::move(model));
  ASSERT_TRUE(chain);
  State<double> state;
  for (const Quantity input : chain->inputs()) state[input] = sample_value(input);
  const auto airspeed = [&](const State<double>& of) {
    return chain->airspeed_along_beam(of, chain->parameters().data());
  };
  const Quantities sources = MeasuredQuantities::sources(*chain, Quantity::airspeed_rate);
  std::size_t moved = 0;
  for (const Quantity input : chain->inputs()) {
    State<double> after = state;
    after[input] = 1.01 * state[input];
    if (airspeed(after) == airspeed(state)) continue;
    EXPECT_TRUE(is_in(sources, index(input))) << info_of(input).name;
    ++moved;
  }
  // Both pressures, thermometer, dew point, three radome pressures, load, temperature of the transducer.
  EXPECT_EQ(moved, 9U);
  EXPECT_FALSE(is_in(sources, index(Quantity::lams_airspeed)));
}

TEST(Stages, DeclarationsHoldWithoutLaserAndTemperature) {
  Model model;
  model.effects = {{"static-qp", {0.03}}, {"static-mach2", {0.01}}};
  expect_true_words(model, {Quantity::static_pressure, Quantity::dynamic_pressure}, CorrectWith::model);
}

}  // namespace
}  // namespace pcor
