#include <gmock/gmock.h>
#include <pcor/realtime/chain.hpp>
#include "realtime/sample.hpp"
#include "support/archetype.hpp"
#include "support/atmosphere.hpp"
#include "support/constants.hpp"

#include <cmath>
#include <random>
#include <string>
#include <thread>
#include <vector>

using pcor::BindingError;
using pcor::Chain;
using pcor::EffectLocation;
using pcor::LamsApproach;
using pcor::Model;
using pcor::ModelEffect;
using pcor::moist_air;
using pcor::Quality;
using pcor::QualityFlags;
using pcor::Quantity;
using pcor::State;
using pcor::test::missing;
using pcor::test::roles_of;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

namespace {

using Recorded = pcor::test::Sample;

Chain build_chain(const Model& model, const Recorded& recorded) {
  BindingError error;
  auto chain = Chain::build(model, roles_of(recorded), &error);
  if (!chain) throw std::runtime_error(error.message());
  return *chain;
}

std::string error_of(const Model& model, const Recorded& recorded) {
  BindingError error;
  return Chain::build(model, roles_of(recorded), &error) ? "no error" : error.message();
}

struct ChainResult {
  State<double> state;
  QualityFlags flags;

  double operator[](Quantity quantity) const { return state[quantity]; }
  bool has(Quality bit) const { return flags.has(bit); }
};

// One sample through all stages.
ChainResult fly(const Chain& chain, const Recorded& recorded) {
  ChainResult sample;
  auto& [state, flags] = sample;
  for (const auto& [quantity, value] : recorded) state[quantity] = value;
  const double* parameters = chain.parameters().data();
  chain.correct_inputs(state, parameters, flags);
  state[Quantity::static_defect] = chain.static_defect(state, parameters, flags);
  if (chain.has_lams())
    state[Quantity::lams_static_defect] = chain.lams_static_defect(state, parameters, flags);
  chain.correct(state, state[Quantity::static_defect], flags);
  chain.air(state, parameters, flags);
  if (chain.has_lams()) chain.lams_air(state, parameters, flags);
  return sample;
}

ChainResult fly(const Model& model, const Recorded& recorded) {
  return fly(build_chain(model, recorded), recorded);
}

Recorded with(Recorded recorded, Quantity quantity, double value) {
  recorded[quantity] = value;
  return recorded;
}

Recorded without(Recorded recorded, Quantity quantity) {
  recorded.erase(quantity);
  return recorded;
}

ModelEffect catalogued(std::string id, std::vector<double> parameters) {
  ModelEffect effect;
  effect.id = std::move(id);
  effect.parameters = std::move(parameters);
  return effect;
}

ModelEffect written(EffectLocation location, std::string formula, std::vector<std::string> names = {},
                    std::vector<double> values = {}) {
  ModelEffect effect;
  effect.id = "of-the-user";
  effect.location = location;
  effect.formula = std::move(formula);
  effect.parameter_names = std::move(names);
  effect.parameters = std::move(values);
  return effect;
}

Model with(Model model, ModelEffect effect) {
  model.effects.push_back(std::move(effect));
  return model;
}

// The air over the C-130, and what its sensors record of it: delta-p is 0.5 % of the measured static
// pressure.
struct Truth {
  double p = 700, v = 120, T = 270, e = 3, alpha = 2.5, beta = -1, elevation = 1.5, azimuth = -0.8;
  double recovery = 0.975;

  pcor::MoistAir<double> air() const { return moist_air(e / p); }
  double mach() const { return v / std::sqrt(air().heat_capacity_ratio * air().gas_constant * T); }
  double total() const {
    return p * std::pow(1 + v * v / (2 * air().specific_heat_pressure * T),
                        air().specific_heat_pressure / air().gas_constant);
  }
  double defect() const { return p - p / 1.005; }

  Model model() const {
    Model result;
    result.effects = {catalogued("static-constant", {0.005})};
    result.lams.elevation = elevation;
    result.lams.azimuth = azimuth;
    result.recovery = {{recovery, 0, 0, 0}};
    return result;
  }
  Recorded recorded() const {
    return {{Quantity::static_pressure, p / 1.005},
            {Quantity::dynamic_pressure, total() - p / 1.005},
            {Quantity::recovery_temperature, T + recovery * v * v / (2 * air().specific_heat_pressure)},
            {Quantity::vapor_pressure, e},
            {Quantity::attack, alpha},
            {Quantity::sideslip, beta},
            {Quantity::lams_airspeed, v * pcor::beam_cosine(elevation, azimuth, alpha, beta)}};
  }
};

const Truth truth;

}  // namespace

TEST(Chain, RecoversTheTrueAir) {
  // Two roundings of a pressure, 1e-13 of 700 hPa, are 1e-11 K and m/s; LAMS is exact to 1e-9 hPa.
  const ChainResult sample = fly(truth.model(), truth.recorded());
  EXPECT_EQ(sample.flags.bits(), 0U);
  EXPECT_NEAR(sample[Quantity::static_defect], truth.defect(), 1e-11);
  EXPECT_NEAR(sample[Quantity::corrected_static_pressure], truth.p, 1e-11);
  EXPECT_NEAR(sample[Quantity::corrected_dynamic_pressure], truth.total() - truth.p, 1e-11);
  EXPECT_NEAR(sample[Quantity::humidity], truth.e / truth.p, 1e-14);
  EXPECT_NEAR(sample[Quantity::corrected_mach], truth.mach(), 1e-12);
  EXPECT_NEAR(sample[Quantity::ambient_temperature], truth.T, 1e-10);
  EXPECT_NEAR(sample[Quantity::corrected_airspeed], truth.v, 1e-10);
  EXPECT_NEAR(sample[Quantity::lams_static_defect], truth.defect(), 1e-9);
  EXPECT_NEAR(sample[Quantity::lams_temperature], truth.T, 1e-9);
  EXPECT_NEAR(sample[Quantity::lams_dynamic_pressure], truth.total() - truth.p, 1e-9);
}

TEST(Chain, KeepsTheTotalPressure) {
  for (const double a0 : {-0.01, 0.0, 0.005, 0.02}) {
    Model model = truth.model();
    model.effects = {catalogued("static-constant", {a0})};
    const ChainResult s = fly(model, truth.recorded());
    EXPECT_NEAR(
        (s[Quantity::corrected_static_pressure] + s[Quantity::corrected_dynamic_pressure]) / truth.total(),
        1.0, 1e-12)
        << a0;
  }
}

TEST(Chain, ComputesEquation18OfTheMemo) {
  // 700 hPa, q 67.6 hPa, ADIFR/QCR -0.318: 0.24 hPa, worked by hand.
  Model model;
  model.effects = {catalogued("static-constant", {.004127875}), catalogued("static-alpha", {.021279816}),
                   catalogued("static-qp", {.030849643})};
  const ChainResult s = fly(model, {{Quantity::static_pressure, 700},
                                    {Quantity::dynamic_pressure, 67.6},
                                    {Quantity::attack_differential_pressure, -0.318 * 67},
                                    {Quantity::radome_dynamic_pressure, 67}});
  EXPECT_NEAR(s[Quantity::static_defect], 0.24, 0.006);
  EXPECT_NEAR(s[Quantity::attack_ratio], -0.318, 1e-15);
  EXPECT_NEAR(s[Quantity::dynamic_ratio], 67.6 / 700, 1e-15);
}

TEST(Chain, MachNumberOfTheMeasuredPairAssumesDryAir) {
  Model model;
  model.effects = {catalogued("static-mach", {0.01})};
  const Recorded recorded{{Quantity::static_pressure, 700}, {Quantity::dynamic_pressure, 67.6}};
  const double mach = std::sqrt(5 * (std::pow(1 + 67.6 / 700, 2.0 / 7.0) - 1));
  EXPECT_NEAR(fly(model, recorded)[Quantity::static_defect], 0.01 * mach * 700, 1e-12);
  // An independent Mach number is used unchanged.
  EXPECT_NEAR(fly(model, with(recorded, Quantity::mach, 0.4))[Quantity::static_defect], 2.8, 1e-12);
}

TEST(Chain, SumIsIndependentOfTheOrderOfEffects) {
  Model model = truth.model();
  model.effects = {catalogued("static-constant", {0.005}), catalogued("lams-elevation", {0.3}),
                   catalogued("static-qp", {0.02}), catalogued("recovery-factor", {0.01})};
  const Chain chain = build_chain(model, truth.recorded());
  EXPECT_THAT(chain.parameters(), ElementsAre(0.005, 0.3, 0.02, 0.01));
  const ChainResult s = fly(chain, truth.recorded());
  EXPECT_NEAR(s[Quantity::static_defect],
              0.005 * s[Quantity::static_pressure] + 0.02 * s[Quantity::dynamic_pressure], 1e-12);
  std::swap(model.effects[0], model.effects[3]);
  EXPECT_NEAR(fly(model, truth.recorded())[Quantity::lams_static_defect], s[Quantity::lams_static_defect],
              1e-12);
}

TEST(Chain, EffectsScaleWithMeasuredPressures) {
  // A scaled effect is the formula with the pressures written out. To rounding of some products.
  const Recorded recorded = truth.recorded();
  const auto corrected = [&](const ModelEffect& effect) {
    const ChainResult sample = fly(with(Model{}, effect), recorded);
    return std::pair(sample[Quantity::corrected_static_pressure],
                     sample[Quantity::corrected_dynamic_pressure]);
  };
  const auto expect_same = [&](ModelEffect effect, pcor::Scaling scaling, const ModelEffect& formula) {
    EXPECT_NE(corrected(effect), corrected(formula));
    effect.scaling = scaling;
    const auto [p, q] = corrected(effect);
    const auto [p_of_formula, q_of_formula] = corrected(formula);
    EXPECT_NEAR(p, p_of_formula, 1e-15 * 4 * p);
    EXPECT_NEAR(q, q_of_formula, 1e-15 * 4 * p);
  };
  expect_same(catalogued("static-attack", {0.002}), {-1, 1},
              written(EffectLocation::static_defect, "0.002 * attack * 700 * dynamic_pressure / 70"));
  expect_same(catalogued("qcf-zero", {0.4}), {0, -2},
              written(EffectLocation::dynamic_transducer, "-0.4 * (70 / dynamic_pressure)^2"));
}

TEST(Chain, WithoutEffectsKeepsThePressures) {
  Model model;
  const ChainResult s = fly(model, {{Quantity::static_pressure, 700}, {Quantity::dynamic_pressure, 67}});
  EXPECT_EQ(s[Quantity::static_defect], 0.0);
  EXPECT_EQ(s[Quantity::corrected_static_pressure], 700.0);
}

TEST(Policy, TaperIsContinuousAndZeroWithoutAirflow) {
  Model model = truth.model();
  model.policy.taper_below = 40;
  const auto defect = [&model](double q) {
    return fly(model, with(truth.recorded(), Quantity::dynamic_pressure, q))[Quantity::static_defect];
  };
  const double whole = 0.005 * truth.recorded()[Quantity::static_pressure];
  EXPECT_DOUBLE_EQ(defect(60), whole);
  EXPECT_DOUBLE_EQ(defect(40), whole);
  EXPECT_NEAR(defect(40 - 1e-9), whole, 1e-9);
  EXPECT_NEAR(defect(20), whole / 8, 1e-12) << "the cube of nimbus";
  EXPECT_EQ(defect(0), 0.0);
  EXPECT_EQ(defect(-5), 0.0);
  EXPECT_TRUE(std::isnan(defect(missing)));
  model.policy.taper_power = 1;
  EXPECT_NEAR(defect(20), whole / 2, 1e-12);
}

TEST(Policy, MissingInputOfATaperedDefectSetsABit) {
  Model model = with(truth.model(), catalogued("static-alpha", {0.02}));
  model.policy.taper_below = 20;
  Recorded recorded = with(truth.recorded(), Quantity::attack_differential_pressure, -5.0);
  recorded[Quantity::radome_dynamic_pressure] = missing;
  for (const double q : {1.5, 10.0, 60.0}) {
    const ChainResult s = fly(model, with(recorded, Quantity::dynamic_pressure, q));
    EXPECT_TRUE(std::isnan(s[Quantity::static_defect])) << q;
    EXPECT_TRUE(s.has(Quality::effect_input_missing)) << q;
  }
}

TEST(Policy, WithoutTaperThereIsNoDefectWithoutAirflow) {
  for (const double q : {0.0, -5.0, missing}) {
    const ChainResult s = fly(truth.model(), with(truth.recorded(), Quantity::dynamic_pressure, q));
    EXPECT_TRUE(std::isnan(s[Quantity::static_defect])) << q;
  }
}

TEST(Policy, MinimumRaisesDeltaP) {
  Model model = truth.model();
  model.policy.minimum = 1.113;
  EXPECT_NEAR(fly(model, truth.recorded())[Quantity::static_defect], truth.defect(), 1e-11);
  model.effects = {catalogued("static-constant", {0.001})};
  EXPECT_EQ(fly(model, truth.recorded())[Quantity::static_defect], 1.113);
}

TEST(Policy, DomainFlagsEachEndAndKeepsValues) {
  Model model = truth.model();
  const double q = truth.recorded()[Quantity::dynamic_pressure];
  for (const auto& [lower, upper, outside] :
       {std::tuple{q - 1, q + 1, false}, {q + 1, q + 2, true}, {q - 2, q - 1, true}, {q, q, false}}) {
    model.domain = {{"dynamic_pressure", lower, upper}};
    const ChainResult s = fly(model, truth.recorded());
    EXPECT_EQ(s.has(Quality::outside_domain), outside) << lower << ' ' << upper;
    EXPECT_NEAR(s[Quantity::static_defect], truth.defect(), 1e-11);
  }
}

// It is unknown whether the law holds there.
TEST(Policy, UnknownDomainQuantityIsNotInside) {
  Model model = truth.model();
  model.domain = {{"altitude", 0.0, 5000.0}};
  for (const auto& [altitude, outside] : {std::pair{3000.0, false}, {6000.0, true}, {missing, true}}) {
    const Recorded recorded = with(truth.recorded(), Quantity::altitude, altitude);
    const Chain chain = build_chain(model, recorded);
    const ChainResult s = fly(chain, recorded);
    EXPECT_EQ(s.has(Quality::outside_domain), outside) << altitude;
    EXPECT_EQ(chain.is_outside_domain(s.state), outside) << altitude;
    EXPECT_NEAR(s[Quantity::static_defect], truth.defect(), 1e-11);
  }
}

TEST(Air, HumidityIsNotAboveSaturation) {
  const ChainResult s = fly(truth.model(), with(truth.recorded(), Quantity::vapor_pressure, 8.0));
  EXPECT_TRUE(s.has(Quality::humidity_limited));
  const double saturation = pcor::vapor_pressure_over_water(s[Quantity::ambient_temperature]);
  // The limit was taken at the temperature of the unlimited air: 0.02 K, 0.15 % of e.
  EXPECT_NEAR(s[Quantity::humidity] * s[Quantity::corrected_static_pressure] / saturation, 1.0, 0.002);
  EXPECT_NEAR(saturation, pcor::vapor_pressure_over_water(truth.T), 0.02);
}

TEST(Air, SupersaturationOverIceIsNotLimited) {
  Truth cold;
  cold.T = 240;
  cold.e = 0.98 * pcor::vapor_pressure_over_water(cold.T);
  ASSERT_GT(cold.e, pcor::vapor_pressure_over_ice(cold.T));
  const ChainResult s = fly(cold.model(), cold.recorded());
  EXPECT_FALSE(s.has(Quality::humidity_limited));
  EXPECT_NEAR(s[Quantity::humidity] * cold.p, cold.e, 1e-12);
}

// A recovery factor by the logarithm of Mach number 0.
TEST(Air, MissingSolutionSetsTheBitOfTheTemperature) {
  Model model;
  model.effects = {catalogued("static-constant", {0.001})};
  model.recovery = {{0.988, 0.053, 0.090, 0.091}};
  model.policy.min_dynamic_pressure = 0.0;
  const ChainResult s = fly(model, {{Quantity::static_pressure, 500.0},
                                    {Quantity::dynamic_pressure, 0.5},
                                    {Quantity::recovery_temperature, 280.0}});
  ASSERT_EQ(s[Quantity::corrected_dynamic_pressure], 0.0);
  EXPECT_TRUE(std::isnan(s[Quantity::ambient_temperature]));
  EXPECT_TRUE(s.has(Quality::temperature_missing));
}

TEST(Air, NegativeHumidityIsDry) {
  const ChainResult s = fly(truth.model(), with(truth.recorded(), Quantity::vapor_pressure, -0.1));
  EXPECT_EQ(s[Quantity::humidity], 0.0);
  EXPECT_TRUE(s.has(Quality::humidity_limited));
}

TEST(Air, WithoutHumidityIsDry) {
  Truth dry;
  dry.e = 0;
  for (const Recorded& recorded : {with(dry.recorded(), Quantity::vapor_pressure, missing),
                                   without(dry.recorded(), Quantity::vapor_pressure)}) {
    const ChainResult s = fly(dry.model(), recorded);
    EXPECT_EQ(s[Quantity::humidity], 0.0);
    EXPECT_NEAR(s[Quantity::ambient_temperature], dry.T, 1e-10);
    EXPECT_NEAR(s[Quantity::corrected_airspeed], dry.v, 1e-10);
    EXPECT_TRUE(s.has(Quality::dry_air_assumed));
  }
}

TEST(Air, DryConstantsIgnoreTheVapour) {
  Model model = truth.model();
  model.moist = false;
  const ChainResult s = fly(model, truth.recorded());
  EXPECT_EQ(s[Quantity::humidity], 0.0);
  EXPECT_EQ(s.flags.bits(), 0U);
}

TEST(Air, VapourIsComputedFromTheDewPoint) {
  const double dew_point = 265;
  const Recorded recorded =
      with(without(truth.recorded(), Quantity::vapor_pressure), Quantity::dew_point, dew_point);
  const ChainResult s = fly(truth.model(), recorded);
  const double e = pcor::vapor_pressure_over_water(dew_point) * pcor::enhancement_factor(dew_point, truth.p);
  EXPECT_NEAR(s[Quantity::humidity] * truth.p, e, 1e-11);
  EXPECT_NEAR(e, 3.31, 0.02) << "the saturation over water at -8 deg C and 0.3 %";
}

TEST(Air, VapourIsComputedFromTheFrostPoint) {
  const double frost_point = 265;
  const Recorded recorded =
      with(without(truth.recorded(), Quantity::vapor_pressure), Quantity::frost_point, frost_point);
  const ChainResult s = fly(truth.model(), recorded);
  const double e =
      pcor::vapor_pressure_over_ice(frost_point) * pcor::enhancement_factor(frost_point, truth.p);
  EXPECT_NEAR(s[Quantity::humidity] * truth.p, e, 1e-11);
  EXPECT_NEAR(e, 3.06, 0.02) << "the saturation over ice at -8 deg C and 0.3 %";
}

TEST(Air, RecordedAmbientTemperatureIsUnchanged) {
  Recorded recorded =
      with(without(truth.recorded(), Quantity::recovery_temperature), Quantity::ambient_temperature, truth.T);
  Model model = truth.model();
  model.lams.approach = LamsApproach::with_temperature;
  const ChainResult s = fly(model, recorded);
  EXPECT_EQ(s.flags.bits(), 0U);
  EXPECT_EQ(s[Quantity::ambient_temperature], truth.T);
  EXPECT_NEAR(s[Quantity::corrected_airspeed], truth.v, 1e-10);
  EXPECT_NEAR(s[Quantity::lams_static_defect], truth.defect(), 1e-9);
}

TEST(Air, RecordedAmbientIsKeptWithThermometer) {
  // Temperature of a radiometer, 1 K above the thermometer: approach 3 always depends on it.
  Recorded recorded = with(truth.recorded(), Quantity::ambient_temperature, truth.T + 1);
  Model model = truth.model();
  model.lams.approach = LamsApproach::with_temperature;
  const Chain chain = build_chain(model, recorded);
  ChainResult s = fly(chain, recorded);
  EXPECT_EQ(s[Quantity::ambient_temperature], truth.T + 1);
  // 0.237 hPa/K in the table of sensitivities, at 268.6 K; it falls as 1/T^2.
  EXPECT_NEAR(s[Quantity::lams_static_defect] - truth.defect(), 0.237 * std::pow(268.6 / 270.5, 2), 0.001);
  EXPECT_EQ(chain.lams_static_defect(s.state, chain.parameters().data(), s.flags),
            s[Quantity::lams_static_defect]);
}

namespace {

// Air in which the thermometer, reduced to ambient, gives `uncalibrated`: with t in degC the truth is
// `uncalibrated` plus 0.55 K + 0.01 t - 0.0002 t^2.
struct Miscalibrated : Truth {
  double uncalibrated = 265;

  Miscalibrated() {
    const double t = uncalibrated - 273.15;
    T = uncalibrated + 0.55 + 0.01 * t - 0.0002 * t * t;
  }
  Model model() const { return with(Truth::model(), catalogued("temp-calibration", {0.55, 0.01, -0.0002})); }
  Recorded recorded() const {
    // The thermometer includes the dynamic heating of the true Mach number.
    const double heating = 0.5 * (air().heat_capacity_ratio - 1) * mach() * mach();
    return with(Truth::recorded(), Quantity::recovery_temperature, uncalibrated * (1 + recovery * heating));
  }
  Recorded recorded_ambient() const {
    return with(without(recorded(), Quantity::recovery_temperature), Quantity::ambient_temperature,
                uncalibrated);
  }
};

}  // namespace

TEST(Calibration, RecoversTheTrueTemperature) {
  const Miscalibrated air;
  ASSERT_GT(std::abs(air.T - air.uncalibrated), 0.4);
  for (const LamsApproach approach :
       {LamsApproach::simultaneous, LamsApproach::iterated, LamsApproach::with_temperature}) {
    Model model = air.model();
    model.lams.approach = approach;
    const bool from_ambient = approach == LamsApproach::with_temperature;
    const ChainResult s = fly(model, from_ambient ? air.recorded_ambient() : air.recorded());
    EXPECT_EQ(s.flags.bits(), 0U);
    EXPECT_NEAR(s[Quantity::ambient_temperature], air.T, 1e-10);
    EXPECT_NEAR(s[Quantity::corrected_airspeed], air.v, 1e-10);
    EXPECT_NEAR(s[Quantity::lams_temperature], air.T, 1e-9);
    // Approach 2 stops within 1e-7 hPa, and is a few digits more accurate.
    const double tolerance = approach == LamsApproach::iterated ? 1e-8 : 1e-9;
    EXPECT_NEAR(s[Quantity::lams_static_defect], air.defect(), tolerance);
  }
}

// A second solution, as where the humidity is limited, starts from the uncalibrated temperature again.
TEST(Calibration, IsAppliedOnce) {
  const Miscalibrated air;
  const Recorded wet = with(air.recorded(), Quantity::vapor_pressure, 20.0);
  const ChainResult plain = fly(air.Truth::model(), wet), s = fly(air.model(), wet);
  EXPECT_TRUE(s.has(Quality::humidity_limited));
  const double t = plain[Quantity::ambient_temperature] - 273.15;
  // Warmer air holds more vapour, which changes the Mach number by a few parts in 1e5: 1 mK.
  EXPECT_NEAR(s[Quantity::ambient_temperature] - plain[Quantity::ambient_temperature],
              0.55 + 0.01 * t - 0.0002 * t * t, 1e-3);
  const Recorded ambient = with(air.recorded_ambient(), Quantity::vapor_pressure, 20.0);
  Model model = air.model();
  model.lams.approach = LamsApproach::with_temperature;
  EXPECT_NEAR(fly(model, ambient)[Quantity::ambient_temperature], air.T, 1e-12);
}

// The vapour pressure lies between saturation at the thermometer's temperature and at the calibrated one.
TEST(Calibration, SaturationLimitUsesTheCalibratedTemperature) {
  const Miscalibrated air;
  const double e = pcor::vapor_pressure_over_water(air.uncalibrated + 0.2);
  ASSERT_LT(e, pcor::vapor_pressure_over_water(air.T));
  const Recorded humid = with(air.recorded(), Quantity::vapor_pressure, e);
  EXPECT_TRUE(fly(air.Truth::model(), humid).has(Quality::humidity_limited));
  EXPECT_FALSE(fly(air.model(), humid).has(Quality::humidity_limited));
}

TEST(Calibration, FormulaUsesTheUncalibratedTemperature) {
  const Miscalibrated air;
  const Model model = with(air.Truth::model(), written(EffectLocation::ambient_temperature,
                                                       "a + b * (ambient_temperature - 273.15) - 2e-4 * "
                                                       "(ambient_temperature - 273.15)^2",
                                                       {"a", "b"}, {0.55, 0.01}));
  EXPECT_NEAR(fly(model, air.recorded())[Quantity::ambient_temperature], air.T, 1e-10);
  EXPECT_NEAR(fly(model, air.recorded())[Quantity::lams_static_defect], air.defect(), 1e-9);
  // Elsewhere a derived ambient temperature is known only after delta-p.
  const Model early = with(air.Truth::model(),
                           written(EffectLocation::static_defect, "k * ambient_temperature", {"k"}, {0.0}));
  EXPECT_THAT(error_of(early, air.recorded()), HasSubstr("'ambient_temperature'"));
}

TEST(Calibration, MissingInputGivesAMissingTemperature) {
  const Miscalibrated air;
  const Model model =
      with(air.Truth::model(), written(EffectLocation::ambient_temperature, "k * altitude", {"k"}, {1e-4}));
  for (const Recorded& recorded : {air.recorded(), air.recorded_ambient()}) {
    Model variant = model;
    if (recorded.count(Quantity::ambient_temperature) > 0)
      variant.lams.approach = LamsApproach::with_temperature;
    EXPECT_EQ(fly(variant, with(recorded, Quantity::altitude, 3000)).flags.bits(), 0U);
    const ChainResult s = fly(variant, with(recorded, Quantity::altitude, missing));
    EXPECT_TRUE(s.has(Quality::effect_input_missing));
    EXPECT_TRUE(s.has(Quality::temperature_missing));
    EXPECT_TRUE(std::isnan(s[Quantity::ambient_temperature]));
    EXPECT_TRUE(std::isnan(s[Quantity::corrected_airspeed]));
    EXPECT_TRUE(std::isnan(s[Quantity::lams_static_defect]));
    EXPECT_FALSE(std::isnan(s[Quantity::corrected_static_pressure])) << "needs no temperature";
  }
}

TEST(Calibration, RequiresATemperature) {
  Recorded cold = without(without(truth.recorded(), Quantity::recovery_temperature), Quantity::lams_airspeed);
  EXPECT_THAT(error_of(with(truth.model(), catalogued("temp-calibration", {0.5, 0.0, 0.0})), cold),
              AllOf(HasSubstr("temp-calibration"), HasSubstr("'recovery_temperature'"),
                    HasSubstr("'ambient_temperature'")));
}

TEST(Air, MachNumberNeedsNoThermometer) {
  Recorded recorded = without(truth.recorded(), Quantity::lams_airspeed);
  recorded = without(recorded, Quantity::recovery_temperature);
  const ChainResult s = fly(truth.model(), recorded);
  EXPECT_NEAR(s[Quantity::corrected_mach], truth.mach(), 1e-12);
  EXPECT_TRUE(std::isnan(s[Quantity::corrected_airspeed]));
}

TEST(FlowAngles, UnrecordedAnglesComeFromTheRadome) {
  Model model = truth.model();
  model.attack_radome = {5.776, 15.031, 0.0};
  model.sideslip_radome = {-0.5, 20.0, 0.0};
  Recorded recorded = without(without(truth.recorded(), Quantity::attack), Quantity::sideslip);
  recorded[Quantity::radome_dynamic_pressure] = 66;
  recorded[Quantity::attack_differential_pressure] = 66 * (truth.alpha - 5.776) / 15.031;
  recorded[Quantity::sideslip_differential_pressure] = 66 * (truth.beta + 0.5) / 20.0;
  const ChainResult s = fly(model, recorded);
  EXPECT_NEAR(s[Quantity::attack], truth.alpha, 1e-13);
  EXPECT_NEAR(s[Quantity::sideslip], truth.beta, 1e-13);
  EXPECT_NEAR(s[Quantity::lams_static_defect], truth.defect(), 1e-9);
}

// A blocked port at the centre of the radome: 5.776 + 15.031 * 23.43 is 358 degrees.
TEST(FlowAngles, ImpossibleAngleOfTheRadomeIsMissing) {
  Model model = truth.model();
  model.attack_radome = {5.776, 15.031, 0.0};
  Recorded recorded = without(truth.recorded(), Quantity::attack);
  recorded[Quantity::radome_dynamic_pressure] = 1.0;
  recorded[Quantity::attack_differential_pressure] = 23.43;
  const ChainResult s = fly(model, recorded);
  EXPECT_TRUE(std::isnan(s[Quantity::attack]));
  EXPECT_TRUE(std::isnan(s[Quantity::lams_static_defect]));
  EXPECT_TRUE(s.has(Quality::lams_missing));
}

TEST(FlowAngles, GvAttackDependsOnTheMachNumber) {
  Model model = truth.model();
  model.attack_radome = {5.5156, 19.07, 2.08};
  Recorded recorded = without(truth.recorded(), Quantity::attack);
  recorded[Quantity::radome_dynamic_pressure] = 66;
  recorded[Quantity::attack_differential_pressure] = -9.9;
  const ChainResult s = fly(model, recorded);
  EXPECT_NEAR(s[Quantity::attack], 5.5156 - 0.15 * (19.07 + 2.08 * s[Quantity::mach]), 1e-13);
  EXPECT_NEAR(s[Quantity::mach], truth.mach(), 0.01);
}

TEST(FlowAngles, ARecordedAnglePrecedesTheRadome) {
  Model model = truth.model();
  model.attack_radome = {5.776, 15.031, 0.0};
  EXPECT_EQ(fly(model, truth.recorded())[Quantity::attack], truth.alpha);
}

TEST(Lams, WorksWithoutSideslip) {
  Truth straight;
  straight.beta = 0;
  const ChainResult s = fly(straight.model(), without(straight.recorded(), Quantity::sideslip));
  EXPECT_NEAR(s[Quantity::lams_static_defect], straight.defect(), 1e-9);
}

TEST(Lams, ApproachesAgree) {
  Model model = truth.model();
  model.recovery = {{0.988, 0.053, 0.090, 0.091}};
  const double one = fly(model, truth.recorded())[Quantity::lams_static_defect];
  model.lams.approach = LamsApproach::iterated;
  EXPECT_NEAR(fly(model, truth.recorded())[Quantity::lams_static_defect], one, 1e-6);
}

TEST(Lams, CorrectionReturnsAirspeedAndTemperature) {
  Recorded warm = truth.recorded();
  warm[Quantity::recovery_temperature] += 0.5;
  const Chain chain = build_chain(truth.model(), warm);
  ChainResult s = fly(chain, warm);
  chain.correct(s.state, s[Quantity::lams_static_defect], s.flags);
  chain.air(s.state, chain.parameters().data(), s.flags);
  chain.lams_air(s.state, chain.parameters().data(), s.flags);
  EXPECT_NEAR(s[Quantity::corrected_airspeed], truth.v, 1e-9);
  EXPECT_NEAR(s[Quantity::lams_temperature], s[Quantity::ambient_temperature], 5e-9);
}

// Effects before the static ports: each equals a change of its physical input.

TEST(Upstream, LamsElevationTiltsTheBeam) {
  const Model tilted = with(truth.model(), catalogued("lams-elevation", {0.5}));
  Model mounted = truth.model();
  mounted.lams.elevation += 0.5;
  const double changed = fly(tilted, truth.recorded())[Quantity::lams_static_defect];
  EXPECT_NEAR(changed, fly(mounted, truth.recorded())[Quantity::lams_static_defect], 1e-12);
  // The derivative -gamma M^2 p tan(theta_1 + alpha), half a degree; 10 % for its curvature and dT/dv.
  const double angle = 4.25 * pcor::constants::radians_per_degree;
  EXPECT_NEAR(changed - truth.defect(),
              -1.4 * truth.mach() * truth.mach() * truth.p * std::tan(angle) * 0.5 *
                  pcor::constants::radians_per_degree,
              0.01);
}

TEST(Upstream, RecoveryFactorHeatsTheThermometer) {
  const Model wrong = with(truth.model(), catalogued("recovery-factor", {0.01}));
  Model law = truth.model();
  law.recovery.coefficients[0] += 0.01;
  const ChainResult s = fly(wrong, truth.recorded()), expected = fly(law, truth.recorded());
  EXPECT_NEAR(s[Quantity::lams_static_defect], expected[Quantity::lams_static_defect], 1e-12);
  EXPECT_NEAR(s[Quantity::ambient_temperature], expected[Quantity::ambient_temperature], 1e-12);
  EXPECT_EQ(s[Quantity::corrected_static_pressure], expected[Quantity::corrected_static_pressure]);
  // 0.01 v^2/(2 c_p) = 0.0715 K at a fixed Mach number: less by 1 + a_r x, x = 0.0265. In the table of
  // sensitivities -0.017 hPa at 700 hPa and 120 m/s.
  EXPECT_NEAR(s[Quantity::ambient_temperature] - truth.T, -0.0697, 1e-4);
  EXPECT_NEAR(s[Quantity::lams_static_defect] - truth.defect(), -0.017, 0.0006);
}

TEST(Upstream, StaticLagMovesBothPressuresAtThePorts) {
  const Model lagging = with(truth.model(), catalogued("static-lag", {0.15}));
  const Recorded climb = with(truth.recorded(), Quantity::static_pressure_rate, -1.2);
  const ChainResult s = fly(lagging, climb), still = fly(truth.model(), climb);
  for (const auto& [after, sign] : {std::pair{Quantity::port_static_pressure, -1.0},
                                    {Quantity::port_dynamic_pressure, 1.0},
                                    {Quantity::corrected_static_pressure, -1.0},
                                    {Quantity::corrected_dynamic_pressure, 1.0}})
    EXPECT_NEAR(s[after] - still[after], sign * 0.18, 1e-12) << info_of(after).name;
  // Delta-p of the model is a function of recorded pressures, delta-p of LAMS of the pressures at the ports,
  // so LAMS loses all.
  EXPECT_EQ(s[Quantity::static_defect], still[Quantity::static_defect]);
  EXPECT_NEAR(s[Quantity::lams_static_defect] - still[Quantity::lams_static_defect], 0.18, 1e-9);
  EXPECT_TRUE(build_chain(lagging, truth.recorded()).derives(Quantity::static_pressure_rate));
}

// A record with the pressures of the radome in place of the angles, of which the ratios are -0.3 and 0.02.
Recorded radome_record() {
  Recorded recorded = without(without(truth.recorded(), Quantity::attack), Quantity::sideslip);
  recorded[Quantity::radome_dynamic_pressure] = 68;
  recorded[Quantity::attack_differential_pressure] = -0.3 * 68;
  recorded[Quantity::sideslip_differential_pressure] = 0.02 * 68;
  return recorded;
}

Model model_with_radome() {
  Model model = with(truth.model(), catalogued("static-alpha", {0.02}));
  model.attack_radome = {4.9, 13.4, 0};
  model.sideslip_radome = {0.1, 11.8, 0};
  return model;
}

TEST(Upstream, RadomeRatioMovesEffectsAndAttackAngle) {
  // Sensitivity 5 % high, zero 0.01 high, and 0.005 higher each hour: at two hours 0.95 (-0.3) - 0.02.
  const Model drifting = with(model_with_radome(), catalogued("adif-drift", {0.05, 0.01, 0.005}));
  const Recorded recorded = with(radome_record(), Quantity::time, 7200);
  const ChainResult s = fly(drifting, recorded), still = fly(model_with_radome(), recorded);
  EXPECT_NEAR(s[Quantity::attack_ratio], -0.305, 1e-12);
  EXPECT_NEAR(s[Quantity::attack] - still[Quantity::attack], 13.4 * -0.005, 1e-12);
  const double p = recorded.at(Quantity::static_pressure);
  EXPECT_NEAR(s[Quantity::static_defect] - still[Quantity::static_defect], 0.02 * -0.005 * p, 1e-12);
  for (const Quantity other : {Quantity::sideslip, Quantity::port_static_pressure,
                               Quantity::port_dynamic_pressure, Quantity::radome_dynamic_pressure})
    EXPECT_EQ(s[other], still[other]) << info_of(other).name;
}

TEST(Upstream, RadomePressureChangesBothRatios) {
  const Model with_loss = with(model_with_radome(), written(EffectLocation::radome, "k", {"k"}, {2}));
  const ChainResult s = fly(with_loss, radome_record()), still = fly(model_with_radome(), radome_record());
  EXPECT_NEAR(s[Quantity::radome_dynamic_pressure], 70, 1e-12);
  EXPECT_NEAR(s[Quantity::attack_ratio], -0.3 * 68 / 70, 1e-12);
  EXPECT_NEAR(s[Quantity::attack], 4.9 + 13.4 * -0.3 * 68 / 70, 1e-12);
  EXPECT_NEAR(s[Quantity::sideslip], 0.1 + 11.8 * 0.02 * 68 / 70, 1e-12);
  EXPECT_EQ(s[Quantity::port_dynamic_pressure], still[Quantity::port_dynamic_pressure]);
  EXPECT_EQ(s[Quantity::port_static_pressure], still[Quantity::port_static_pressure]);
}

TEST(Upstream, RadomeLossUsesTheUncorrectedAngles) {
  const Model model = with(model_with_radome(), catalogued("qcr-angle", {0.0273, 0.0562}));
  const ChainResult s = fly(model, radome_record()), still = fly(model_with_radome(), radome_record());
  const double alpha = still[Quantity::attack], beta = still[Quantity::sideslip];
  EXPECT_NEAR(s[Quantity::radome_dynamic_pressure], 68 + 0.0273 * alpha * alpha + 0.0562 * beta * beta,
              1e-12);
}

TEST(Upstream, RadomeRatioDoesNotChangeARecordedAngle) {
  const Recorded recorded = with(radome_record(), Quantity::attack, 2.5);
  const Model drifting = with(model_with_radome(), written(EffectLocation::attack_ratio, "k", {"k"}, {0.1}));
  EXPECT_EQ(fly(drifting, recorded)[Quantity::attack], 2.5);
  EXPECT_NEAR(fly(drifting, recorded)[Quantity::attack_ratio], -0.2, 1e-12);
}

TEST(Upstream, NeglectedVapourAddedBackGivesMoistAir) {
  // Within the rounding of the chain, for any recorded humidity; with supersaturated air at its limit.
  const Recorded dry = without(truth.recorded(), Quantity::vapor_pressure);
  for (const auto& [humidity, value] : {std::pair{Quantity::vapor_pressure, 3.0},
                                        {Quantity::vapor_pressure, 30.0},
                                        {Quantity::dew_point, 265.0},
                                        {Quantity::frost_point, 263.0}}) {
    const Recorded recorded = with(dry, humidity, value);
    const ChainResult moist = fly(truth.model(), recorded);
    Model model = truth.model();
    model.moist = false;
    const ChainResult without_vapor = fly(model, recorded);
    const ChainResult counted = fly(with(model, catalogued("humidity-neglected", {1.0})), recorded);
    const ChainResult neutral = fly(with(model, catalogued("humidity-neglected", {0.0})), recorded);
    EXPECT_EQ(without_vapor[Quantity::humidity], 0);
    for (const Quantity result : {Quantity::humidity, Quantity::corrected_mach, Quantity::ambient_temperature,
                                  Quantity::corrected_airspeed, Quantity::lams_static_defect}) {
      EXPECT_NEAR(counted[result] / moist[result], 1.0, 1e-12) << info_of(result).name;
      EXPECT_EQ(neutral[result], without_vapor[result]) << info_of(result).name;
    }
    EXPECT_EQ(counted.flags.bits(), moist.flags.bits());
    EXPECT_GT(std::abs(counted[Quantity::lams_static_defect] - without_vapor[Quantity::lams_static_defect]),
              0.01);
  }
}

TEST(Upstream, DryConstantsGiveALowDeltaP) {
  // -0.378 k1 q e/p with k1 = 0.912, q = 67.6 hPa: -0.033 hPa for 1 hPa of vapour, within 8 %: at one
  // recovery temperature the ambient one moves, too.
  Model model = truth.model();
  model.moist = false;
  const double dry = fly(model, truth.recorded())[Quantity::lams_static_defect];
  const double moist = fly(truth.model(), truth.recorded())[Quantity::lams_static_defect];
  const double q = truth.total() - truth.p;
  const double expected = -0.378 * truth.p / truth.total() * q * truth.e / truth.p;
  EXPECT_NEAR(dry - moist, expected, 0.08 * std::abs(expected));
}

TEST(Upstream, HumidityErrorIsCorrected) {
  const Recorded high = with(truth.recorded(), Quantity::vapor_pressure, truth.e / 0.9);
  const ChainResult s = fly(with(truth.model(), catalogued("humidity-error", {0.1})), high);
  EXPECT_NEAR(s[Quantity::humidity], truth.e / truth.p, 1e-14);
}

TEST(Upstream, FormulasCanUseVapourPressureFromDewPoint) {
  const Recorded recorded =
      with(without(truth.recorded(), Quantity::vapor_pressure), Quantity::dew_point, 265);
  const Model model =
      with(truth.model(), written(EffectLocation::static_defect, "k * vapor_pressure", {"k"}, {1.0}));
  const double p = recorded.at(Quantity::static_pressure);
  const double e = pcor::vapor_pressure_from_dew_point(265.0, p);
  EXPECT_NEAR(fly(model, recorded)[Quantity::static_defect] - 0.005 * p, e, 1e-12);
  EXPECT_THAT(error_of(model, without(recorded, Quantity::dew_point)), HasSubstr("'vapor_pressure'"));
}

TEST(Upstream, ClockSkewShiftsTheLaser) {
  const Model model = with(truth.model(), catalogued("clock-skew", {0.5}));
  Recorded recorded = truth.recorded();
  recorded[Quantity::airspeed_rate] = 0.4;
  const ChainResult s = fly(model, recorded);
  const Model shifted = with(
      truth.model(), written(EffectLocation::beam_speed, "k", {"k"}, {0.5 * s[Quantity::airspeed_rate]}));
  EXPECT_NEAR(s[Quantity::lams_static_defect], fly(shifted, recorded)[Quantity::lams_static_defect], 1e-12);
  const Recorded unknown = without(truth.recorded(), Quantity::recovery_temperature);
  EXPECT_THAT(error_of(model, unknown), HasSubstr("'recovery_temperature'"));
}

TEST(Upstream, EffectsOnTheBeamNeedNoInputWithoutALaser) {
  Model model;
  model.effects = {catalogued("lams-scale", {0.001}), catalogued("lams-pod-flex", {0.3}),
                   catalogued("static-constant", {0.005})};
  const Model with_formula = with(model, written(EffectLocation::beam_azimuth, "k * ROLLX", {"k"}, {0.1}));
  const Recorded recorded{{Quantity::static_pressure, 700}, {Quantity::dynamic_pressure, 67.6}};
  for (const Model& each : {model, with_formula}) {
    const Chain chain = build_chain(each, recorded);
    EXPECT_FALSE(chain.acts(EffectLocation::beam_speed));
    EXPECT_TRUE(chain.extra_names().empty());
    EXPECT_EQ(chain.parameters().size(), each.effects.size()) << "the coefficients keep their places";
    EXPECT_NEAR(fly(chain, recorded)[Quantity::static_defect], 3.5, 1e-12);
  }
}

TEST(Upstream, EffectsOnTheRadomeNeedItsPressures) {
  for (const EffectLocation location : {EffectLocation::radome, EffectLocation::attack_ratio}) {
    EXPECT_THAT(error_of(with(truth.model(), written(location, "k", {"k"}, {0.1})), truth.recorded()),
                AllOf(HasSubstr("of-the-user"), HasSubstr("_pressure'")));
  }
}

TEST(Formula, ActsAtEveryLocation) {
  const auto change = [](EffectLocation location, double amount, Quantity of) {
    const Model model = with(truth.model(), written(location, "k", {"k"}, {amount}));
    EXPECT_TRUE(build_chain(model, truth.recorded()).acts(location));
    return fly(model, truth.recorded())[of] - fly(truth.model(), truth.recorded())[of];
  };
  EXPECT_NEAR(change(EffectLocation::static_transducer, 0.3, Quantity::port_static_pressure), 0.3, 1e-12);
  EXPECT_NEAR(change(EffectLocation::static_transducer, 0.3, Quantity::port_dynamic_pressure), 0.0, 1e-12);
  EXPECT_NEAR(change(EffectLocation::dynamic_transducer, 0.3, Quantity::port_dynamic_pressure), 0.3, 1e-12);
  EXPECT_NEAR(change(EffectLocation::dynamic_transducer, 0.3, Quantity::port_static_pressure), 0.0, 1e-12);
  EXPECT_NEAR(change(EffectLocation::static_line, 0.3, Quantity::port_static_pressure), 0.3, 1e-12);
  EXPECT_NEAR(change(EffectLocation::static_line, 0.3, Quantity::port_dynamic_pressure), -0.3, 1e-12);
  EXPECT_NEAR(change(EffectLocation::total_line, 0.3, Quantity::port_dynamic_pressure), 0.3, 1e-12);
  EXPECT_NEAR(change(EffectLocation::total_line, 0.3, Quantity::port_static_pressure), 0.0, 1e-12);
  EXPECT_NEAR(change(EffectLocation::pitot, 0.3, Quantity::port_dynamic_pressure), 0.3, 1e-12);
  EXPECT_NEAR(change(EffectLocation::pitot, 0.3, Quantity::port_static_pressure), 0.0, 1e-12);
  EXPECT_NEAR(change(EffectLocation::attack, 0.3, Quantity::attack), 0.3, 1e-12);
  EXPECT_NEAR(change(EffectLocation::sideslip, 0.3, Quantity::sideslip), 0.3, 1e-12);
  EXPECT_NEAR(change(EffectLocation::static_defect, 0.3, Quantity::static_defect), 0.3, 1e-12);
  EXPECT_NEAR(change(EffectLocation::humidity, 0.7, Quantity::humidity), 0.7 / truth.p, 1e-12);
  // Warmer by 1 K at the thermometer is warmer by 1/(1 + a_r x) outside, x = 0.026.
  EXPECT_NEAR(change(EffectLocation::temperature, 1.0, Quantity::ambient_temperature),
              1 / (1 + 0.975 * 0.0265), 1e-3);
  EXPECT_NEAR(change(EffectLocation::recovery, 0.01, Quantity::ambient_temperature), -0.0697, 1e-4);
  EXPECT_NEAR(change(EffectLocation::ambient_temperature, 0.3, Quantity::ambient_temperature), 0.3, 1e-12);
  // 0.237 hPa/K at 268.6 K, falling as 1/T^2, as in the table of sensitivities. In warmer air the laser's
  // airspeed is a lower Mach number, the thermometer heats up less, and so the air is warmer by a_r x again.
  EXPECT_NEAR(change(EffectLocation::ambient_temperature, 0.3, Quantity::lams_static_defect),
              0.3 * (1 + 0.975 * 0.0265) * 0.237 * std::pow(268.6 / 270.15, 2), 0.0003);
  // 1 m/s of the laser is -1.09 hPa at 700 hPa and 120 m/s, and so are d cos/cos of the two angles.
  EXPECT_NEAR(change(EffectLocation::beam_speed, 0.1, Quantity::lams_static_defect), -0.109, 0.001);
  EXPECT_NEAR(change(EffectLocation::beam_elevation, 0.5, Quantity::lams_static_defect),
              change(EffectLocation::attack, 0.5, Quantity::lams_static_defect), 1e-12);
  EXPECT_NEAR(change(EffectLocation::beam_azimuth, 0.5, Quantity::lams_static_defect),
              change(EffectLocation::sideslip, -0.5, Quantity::lams_static_defect), 1e-12);
}

TEST(Formula, ReadsFileVariablesAndRoles) {
  Model model = truth.model();
  model.effects.push_back(written(EffectLocation::static_defect,
                                  "k * ENGTRQ / 100 + c * static_pressure * FLAP2", {"k", "c"},
                                  {2.0, 0.001}));
  model.effects.push_back(written(EffectLocation::static_defect, "m * ENGTRQ", {"m"}, {0.5}));
  const Recorded recorded = truth.recorded();
  const Chain chain = build_chain(model, recorded);
  EXPECT_THAT(chain.extra_names(), ElementsAre("ENGTRQ", "FLAP2"));
  Recorded more = recorded;
  more[pcor::extra_quantity(0)] = 30;
  more[pcor::extra_quantity(1)] = 1;
  const double p = recorded.at(Quantity::static_pressure);
  EXPECT_NEAR(fly(chain, more)[Quantity::static_defect], 0.005 * p + 2 * 0.3 + 0.001 * p + 15, 1e-12);
  // Without one of them there is no delta-p.
  const ChainResult s = fly(chain, recorded);
  EXPECT_TRUE(std::isnan(s[Quantity::static_defect]));
  EXPECT_TRUE(s.has(Quality::effect_input_missing));
}

// Quality bits: each is set under its documented condition, and only then.

namespace {

// The truth with everything that a bit can be about.
Model full_model() {
  Model model = truth.model();
  model.attack_radome = {5.776, 15.031, 0.0};
  model.effects.push_back(catalogued("static-alpha", {0.0}));
  model.effects.push_back(catalogued("static-lag", {0.0}));
  model.policy.taper_below = 40;
  model.policy.minimum = 0.0;
  model.domain = {{"dynamic_pressure", 20.0, 100.0}};
  return model;
}

Recorded full_record() {
  Recorded recorded = truth.recorded();
  recorded[Quantity::radome_dynamic_pressure] = 66;
  recorded[Quantity::attack_differential_pressure] = -20;
  recorded[Quantity::static_pressure_rate] = 0.1;
  return recorded;
}

}  // namespace

TEST(QualityBits, GoodSampleSetsNoBit) { EXPECT_EQ(fly(full_model(), full_record()).flags.bits(), 0U); }

TEST(QualityBits, EachCauseSetsItsBitAndRemovesResults) {
  struct Case {
    Quality bit;
    Quantity changed;
    double to;
    std::vector<Quantity> gone;
  };
  const std::vector<Quantity> everything{Quantity::corrected_static_pressure,
                                         Quantity::corrected_dynamic_pressure,
                                         Quantity::corrected_mach,
                                         Quantity::ambient_temperature,
                                         Quantity::corrected_airspeed,
                                         Quantity::lams_static_defect};
  const std::vector<Quantity> speeds{Quantity::corrected_mach, Quantity::corrected_airspeed,
                                     Quantity::lams_static_defect};
  const std::vector<Quantity> corrected{Quantity::corrected_static_pressure, Quantity::corrected_airspeed};
  for (const auto& [bit, changed, to, gone] : std::vector<Case>{
           {Quality::static_pressure_missing, Quantity::static_pressure, missing, everything},
           {Quality::dynamic_pressure_missing, Quantity::dynamic_pressure, missing, everything},
           {Quality::impossible_static_pressure, Quantity::static_pressure, 0.0, everything},
           {Quality::impossible_static_pressure, Quantity::static_pressure, -1.0, everything},
           {Quality::impossible_dynamic_pressure,
            Quantity::dynamic_pressure,
            0.0,
            {Quantity::lams_static_defect}},
           {Quality::impossible_dynamic_pressure, Quantity::dynamic_pressure, -0.5, speeds},
           {Quality::effect_input_missing, Quantity::attack_differential_pressure, missing, corrected},
           {Quality::effect_input_missing, Quantity::static_pressure_rate, missing, everything},
           {Quality::impossible_radome_pressure, Quantity::radome_dynamic_pressure, 0.0, corrected},
           {Quality::impossible_radome_pressure, Quantity::radome_dynamic_pressure, -2.0, corrected},
           {Quality::temperature_missing,
            Quantity::recovery_temperature,
            missing,
            {Quantity::ambient_temperature, Quantity::corrected_airspeed, Quantity::lams_static_defect}},
           {Quality::dry_air_assumed, Quantity::vapor_pressure, missing, {}},
           {Quality::humidity_limited, Quantity::vapor_pressure, 9.0, {}},
           {Quality::humidity_limited, Quantity::vapor_pressure, -0.1, {}},
           {Quality::lams_missing, Quantity::lams_airspeed, missing, {Quantity::lams_static_defect}},
           {Quality::lams_missing, Quantity::lams_airspeed, -1.0, {Quantity::lams_static_defect}},
           {Quality::lams_missing, Quantity::attack, missing, {Quantity::lams_static_defect}},
           {Quality::tapered, Quantity::dynamic_pressure, 30.0, {}},
           {Quality::outside_domain, Quantity::dynamic_pressure, 10.0, {}},
           {Quality::outside_domain, Quantity::dynamic_pressure, 130.0, {}}}) {
    const ChainResult s = fly(full_model(), with(full_record(), changed, to));
    SCOPED_TRACE(std::string(info_of(changed).name) + " = " + std::to_string(to));
    EXPECT_TRUE(s.has(bit));
    for (const Quantity quantity : gone) EXPECT_TRUE(std::isnan(s[quantity])) << info_of(quantity).name;
  }
  Model negative = full_model();
  negative.effects[0].parameters = {-0.001};
  EXPECT_TRUE(fly(negative, full_record()).has(Quality::minimum_applied));
}

TEST(QualityBits, OtherCausesDoNotSetABit) {
  const Quality never[] = {Quality::after_gap, Quality::corrected_with_lams};  // the loop's own
  for (const double q : {missing, -1.0, 0.0, 10.0, 66.0, 200.0}) {
    const ChainResult s = fly(full_model(), with(full_record(), Quantity::dynamic_pressure, q));
    for (const Quality bit : never) EXPECT_FALSE(s.has(bit)) << q;
    EXPECT_FALSE(s.has(Quality::static_pressure_missing)) << q;
    EXPECT_FALSE(s.has(Quality::impossible_static_pressure)) << q;
    EXPECT_FALSE(s.has(Quality::effect_input_missing)) << q;
    EXPECT_FALSE(s.has(Quality::impossible_radome_pressure)) << q;
    EXPECT_FALSE(s.has(Quality::temperature_missing)) << q;
    EXPECT_FALSE(s.has(Quality::dry_air_assumed)) << q;
  }
  EXPECT_FALSE(fly(full_model(), with(full_record(), Quantity::static_pressure, missing))
                   .has(Quality::effect_input_missing))
      << "the pressure is at fault, not an input";
}

TEST(QualityBits, DefectAboveDynamicPressureSetsABit) {
  Model model = truth.model();
  model.effects = {catalogued("static-constant", {0.02})};
  const ChainResult s = fly(model, with(truth.recorded(), Quantity::dynamic_pressure, 10.0));
  EXPECT_TRUE(s.has(Quality::defect_exceeds_dynamic_pressure));
  EXPECT_FALSE(s.has(Quality::impossible_dynamic_pressure)) << "the dynamic pressure itself is in order";
  EXPECT_TRUE(std::isnan(s[Quantity::static_defect]));
  EXPECT_TRUE(std::isnan(s[Quantity::corrected_static_pressure]));
  EXPECT_TRUE(std::isnan(s[Quantity::corrected_dynamic_pressure]));
  EXPECT_TRUE(std::isnan(s[Quantity::corrected_airspeed]));
}

TEST(QualityBits, DefectBelowNegativeDynamicPressureSetsABit) {
  Model model = truth.model();
  const Recorded slow = with(truth.recorded(), Quantity::dynamic_pressure, 10.0);
  const double p = slow.at(Quantity::static_pressure);
  model.effects = {catalogued("static-constant", {-9.99 / p})};
  EXPECT_NEAR(fly(model, slow)[Quantity::static_defect], -9.99, 1e-12);
  model.effects = {catalogued("static-constant", {-10.01 / p})};
  const ChainResult s = fly(model, slow);
  EXPECT_TRUE(s.has(Quality::defect_exceeds_dynamic_pressure));
  for (const Quantity gone : {Quantity::static_defect, Quantity::corrected_static_pressure,
                              Quantity::corrected_dynamic_pressure, Quantity::corrected_airspeed})
    EXPECT_TRUE(std::isnan(s[gone])) << pcor::info_of(gone).name;
}

// In flight, from 20 hPa, six tenths of the dynamic pressure are more than any static defect.
TEST(QualityBits, ImplausibleDefectInFlightIsOutsideTheDomain) {
  const double p = truth.recorded().at(Quantity::static_pressure);
  for (const auto& [q, part, is_implausible] : {std::tuple{20.0, 0.59, false},
                                                {20.0, 0.61, true},
                                                {67.0, 0.59, false},
                                                {67.0, 0.61, true},
                                                {19.9, 0.99, false}}) {
    for (const double sign : {1.0, -1.0}) {
      Model model = truth.model();
      model.effects = {catalogued("static-constant", {sign * part * q / p})};
      const ChainResult s = fly(model, with(truth.recorded(), Quantity::dynamic_pressure, q));
      EXPECT_EQ(s.has(Quality::outside_domain), is_implausible) << q << ' ' << sign * part;
      EXPECT_NEAR(s[Quantity::static_defect], sign * part * q, 1e-12) << "the value is kept";
    }
  }
}

TEST(QualityBits, LaserDefectAboveDynamicPressureIsRejected) {
  // Half the airspeed requires three quarters of the dynamic pressure; 1.6 times the airspeed requires more
  // than all of it.
  const double beam = truth.recorded()[Quantity::lams_airspeed];
  EXPECT_FALSE(std::isnan(fly(truth.model(), with(truth.recorded(), Quantity::lams_airspeed,
                                                  0.5 * beam))[Quantity::lams_static_defect]));
  const ChainResult s = fly(truth.model(), with(truth.recorded(), Quantity::lams_airspeed, 1.6 * beam));
  EXPECT_TRUE(std::isnan(s[Quantity::lams_static_defect]));
  EXPECT_TRUE(s.has(Quality::lams_missing));
}

// Half an hour on the ramp at 25 Hz: all dynamic pressures are noise of 0.2 hPa, and so the angles of the
// radome are anything, in laws with and without a taper and a minimum.
TEST(Ramp, NoiseGivesNoAirspeedAndNoWrongPressure) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> noise(0.0, 0.2);
  for (const bool tapers : {false, true}) {
    for (const bool has_minimum : {false, true}) {
      Model model = truth.model();
      model.effects = {catalogued("static-constant", {0.004127875}),
                       catalogued("static-alpha", {0.021279816}), catalogued("static-qp", {0.030849643})};
      if (tapers) model.policy.taper_below = 40.0;
      if (has_minimum) model.policy.minimum = 1.113;
      Recorded recorded = with(without(truth.recorded(), Quantity::lams_airspeed),
                               Quantity::attack_differential_pressure, 0.0);
      recorded[Quantity::radome_dynamic_pressure] = 0.0;
      const Chain chain = build_chain(model, recorded);
      for (int i = 0; i < 45000; ++i) {
        for (const Quantity pressure : {Quantity::dynamic_pressure, Quantity::radome_dynamic_pressure,
                                        Quantity::attack_differential_pressure})
          recorded[pressure] = noise(engine);
        const ChainResult s = fly(chain, recorded);
        ASSERT_TRUE(s.has(Quality::no_airflow));
        ASSERT_TRUE(std::isnan(s[Quantity::corrected_airspeed]));
        ASSERT_TRUE(std::isnan(s[Quantity::corrected_mach]));
        const double p = s[Quantity::corrected_static_pressure];
        // Under a taper delta-p of the law is its (q/40 hPa)^3, 1e-5 of it at most for this noise.
        ASSERT_TRUE(std::isnan(p) || std::abs(p - recorded[Quantity::static_pressure]) < 0.2) << p;
      }
    }
  }
}

TEST(Ramp, AirspeedNeedsAMinimumDynamicPressure) {
  Model model = truth.model();
  model.effects = {};
  const auto at = [&](double q) { return fly(model, with(truth.recorded(), Quantity::dynamic_pressure, q)); };
  EXPECT_TRUE(std::isnan(at(1.99)[Quantity::corrected_airspeed]));
  EXPECT_FALSE(at(2.01).has(Quality::no_airflow));
  // v = (2 q/rho)^(1/2), rho = p/(R T): 2 q/p R T; compressible flow and moist air are 1e-3 of it.
  const double p = truth.recorded()[Quantity::static_pressure];
  const ChainResult s = at(2.01);
  EXPECT_NEAR(s[Quantity::corrected_airspeed],
              std::sqrt(2 * 2.01 / p * 287.05 * s[Quantity::ambient_temperature]), 0.03);
  model.policy.min_dynamic_pressure = 0.0;
  EXPECT_FALSE(std::isnan(at(0.1)[Quantity::corrected_airspeed]));
}

// A taper has a delta-p below the minimum dynamic pressure; the corrected one decides on the airspeed.
TEST(Ramp, CorrectedPressureDecidesOnTheAirflowUnderATaper) {
  Model model = truth.model();
  model.policy.taper_below = 2.0;
  model.policy.taper_power = 1.0;
  const Recorded recorded = with(truth.recorded(), Quantity::dynamic_pressure, 1.9);
  for (const auto& [a0, flows] : {std::pair{-0.0005, true}, {0.0, false}}) {
    model.effects = {catalogued("static-constant", {a0})};
    const ChainResult s = fly(model, recorded);
    EXPECT_EQ(s.has(Quality::no_airflow), !flows) << a0;
    EXPECT_EQ(std::isnan(s[Quantity::corrected_airspeed]), !flows) << a0;
  }
}

// Models that Chain::build refuses, and its messages.

TEST(Build, RequiresBothPressures) {
  EXPECT_EQ(
      error_of({}, {{Quantity::dynamic_pressure, 0}}),
      "the chain needs the role 'static_pressure', which is not among the recorded quantities; add it, in a "
      "model file as a variable in [variables]");
  EXPECT_EQ(
      error_of({}, {{Quantity::static_pressure, 0}}),
      "the chain needs the role 'dynamic_pressure', which is not among the recorded quantities; add it, in a "
      "model file as a variable in [variables]");
}

TEST(Build, UnknownEffectIsRefused) {
  EXPECT_EQ(error_of(with(truth.model(), catalogued("static-beauty", {1})), truth.recorded()),
            "there is no effect 'static-beauty' in the catalogue; correct the id, or give a formula");
  EXPECT_EQ(error_of(with(truth.model(), catalogued("static-qp", {1, 2})), truth.recorded()),
            "effect 'static-qp' takes 1 parameter(s), not 2");
}

TEST(Build, MissingEffectInputIsRefused) {
  EXPECT_EQ(error_of(with(truth.model(), catalogued("static-alpha", {1})), truth.recorded()),
            "effect 'static-alpha' needs the role 'attack_differential_pressure', which is not among the "
            "recorded quantities; add it, in a "
            "model file as a variable in [variables]");
  const Recorded no_attack = without(without(truth.recorded(), Quantity::lams_airspeed), Quantity::attack);
  EXPECT_EQ(error_of(with(truth.model(), catalogued("static-attack", {1})), no_attack),
            "effect 'static-attack' needs the role 'attack', which is not among the recorded quantities; add "
            "it, in a "
            "model file as a variable in [variables], or give [radome] attack = [offset, slope] to derive it "
            "from the radome pressures");
  Model radome = with(truth.model(), catalogued("static-attack", {1}));
  radome.attack_radome = {5.776, 15.031, 0.0};
  EXPECT_THAT(error_of(radome, no_attack), HasSubstr("'attack_differential_pressure'"));
}

TEST(Build, InvalidFormulaIsRefused) {
  EXPECT_THAT(error_of(with(truth.model(), written(EffectLocation::static_defect, "k *", {"k"}, {1})),
                       truth.recorded()),
              AllOf(HasSubstr("formula of effect 'of-the-user': "), HasSubstr("column 4")));
  EXPECT_EQ(error_of(with(truth.model(), written(EffectLocation::static_defect, "k", {"k"}, {1, 2})),
                     truth.recorded()),
            "effect 'of-the-user' takes 1 parameter(s), not 2");
  EXPECT_EQ(error_of(with(truth.model(), written(EffectLocation::static_defect, "flaps")), truth.recorded()),
            "the formula of effect 'of-the-user' needs the role 'flaps', which is not among the recorded "
            "quantities; add it, in a "
            "model file as a variable in [variables]");
  EXPECT_EQ(error_of(with(truth.model(), written(EffectLocation::static_defect, "corrected_mach")),
                     truth.recorded()),
            "the formula of effect 'of-the-user' needs 'corrected_mach', which is known only after delta-p; "
            "use 'mach', of the measured pressures");
}

TEST(Build, TooManyFormulaVariablesAreRefused) {
  const auto formula_of = [](int count, int first = 0) {
    std::string text = "0";
    for (int i = 0; i < count; ++i) text += " + V" + std::to_string(first + i);
    return written(EffectLocation::static_defect, text);
  };
  EXPECT_EQ(error_of(with(truth.model(), formula_of(12)), truth.recorded()), "no error");
  EXPECT_EQ(error_of(with(truth.model(), formula_of(13)), truth.recorded()),
            "formula of effect 'of-the-user' uses more than 12 variables");
  Model many = with(with(truth.model(), formula_of(12)), formula_of(12, 12));
  EXPECT_EQ(error_of(many, truth.recorded()), "no error");
  EXPECT_EQ(error_of(with(many, formula_of(1, 24)), truth.recorded()),
            "the formulas of the model use more than 24 further variables");
}

TEST(Build, UnknownDomainQuantityIsRefused) {
  Model model = truth.model();
  model.domain = {{"speed", 0, 1}};
  EXPECT_EQ(error_of(model, truth.recorded()),
            "the domain of the model: there is no quantity 'speed'; correct the name");
  model.domain = {{"flaps", 0, 1}};
  EXPECT_EQ(error_of(model, truth.recorded()),
            "the domain of the model needs the role 'flaps', which is not among the recorded quantities; add "
            "it, in a "
            "model file as a variable in [variables]");
  model.domain = {{"corrected_mach", 0, 1}};
  EXPECT_THAT(error_of(model, truth.recorded()), HasSubstr("known only after delta-p"));
}

TEST(Build, MissingLamsInputIsRefused) {
  EXPECT_THAT(error_of(truth.model(), without(truth.recorded(), Quantity::attack)),
              HasSubstr("LAMS, for the angle between its beam and the wind, needs the role 'attack'"));
  EXPECT_EQ(
      error_of(truth.model(), without(truth.recorded(), Quantity::recovery_temperature)),
      "LAMS needs the role 'recovery_temperature', which is not among the recorded quantities; add it, in a "
      "model file as a variable in [variables]");
  Model model = truth.model();
  model.lams.approach = LamsApproach::with_temperature;
  EXPECT_EQ(
      error_of(model, truth.recorded()),
      "LAMS needs the role 'ambient_temperature', which is not among the recorded quantities; add it, in a "
      "model file as a variable in [variables]");
  model = truth.model();
  model.sideslip_radome = {0.0, 20.0, 0.0};
  EXPECT_THAT(error_of(model, without(truth.recorded(), Quantity::sideslip)),
              HasSubstr("LAMS needs the role 'sideslip_differential_pressure'"));
}

TEST(Build, ErrorListsMissingRoles) {
  const auto error_of = [](const Model& model) {
    BindingError error;
    EXPECT_FALSE(Chain::build(model, roles_of(Truth().recorded()), &error).has_value());
    return error;
  };
  BindingError error = error_of(with({}, catalogued("qcr-angle", {0.0})));
  EXPECT_EQ(error.code, BindingError::Code::parameter_count);
  error = error_of(with({}, catalogued("flaps-gear", {0.0})));
  EXPECT_EQ(error.code, BindingError::Code::role_missing);
  EXPECT_EQ(error.quantity, Quantity::flaps);
  EXPECT_EQ(error.who, "effect 'flaps-gear'");
  EXPECT_EQ(error.message(), error.who + " " + error.what);
  error = error_of(with({}, written(EffectLocation::static_defect, "corrected_mach")));
  EXPECT_EQ(error.code, BindingError::Code::circular_dependency);
  EXPECT_EQ(error.quantity, Quantity::corrected_mach);
}

TEST(Build, WorksWithoutAnErrorString) { EXPECT_FALSE(Chain::build({}, {}, nullptr).has_value()); }

TEST(Chain, ThreadsCanShareIt) {
  // It stores no state of a sample, so that loops of several rates and threads of a batch share one.
  const Chain chain = build_chain(full_model(), full_record());
  const ChainResult alone = fly(chain, full_record());
  std::vector<double> found(4);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < found.size(); ++i) {
    threads.emplace_back([&, i] {
      for (int n = 0; n < 200; ++n)
        fly(chain, with(full_record(), Quantity::static_pressure, 500.0 + n + static_cast<double>(i)));
      found[i] = fly(chain, full_record())[Quantity::corrected_airspeed];
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const double airspeed : found) EXPECT_EQ(airspeed, alone[Quantity::corrected_airspeed]);
}

TEST(Chain, CompilesForAnotherScalarType) {
  using archetype::Formulas;
  for (const LamsApproach approach : {LamsApproach::simultaneous, LamsApproach::iterated}) {
    Model model = full_model();
    model.lams.approach = approach;
    model.recovery = {{0.988, 0.053, 0.090, 0.091}};
    model.effects.push_back(catalogued("temp-calibration", {0.3, 0.01, 0.0001}));
    for (const EffectLocation location : {EffectLocation::static_transducer, EffectLocation::attack,
                                          EffectLocation::temperature, EffectLocation::pitot})
      model.effects.push_back(
          written(location, "k * if(attack > 0, sqrt(abs(attack)), tanh(attack))", {"k"}, {0.01}));
    const Chain chain = build_chain(model, full_record());
    const ChainResult expected = fly(chain, full_record());

    State<Formulas> state;
    for (const auto& [quantity, value] : full_record()) state[quantity] = Formulas(value);
    const std::vector<Formulas> parameters(chain.parameters().begin(), chain.parameters().end());
    pcor::NoQualityFlags none;
    chain.correct_inputs(state, parameters.data(), none);
    state[Quantity::static_defect] = chain.static_defect(state, parameters.data(), none);
    state[Quantity::lams_static_defect] = chain.lams_static_defect(state, parameters.data(), none);
    chain.correct(state, state[Quantity::static_defect], none);
    chain.air(state, parameters.data(), none);
    chain.lams_air(state, parameters.data(), none);
    // A power by exp and log instead of pow: 1e-15 of a pressure ratio, amplified by p/q.
    for (const Quantity quantity :
         {Quantity::static_defect, Quantity::lams_static_defect, Quantity::corrected_static_pressure,
          Quantity::humidity, Quantity::corrected_mach, Quantity::ambient_temperature,
          Quantity::corrected_airspeed, Quantity::lams_temperature, Quantity::lams_dynamic_pressure})
      EXPECT_NEAR(state[quantity].value(), expected[quantity], 1e-9) << info_of(quantity).name;
  }
}

// Sum at a location, and the contribution of a single effect.

TEST(Additions, EqualAConstantEffectAtTheSameLocation) {
  // At every location: the chain with a formula of constant value is the chain with that amount added.
  Model model = Truth().model();
  const Recorded recorded = full_record();
  for (std::size_t i = 0; i < pcor::location_count; ++i) {
    const auto location = static_cast<EffectLocation>(i);
    SCOPED_TRACE(info_of(location).name);
    const ChainResult by_effect = fly(with(model, written(location, "k", {"k"}, {0.01})), recorded);
    model.additions = {location};
    Chain chain = build_chain(model, recorded);
    ASSERT_EQ(chain.parameters().back(), 0.0);
    std::vector<double> parameters = chain.parameters();
    parameters.back() = 0.01;
    ChainResult added;
    for (const auto& [quantity, value] : recorded) added.state[quantity] = value;
    chain.correct_inputs(added.state, parameters.data(), added.flags);
    added.state[Quantity::static_defect] = chain.static_defect(added.state, parameters.data(), added.flags);
    EXPECT_EQ(chain.lams_static_defect(added.state, parameters.data(), added.flags),
              by_effect[Quantity::lams_static_defect]);
    chain.correct(added.state, added[Quantity::static_defect], added.flags);
    chain.air(added.state, parameters.data(), added.flags);
    for (const Quantity each : {Quantity::corrected_static_pressure, Quantity::ambient_temperature,
                                Quantity::corrected_airspeed, Quantity::attack})
      EXPECT_EQ(added[each], by_effect[each]);
    model.additions.clear();
  }
}

TEST(Additions, AddToTheMinimumOfThePolicy) {
  Model model = Truth().model();
  model.policy.minimum = 7.0;  // hPa, more than the law gives
  model.additions = {EffectLocation::static_defect};
  const Recorded recorded = full_record();
  const Chain chain = build_chain(model, recorded);
  std::vector<double> parameters = chain.parameters();
  parameters.back() = 0.25;
  ChainResult added;
  for (const auto& [quantity, value] : recorded) added.state[quantity] = value;
  chain.correct_inputs(added.state, parameters.data(), added.flags);
  EXPECT_EQ(chain.static_defect(added.state, parameters.data(), added.flags), 7.25);
  EXPECT_TRUE(added.flags.has(Quality::minimum_applied));
}

TEST(Additions, UnusedLocationsNeedAndChangeNoData) {
  // A model whose angle of attack is recorded reads no radome; one without a laser has no beam.
  const Recorded recorded = without(Truth().recorded(), Quantity::lams_airspeed);
  Model model = with({}, catalogued("static-attack", {0.001}));
  const ChainResult before = fly(model, recorded);
  model.additions = {EffectLocation::radome, EffectLocation::attack_ratio, EffectLocation::beam_speed,
                     EffectLocation::beam_azimuth};
  const Chain chain = build_chain(model, recorded);
  for (const Quantity input : {Quantity::radome_dynamic_pressure, Quantity::attack_ratio})
    EXPECT_FALSE(chain.needs(input));
  EXPECT_EQ(fly(chain, recorded)[Quantity::corrected_static_pressure],
            before[Quantity::corrected_static_pressure]);
}

TEST(EffectValue, EffectValuesSumToTheDefect) {
  const Recorded recorded = Truth().recorded();
  Model model = with({}, catalogued("static-qp", {0.03}));
  model = with(model, written(EffectLocation::static_defect, "k * static_pressure", {"k"}, {0.004}));
  const Chain chain = build_chain(model, recorded);
  const ChainResult sample = fly(chain, recorded);
  const double by_hand = chain.effect_value(0, sample.state, chain.parameters().data()) +
                         chain.effect_value(1, sample.state, chain.parameters().data() + 1);
  EXPECT_DOUBLE_EQ(sample[Quantity::static_defect], by_hand);
  EXPECT_DOUBLE_EQ(chain.effect_value(0, sample.state, std::vector{0.03}.data()),
                   0.03 * recorded.at(Quantity::dynamic_pressure));
}

TEST(EffectValue, IsZeroWithoutABeam) {
  const Recorded recorded = without(Truth().recorded(), Quantity::lams_airspeed);
  const Chain chain = build_chain(with({}, catalogued("lams-scale", {0.01})), recorded);
  EXPECT_EQ(chain.effect_value(0, fly(chain, recorded).state, chain.parameters().data()), 0.0);
}

TEST(WithEffect, EqualsTheChainWithTheAddedEffect) {
  const Recorded recorded = with(full_record(), Quantity::roll, 20.0);
  const Chain shorter = build_chain(Truth().model(), recorded);
  for (const ModelEffect& effect : {catalogued("static-lag", {0.2}), catalogued("psfd-bias", {0.3}),
                                    written(EffectLocation::total_line, "k * roll / 90", {"k"}, {0.5})}) {
    const auto longer = shorter.with_effect(effect, nullptr);
    ASSERT_TRUE(longer.has_value());
    EXPECT_EQ(fly(*longer, recorded)[Quantity::corrected_static_pressure],
              fly(with(Truth().model(), effect), recorded)[Quantity::corrected_static_pressure]);
  }
  BindingError error;
  EXPECT_FALSE(shorter.with_effect(catalogued("static-bend", {}), &error).has_value());
  EXPECT_EQ(error.code, BindingError::Code::unknown_effect);
}
