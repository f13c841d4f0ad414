#include <gmock/gmock.h>
#include <pcor/effects/catalogue.hpp>
#include <pcor/effects/without_trace.hpp>
#include <pcor/model/formula.hpp>
#include "support/archetype.hpp"
#include "support/input_range.hpp"
#include "support/test_name.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

// Laws that hold for every effect of the catalogue, the ones to come included.

using pcor::effect_facts;
using pcor::effect_functions;
using pcor::effect_named;
using pcor::EffectFacts;
using pcor::Formula;
using pcor::FormulaError;
using pcor::Quantity;
using pcor::State;
using testing::MatchesRegex;

namespace {

using Parameters = std::vector<double>;

double value(const EffectFacts& facts, const State<double>& state, const Parameters& parameters) {
  return effect_functions<double, double>[effect_named(facts.id)](state, parameters.data());
}

// Random inputs of flight and parameters, within the bounds of the parameters.
class Draw {
 public:
  State<double> state(const EffectFacts& facts) {
    State<double> state;
    for (std::size_t i = 0; i < facts.need_count(); ++i) {
      const InputRange range = input_range(facts.needs[i]);
      state[facts.needs[i]] = uniform(range.lower, range.upper);
    }
    return state;
  }
  Parameters parameters(const EffectFacts& facts) {
    Parameters result;
    for (std::size_t i = 0; i < facts.parameter_count(); ++i) {
      const auto& parameter = facts.parameters[i];
      result.push_back(uniform(parameter.lower, parameter.upper));
    }
    return result;
  }

 private:
  double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine_); }
  std::mt19937_64 engine_{20120106};
};

// `parameters`, but those that do not shape the effect are neutral where `keep` is not their number.
Parameters neutral_but(const EffectFacts& facts, Parameters parameters, std::size_t keep) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (i != keep && !facts.parameters[i].shape) parameters[i] = facts.parameters[i].neutral;
  }
  return parameters;
}

// The parts of the value that each parameter makes, without their signs: what rounding is measured by.
double size(const EffectFacts& facts, const State<double>& state, const Parameters& parameters) {
  double sum = 0.0;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (!facts.parameters[i].shape) sum += std::abs(value(facts, state, neutral_but(facts, parameters, i)));
  }
  return sum;
}

// The power of `base` in a unit such as "hPa/deg2".
int power_of(const std::string& base, std::string_view unit) {
  int sign = 1;
  int power = 0;
  std::istringstream factors{std::string(unit)};
  for (std::string factor; std::getline(factors, factor, '/'); sign = -1) {
    const bool is_raised = std::isdigit(factor.back()) != 0 && factor.size() > 1;
    const int exponent = is_raised ? factor.back() - '0' : 1;
    if (is_raised) factor.pop_back();
    if (factor == base) power += sign * exponent;
  }
  return power;
}

std::vector<std::string> listed(std::string_view list) {
  std::vector<std::string> result;
  std::istringstream items{std::string(list)};
  for (std::string item; std::getline(items, item, ',');)
    result.push_back(item.substr(item.find_first_not_of(' ')));
  return result;
}

bool is_without_trace(std::string_view id) {
  const auto& all = pcor::effects_without_trace;
  return std::any_of(all.begin(), all.end(), [id](const auto& effect) { return effect.id == id; });
}

class EveryEffect : public testing::TestWithParam<EffectFacts> {};

}  // namespace

TEST(Catalogue, IdsAreUniqueAndResolve) {
  std::set<std::string> ids;
  for (std::size_t i = 0; i < pcor::catalogue_size; ++i) {
    EXPECT_TRUE(ids.emplace(effect_facts[i].id).second) << effect_facts[i].id;
    EXPECT_EQ(effect_named(effect_facts[i].id), i);
  }
  EXPECT_EQ(effect_named("static"), pcor::catalogue_size);
  EXPECT_EQ(effect_named(""), pcor::catalogue_size);
}

TEST(Catalogue, HoldsTheTermsOfTheMemoUnderTheirNames) {
  // Model files hold on to these ids and parameters.
  for (const auto& [id, parameter] : {std::pair{"static-constant", "a0"},
                                      {"static-alpha", "a1"},
                                      {"static-qp", "a2"},
                                      {"static-alpha-quad", "a4"},
                                      {"static-mach", "m1"},
                                      {"static-mach2", "m2"},
                                      {"static-mach3", "m3"},
                                      {"static-beta-odd", "b1"},
                                      {"static-beta-even", "b2"}}) {
    ASSERT_NE(effect_named(id), pcor::catalogue_size) << id;
    const EffectFacts& facts = effect_facts[effect_named(id)];
    EXPECT_EQ(facts.parameter_count(), 1U);
    EXPECT_EQ(facts.parameters[0].name, parameter);
    EXPECT_EQ(facts.where, pcor::Where::static_defect);
  }
}

TEST(Catalogue, HoldsZeroGainAndDriftAtEveryPlaceThatHasThem) {
  // Findings name these ids, families and places, and scripts read them.
  struct Row {
    const char *id, *family, *place;
  };
  for (const auto& [id, family, place] : {Row{"psfd-bias", "zero", "p-transducer"},
                                          {"qcf-zero", "zero", "q-transducer"},
                                          {"static-constant", "zero", "port"},
                                          {"temp-offset", "zero", "thermometer"},
                                          {"psfd-gain", "gain", "p-transducer"},
                                          {"qcf-gain", "gain", "q-transducer"},
                                          {"psfd-drift", "drift", "p-transducer"},
                                          {"qcf-drift", "drift", "q-transducer"},
                                          {"time-drift", "drift", "port"},
                                          {"temp-drift", "drift", "thermometer"},
                                          {"psfd-thermal", "thermal drift", "p-transducer"},
                                          {"transducer-thermal", "thermal drift", "q-transducer"}}) {
    ASSERT_NE(effect_named(id), pcor::catalogue_size) << id;
    const EffectFacts& facts = effect_facts[effect_named(id)];
    EXPECT_EQ(facts.family, family) << id;
    EXPECT_EQ(place_of(facts), place) << id;
  }
}

TEST(Catalogue, KnowsEveryEffectOfPressureCalibrationOnce) {
  // What is known of airborne pressure calibration with a laser: a term of a model can describe it, or there
  // is a reason why none can.
  for (const char* id : {"static-alpha",
                         "static-alpha-quad",
                         "static-mach",
                         "static-transonic",
                         "static-beta-odd",
                         "static-beta-even",
                         "flaps-gear",
                         "speedbrake-thrust",
                         "ground-effect",
                         "load-factor",
                         "roll-static",
                         "aircraft-change",
                         "pitot-angle",
                         "pitot-blockage",
                         "qcr-angle",
                         "qcf-zero",
                         "qcf-gain",
                         "psfd-bias",
                         "transducer-thermal",
                         "adif-drift",
                         "radome-port-ice",
                         "static-lag",
                         "total-lag",
                         "static-leak",
                         "line-head",
                         "lams-elevation",
                         "lams-azimuth",
                         "lams-pod-flex",
                         "lams-scale",
                         "lams-resolution",
                         "lams-fold",
                         "lams-induction",
                         "lams-volume",
                         "lams-cloud",
                         "lams-tas-lock",
                         "recovery-factor",
                         "temp-offset",
                         "temp-lag",
                         "temp-deice-heat",
                         "temp-wetting",
                         "humidity-neglected",
                         "humidity-error",
                         "clock-skew",
                         "avionics-filter",
                         "horizontal-gradient",
                         "hydrostatic-t-gradient",
                         "wind-change",
                         "mach-source",
                         "pcor-regime",
                         "line-resonance",
                         "real-gas-cp",
                         "gravity-geopotential",
                         "non-hydrostatic",
                         "gps-height",
                         "vspd-baro",
                         "heading-offset",
                         "lams-dropout",
                         "ground-return",
                         "propeller-inflow"}) {
    EXPECT_NE(effect_named(id) != pcor::catalogue_size, is_without_trace(id)) << id;
  }
  for (const char* id : {"static-constant", "static-qp", "static-mach2", "static-mach3", "static-attack",
                         "time-drift", "aircraft-step"})
    EXPECT_NE(effect_named(id), pcor::catalogue_size) << id;
}

TEST(Catalogue, SaysWhyAnEffectLeavesNoTrace) {
  std::set<std::string> ids;
  for (const auto& effect : pcor::effects_without_trace) {
    EXPECT_TRUE(ids.emplace(effect.id).second) << effect.id;
    EXPECT_THAT(std::string(effect.id), MatchesRegex("[a-z][a-z0-9]*(-[a-z0-9]+)*"));
    EXPECT_FALSE(effect.title.empty()) << effect.id;
    EXPECT_GT(effect.reason.size(), 20U) << effect.id;
  }
}

TEST(Catalogue, SumsToEquation18) {
  // The C-130 of the memo at 700 hPa, 120 m/s: q 67.6 hPa, ratio -0.318. Worked by hand; to 0.01 hPa
  // (with p and q before the correction it is 0.24).
  State<double> state;
  state[Quantity::static_pressure] = 700;
  state[Quantity::dynamic_ratio] = 67.6 / 700;
  state[Quantity::attack_ratio] = -0.318;
  const double sum = value(effect_facts[effect_named("static-constant")], state, {.004127875}) +
                     value(effect_facts[effect_named("static-alpha")], state, {.021279816}) +
                     value(effect_facts[effect_named("static-qp")], state, {.030849643});
  EXPECT_NEAR(sum, 2.8895 - 4.7369 + 2.0854, 2e-4);
  EXPECT_NEAR(sum, 0.24, 0.006);
}

TEST_P(EveryEffect, IsNamedInLowerCaseWithHyphens) {
  EXPECT_THAT(std::string(GetParam().id), MatchesRegex("[a-z][a-z0-9]*(-[a-z0-9]+)*"));
}

TEST_P(EveryEffect, IsDocumented) {
  const EffectFacts& facts = GetParam();
  EXPECT_FALSE(facts.title.empty());
  EXPECT_THAT(std::string(facts.family), MatchesRegex("[A-Za-z]+( [a-z]+)*"));
  EXPECT_FALSE(facts.formula.empty());
  EXPECT_FALSE(facts.size.empty());
  EXPECT_FALSE(facts.look_alikes.empty());
  EXPECT_FALSE(facts.manoeuvre.empty());
  EXPECT_FALSE(facts.source.empty());
  EXPECT_LT(static_cast<std::size_t>(facts.where), pcor::where_count);
}

TEST_P(EveryEffect, ParametersHaveNameUnitAndBounds) {
  const EffectFacts& facts = GetParam();
  ASSERT_GE(facts.parameter_count(), 1U);
  std::set<std::string> names;
  for (std::size_t i = 0; i < pcor::parameter_capacity; ++i) {
    const auto& parameter = facts.parameters[i];
    if (i >= facts.parameter_count()) {
      EXPECT_TRUE(parameter.name.empty()) << "parameters must follow each other without a gap";
      continue;
    }
    EXPECT_THAT(std::string(parameter.name), MatchesRegex("[a-z][a-z0-9_]*"));
    EXPECT_TRUE(names.emplace(parameter.name).second) << parameter.name;
    EXPECT_FALSE(parameter.unit.empty()) << parameter.name;
    EXPECT_LT(parameter.lower, parameter.upper) << parameter.name;
    EXPECT_LE(parameter.lower, parameter.neutral) << parameter.name;
    EXPECT_LE(parameter.neutral, parameter.upper) << parameter.name;
    EXPECT_LE(parameter.lower, parameter.typical) << parameter.name;
    EXPECT_LE(parameter.typical, parameter.upper) << parameter.name;
    EXPECT_EQ(parameter.typical == parameter.neutral, parameter.shape) << parameter.name;
    EXPECT_TRUE(std::isfinite(parameter.lower) && std::isfinite(parameter.upper)) << parameter.name;
  }
  EXPECT_FALSE(facts.parameters[0].shape) << "the first parameter is a size";
}

TEST_P(EveryEffect, NamesEffectsThatLookLikeIt) {
  for (const std::string& id : listed(GetParam().look_alikes)) {
    EXPECT_TRUE(effect_named(id) != pcor::catalogue_size || is_without_trace(id)) << id;
    EXPECT_NE(id, GetParam().id);
  }
}

TEST_P(EveryEffect, HasTheUnitOfItsPlace) {
  // In units half as large, every number of the unit doubles, that of the value included; or the formula has
  // a constant of that unit.
  const std::set<std::pair<std::string, std::string>> with_constant{
      {"temp-deice-heat", "hPa"}, {"roll-static", "deg"}, {"load-factor", "m"}, {"lams-pod-flex", "m"},
      {"line-head", "m"},         {"lams-cloud", "m"},    {"temp-wetting", "m"}};
  const EffectFacts& facts = GetParam();
  Draw draw;
  for (const std::string base : {"hPa", "deg", "m"}) {
    if (with_constant.count({std::string(facts.id), base}) > 0) continue;
    State<double> state = draw.state(facts);
    Parameters parameters = draw.parameters(facts);
    const double expected =
        value(facts, state, parameters) * std::exp2(power_of(base, facts_of(facts.where).unit));
    for (std::size_t i = 0; i < facts.need_count(); ++i)
      state[facts.needs[i]] *= std::exp2(power_of(base, facts_of(facts.needs[i]).unit));
    for (std::size_t i = 0; i < parameters.size(); ++i)
      parameters[i] *= std::exp2(power_of(base, facts.parameters[i].unit));
    EXPECT_NEAR(value(facts, state, parameters), expected, 1e-14 * std::abs(expected)) << base;
  }
}

TEST_P(EveryEffect, IsAbsentAtItsNeutralParameters) {
  Draw draw;
  for (int i = 0; i < 100; ++i) {
    const Parameters neutral = neutral_but(GetParam(), draw.parameters(GetParam()), pcor::parameter_capacity);
    EXPECT_EQ(value(GetParam(), draw.state(GetParam()), neutral), 0.0);
  }
}

TEST_P(EveryEffect, IsLinearInItsParameters) {
  // Those of shape stay as they are. Some products of rounding 1e-16 of the larger of the parts.
  const EffectFacts& facts = GetParam();
  Draw draw;
  for (int i = 0; i < 100; ++i) {
    const State<double> state = draw.state(facts);
    const Parameters a = draw.parameters(facts);
    Parameters b = draw.parameters(facts), sum = a, triple = a;
    for (std::size_t j = 0; j < a.size(); ++j) {
      if (facts.parameters[j].shape) {
        b[j] = a[j];
      } else {
        sum[j] += b[j];
        triple[j] *= 3;
      }
    }
    const double va = value(facts, state, a), vb = value(facts, state, b);
    const double parts = size(facts, state, a) + size(facts, state, b);
    EXPECT_NEAR(value(facts, state, sum), va + vb, 1e-14 * parts);
    EXPECT_NEAR(value(facts, state, triple), 3 * va, 1e-14 * parts);
  }
}

TEST_P(EveryEffect, ReproducesItsWorkedExample) {
  const EffectFacts& facts = GetParam();
  State<double> state;
  std::set<Quantity> given;
  for (const auto& input : facts.example.inputs) {
    if (input.quantity == Quantity::count) continue;
    state[input.quantity] = input.value;
    given.insert(input.quantity);
  }
  const std::set<Quantity> needed(facts.needs.begin(), facts.needs.begin() + facts.need_count());
  EXPECT_EQ(given, needed) << "the example shows every input, and nothing else";
  const Parameters parameters(facts.example.parameters.begin(),
                              facts.example.parameters.begin() + facts.parameter_count());
  EXPECT_NE(facts.example.value, 0.0);
  EXPECT_NEAR(value(facts, state, parameters) / facts.example.value, 1.0, 1e-12);
}

TEST_P(EveryEffect, NeedsEveryInputThatItNames) {
  const EffectFacts& facts = GetParam();
  Draw draw;
  const Parameters parameters = draw.parameters(facts);
  for (std::size_t i = 0; i < facts.need_count(); ++i) {
    State<double> state = draw.state(facts);
    state[facts.needs[i]] = std::nan("");
    EXPECT_TRUE(std::isnan(value(facts, state, parameters))) << facts_of(facts.needs[i]).name;
  }
  EXPECT_FALSE(std::isnan(value(facts, draw.state(facts), parameters))) << "and no other";
}

TEST_P(EveryEffect, IsTheFormulaThatItDocuments) {
  const EffectFacts& facts = GetParam();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < facts.parameter_count(); ++i) names.emplace_back(facts.parameters[i].name);
  FormulaError error;
  const auto formula = Formula::parse(facts.formula, names, &error);
  ASSERT_TRUE(formula.has_value()) << error.message;
  // The time over which a need is found is in that need.
  const bool remembers = facts.memory.of != Quantity::count && facts.parameters[facts.memory.parameter].shape;
  EXPECT_EQ(formula->unused_parameters(),
            remembers ? std::vector<std::string>{names[facts.memory.parameter]} : std::vector<std::string>{});

  std::set<Quantity> used;
  for (const std::string& name : formula->variables()) used.insert(pcor::quantity_named(name));
  EXPECT_EQ(used, std::set<Quantity>(facts.needs.begin(), facts.needs.begin() + facts.need_count()));

  // The order of operations may differ: 1e-16 for each of them.
  Draw draw;
  for (int i = 0; i < 1000; ++i) {
    const State<double> state = draw.state(facts);
    const Parameters parameters = draw.parameters(facts);
    std::vector<double> variables;
    for (const std::string& name : formula->variables())
      variables.push_back(state[pcor::quantity_named(name)]);
    const double expected = formula->value(variables.data(), parameters.data());
    EXPECT_NEAR(value(facts, state, parameters), expected, 1e-14 * size(facts, state, parameters));
  }
}

TEST_P(EveryEffect, CompilesForAScalarThatIsNoDouble) {
  using archetype::Physics;
  const EffectFacts& facts = GetParam();
  Draw draw;
  const State<double> state = draw.state(facts);
  const Parameters parameters = draw.parameters(facts);
  State<Physics> numbers;
  for (std::size_t i = 0; i < facts.need_count(); ++i)
    numbers[facts.needs[i]] = Physics(state[facts.needs[i]]);
  const std::vector<Physics> coefficients(parameters.begin(), parameters.end());
  const Physics result =
      effect_functions<Physics, Physics>[effect_named(facts.id)](numbers, coefficients.data());
  EXPECT_EQ(result.value(), value(facts, state, parameters));
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryEffect, testing::ValuesIn(effect_facts),
                         [](const auto& effect) { return pcor::test::test_name(effect.param.id); });
