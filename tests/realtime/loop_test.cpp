#include <pcor/realtime/loop.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <random>
#include <sstream>
#include <stdexcept>

#include "realtime/sample.hpp"
#include "support/constants.hpp"

namespace {

using pcor::CorrectWith;
using pcor::EffectLocation;
using pcor::Functor;
using pcor::Loop;
using pcor::Model;
using pcor::ModelEffect;
using pcor::Quality;
using pcor::QualityFlags;
using pcor::Quantity;
using pcor::State;
using pcor::test::infinity;
using pcor::test::level;
using pcor::test::missing;
using pcor::test::roles_of;
using pcor::test::Sample;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsNan;
using testing::Not;

Sample with_changes(Sample sample, const Sample& changes) {
  for (const auto& [quantity, value] : changes) sample[quantity] = value;
  return sample;
}

Loop build(const Model& model, const Sample& sample, double rate, CorrectWith with = CorrectWith::model) {
  std::string error;
  auto loop = Loop::build(model, roles_of(sample), rate, &error, with);
  if (!loop) throw std::runtime_error(error);
  return std::move(*loop);
}

void run(Loop& loop, const Sample& sample, double time) {
  for (const auto& [quantity, value] : sample) loop.state()[quantity] = value;
  loop.run(time);
}

/// A functor from a function of the state.
class TestFunctor final : public Functor {
 public:
  using Function = std::function<void(State<double>&)>;
  TestFunctor(std::vector<Quantity> inputs, std::vector<Quantity> outputs, Function function)
      : Functor(std::move(inputs), std::move(outputs)), function_(std::move(function)) {}
  void compute(State<double>& state, QualityFlags&) noexcept override { function_(state); }

 private:
  Function function_;
};

std::unique_ptr<Functor> make_functor(std::vector<Quantity> inputs, std::vector<Quantity> outputs,
                                      TestFunctor::Function function) {
  return std::make_unique<TestFunctor>(std::move(inputs), std::move(outputs), std::move(function));
}

// Writes one more than the sum of its inputs.
std::unique_ptr<Functor> sum(const std::vector<Quantity>& inputs, Quantity output) {
  return make_functor(inputs, {output}, [inputs, output](State<double>& state) {
    double total = 1.0;
    for (const Quantity input : inputs) total += state[input];
    state[output] = total;
  });
}

ModelEffect formula(EffectLocation location, std::string text, std::vector<std::string> names = {},
                    std::vector<double> values = {}) {
  ModelEffect effect;
  effect.id = "of-the-user";
  effect.location = location;
  effect.formula = std::move(text);
  effect.parameter_names = std::move(names);
  effect.parameters = std::move(values);
  return effect;
}

// A C-130 with LAMS, flow angles from the radome, and humidity. In `level` the laser's airspeed implies a
// delta-p near that of this model.
Model c130() {
  Model model;
  model.effects = {
      {"static-constant", {0.004127875}}, {"static-alpha", {0.021279816}}, {"static-qp", {0.030849643}}};
  model.recovery = {{0.95}};
  model.lams.elevation = 1.5;
  model.lams.azimuth = -0.8;
  model.attack_radome = {4.9, 13.4, 6.1};
  model.sideslip_radome = {0.1, 11.8, 0.0};
  return model;
}

const std::vector<Quantity> all_results{
    Quantity::static_defect,        Quantity::lams_static_defect, Quantity::corrected_static_pressure,
    Quantity::corrected_mach,       Quantity::humidity,           Quantity::corrected_dynamic_pressure,
    Quantity::ambient_temperature,  Quantity::corrected_airspeed, Quantity::lams_temperature,
    Quantity::lams_dynamic_pressure};

std::uint32_t bits(std::initializer_list<Quality> list) {
  QualityFlags flags;
  for (const Quality bit : list) flags.set(bit);
  return flags.bits();
}

// The quality bits of the sample that was run, without the one that is of an earlier sample.
std::uint32_t sample_bits(const Loop& loop) {
  return loop.quality().bits() & ~bits({Quality::filter_window_incomplete});
}

// All results of two loops agree to the last bit, missing ones too.
void expect_same(const Loop& loop, const Loop& expected) {
  for (const Quantity result : all_results) {
    const double value = loop.state()[result];
    const double requested = expected.state()[result];
    EXPECT_TRUE(value == requested || (std::isnan(value) && std::isnan(requested)))
        << pcor::info_of(result).name << ": " << value << " for " << requested;
  }
  EXPECT_EQ(sample_bits(loop), sample_bits(expected));
}

TEST(LoopOrder, IsIndependentOfTheOrderOfAddition) {
  std::vector<std::size_t> order{0, 1, 2, 3, 4};
  do {
    Loop loop(1.0);
    std::vector<Quantity> v;
    for (const char* name : {"raw", "a", "b", "c", "d", "e"}) v.push_back(*loop.add_variable(name));
    std::vector<std::unique_ptr<Functor>> functors;
    functors.push_back(sum({v[0]}, v[1]));
    functors.push_back(sum({v[1]}, v[2]));
    functors.push_back(sum({v[1], v[2]}, v[3]));
    functors.push_back(sum({v[3], v[0]}, v[4]));
    functors.push_back(sum({v[4], v[2], v[1]}, v[5]));
    for (const std::size_t number : order) loop.add(std::move(functors[number]));
    std::string error;
    ASSERT_TRUE(loop.order(&error)) << error;
    loop.state()[v[0]] = 1.0;
    loop.run(0.0);
    // a = 2, b = 3, c = 6, d = 8, e = 14
    ASSERT_EQ(loop.state()[v[5]], 14.0);
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(LoopOrder, AcceptsMoreFunctorsThanQuantities) {
  Loop loop(1.0);
  int seen = 0;
  const Quantity late = *loop.add_variable("late");
  for (int i = 0; i < 100; ++i) {
    loop.add(make_functor({late}, {},
                          [&seen, late](State<double>& state) { seen += state[late] == 1.0 ? 1 : 0; }));
  }
  loop.add(make_functor({}, {late}, [late](State<double>& state) { state[late] = 1.0; }));
  std::string error;
  ASSERT_TRUE(loop.order(&error)) << error;
  loop.run(0.0);
  EXPECT_EQ(seen, 100);
}

TEST(LoopOrder, InPlaceFunctorsRunBeforeReaders) {
  for (const bool reader_first : {false, true}) {
    Loop loop(1.0);
    const Quantity x = *loop.add_variable("x");
    const Quantity y = *loop.add_variable("y");
    if (reader_first) loop.add(sum({x}, y));
    loop.add(make_functor({x}, {x}, [x](State<double>& state) { state[x] *= 10.0; }));
    if (!reader_first) loop.add(sum({x}, y));
    ASSERT_TRUE(loop.order(nullptr));
    loop.state()[x] = 2.0;
    loop.run(0.0);
    EXPECT_EQ(loop.state()[y], 21.0);
  }
}

TEST(LoopOrder, TwoWritersOfAQuantityAreRefused) {
  Loop loop(1.0);
  const Quantity x = *loop.add_variable("THRUST");
  loop.add(sum({}, x));
  loop.add(sum({}, x));
  std::string error;
  EXPECT_FALSE(loop.order(&error));
  EXPECT_EQ(error, "two functors write 'THRUST'; combine them in one functor");
  EXPECT_FALSE(loop.order(nullptr));

  Loop corrected = build(c130(), level, 1.0);
  corrected.add(sum({}, Quantity::static_defect));
  EXPECT_FALSE(corrected.order(&error));
  EXPECT_THAT(error, testing::HasSubstr("two functors write 'static_defect', one of them a stage"));
}

// The element of an unknown name, and variables that were not added.
TEST(LoopOrder, UndeclaredVariableIsRefused) {
  for (const Quantity wrong : {pcor::quantity_named("corected_mach"), pcor::extra_quantity(1),
                               pcor::extra_quantity(pcor::extra_capacity)}) {
    for (const bool is_output : {false, true}) {
      Loop loop = build(c130(), level, 1.0);
      const Quantity known = *loop.add_variable("known");
      loop.add(is_output ? sum({known}, wrong) : sum({wrong}, known));
      std::string error;
      EXPECT_FALSE(loop.order(&error));
      EXPECT_NE(error, "");
    }
  }
}

TEST(Loop, UnknownRecordedQuantityIsRefused) {
  std::string error;
  for (const Quantity wrong : {Quantity::count, pcor::extra_quantity(pcor::extra_capacity)}) {
    std::vector<Quantity> recorded = roles_of(level);
    recorded.push_back(wrong);
    EXPECT_FALSE(Loop::build(c130(), recorded, 1.0, &error));
    EXPECT_THAT(error, HasSubstr(std::to_string(index(wrong))));
  }
}

// A formula of a result would use the number that the host left in the state.
TEST(Loop, RecordedResultIsRefused) {
  std::string error;
  for (const Quantity result : {Quantity::port_static_pressure, Quantity::static_defect,
                                Quantity::corrected_airspeed, Quantity::height_step}) {
    std::vector<Quantity> recorded = roles_of(level);
    recorded.push_back(result);
    EXPECT_FALSE(Loop::build(c130(), recorded, 1.0, &error));
    EXPECT_THAT(error, HasSubstr(std::string(pcor::info_of(result).name)));
  }
}

// Numbers that the reader of model files refuses.
TEST(Loop, ImpossibleNumbersOfTheModelAreRefused) {
  using Change = std::function<void(Model&)>;
  const std::map<std::string, Change> changes{
      {"NaN", [](Model& model) { model.effects[0].parameters[0] = missing; }},
      {"bounds", [](Model& model) { model.effects[2].parameters[0] = 30.8; }},
      {"twice", [](Model& model) { model.effects.push_back(model.effects[0]); }},
      {"scaling", [](Model& model) { model.effects[0].scaling.static_pressure = 4; }},
      {"infinite formula",
       [](Model& model) {
         model.effects.push_back(formula(EffectLocation::static_defect, "k", {"k"}, {infinity}));
       }},
      {"recovery in percent", [](Model& model) { model.recovery = {{95.0}}; }},
      {"recovery below zero", [](Model& model) { model.recovery = {{-1.0}}; }},
      {"recovery NaN", [](Model& model) { model.recovery = {{missing}}; }},
      {"recovery infinite",
       [](Model& model) {
         model.recovery = {{0.95, infinity}};
       }},
      {"taper", [](Model& model) { model.policy.taper_below = missing; }},
      {"power", [](Model& model) { model.policy.taper_power = -1.0; }},
      {"minimum", [](Model& model) { model.policy.minimum = missing; }},
      {"airflow", [](Model& model) { model.policy.min_dynamic_pressure = missing; }},
      {"reversed",
       [](Model& model) {
         model.domain = {{"mach", 0.5, 0.2}};
       }},
      {"half",
       [](Model& model) {
         model.domain = {{"mach", missing, 0.2}};
       }},
      {"beam", [](Model& model) { model.lams.elevation = missing; }},
      {"radome", [](Model& model) { model.attack_radome.slope = infinity; }},
  };
  for (const auto& [name, change] : changes) {
    Model model = c130();
    change(model);
    std::string error;
    EXPECT_FALSE(Loop::build(model, roles_of(level), 1.0, &error)) << name;
    EXPECT_NE(error, "") << name;
  }
  Model model = c130();
  model.domain = {{"mach", -infinity, 0.9}};
  EXPECT_TRUE(Loop::build(model, roles_of(level), 1.0, nullptr));
}

// Above Mach 1 the equations do not hold: swapped pressures would give Mach 2.2.
TEST(Loop, SupersonicPressuresGiveNoResult) {
  const Sample recorded{{Quantity::static_pressure, 700.0},
                        {Quantity::dynamic_pressure, 67.6},
                        {Quantity::recovery_temperature, 280.0}};
  Model model;
  model.effects = {{"static-constant", {0.004}}, {"static-qp", {0.03}}};
  for (const double taper : {0.0, 20.0}) {
    model.policy.taper_below = taper;
    Loop loop = build(model, recorded, 1.0);
    for (const auto& [p, q] : {std::pair{67.6, 700.0}, {250.0, 260.0}, {250.0, 223.3}}) {
      run(loop, with_changes(recorded, {{Quantity::static_pressure, p}, {Quantity::dynamic_pressure, q}}),
          0.0);
      for (const Quantity result : {Quantity::static_defect, Quantity::corrected_static_pressure,
                                    Quantity::corrected_mach, Quantity::corrected_airspeed})
        EXPECT_THAT(loop.state()[result], IsNan()) << pcor::info_of(result).name << ' ' << q;
      EXPECT_TRUE(loop.quality().has(Quality::impossible_dynamic_pressure)) << q;
      loop.reset();
    }
    // Mach 0.97
    run(loop,
        with_changes(recorded, {{Quantity::static_pressure, 250.0}, {Quantity::dynamic_pressure, 208.0}}),
        0.0);
    EXPECT_EQ(sample_bits(loop), bits({Quality::dry_air_assumed}));
    EXPECT_NEAR(loop.state()[Quantity::corrected_mach], 0.96, 0.02);
  }
}

// The limit of process is 5 percent.
TEST(Loop, ExtendedFlapsAreOutsideTheDomain) {
  Sample recorded = with_changes(level, {{Quantity::flaps, 0.0}});
  recorded.erase(Quantity::lams_airspeed);
  const auto is_flagged = [&](const Model& model, double flaps) {
    Loop loop = build(model, recorded, 1.0);
    run(loop, with_changes(recorded, {{Quantity::flaps, flaps}}), 0.0);
    return loop.quality().has(Quality::outside_domain);
  };
  EXPECT_FALSE(is_flagged(c130(), pcor::flaps_in));
  EXPECT_TRUE(is_flagged(c130(), pcor::flaps_in + 0.1));
  EXPECT_FALSE(is_flagged(c130(), missing));
  Model neutral = c130();
  neutral.effects.push_back({"flaps-gear", {0.0}});
  EXPECT_TRUE(is_flagged(neutral, 40.0));
  Model described = c130();
  described.effects.push_back({"flaps-gear", {0.001}});
  EXPECT_FALSE(is_flagged(described, 40.0));
  Model ranged = c130();
  ranged.domain = {{"flaps", 0.0, 50.0}};
  EXPECT_FALSE(is_flagged(ranged, 40.0));
  EXPECT_FALSE(is_flagged(Model{}, 40.0)) << "changes nothing";
  Model step;
  step.effects.push_back({"aircraft-step", {0.0, 4000.0}});
  recorded[Quantity::date] = 5000.0;
  EXPECT_FALSE(is_flagged(step, 40.0)) << "a step of zero changes nothing on any date";
}

TEST(LoopOrder, CircularDependencyIsRefusedAndReported) {
  Loop loop(1.0);
  const Quantity a = *loop.add_variable("a");
  const Quantity b = *loop.add_variable("b");
  const Quantity c = *loop.add_variable("c");
  const Quantity outside = *loop.add_variable("outside");
  loop.add(sum({c}, outside));
  loop.add(sum({b}, a));
  loop.add(sum({c}, b));
  loop.add(sum({a}, c));
  loop.add(make_functor({outside}, {}, [](State<double>&) {}));
  std::string error;
  EXPECT_FALSE(loop.order(&error));
  EXPECT_THAT(
      error, testing::AnyOf("functors wait for each other: 'a' needs 'b', which needs 'c', which needs 'a'",
                            "functors wait for each other: 'b' needs 'c', which needs 'a', which needs 'b'",
                            "functors wait for each other: 'c' needs 'a', which needs 'b', which needs 'c'"));
  EXPECT_FALSE(loop.order(nullptr));
  loop.run(0.0);  // still whole
}

TEST(Loop, ReproducesEquation18) {
  Loop loop = build(c130(), level, 1.0);
  run(loop, level, 0.0);
  const State<double>& s = loop.state();
  const double defect = 700.0 * (0.004127875 + 0.021279816 * (-15.3 / 67.1) + 0.030849643 * (67.6 / 700.0));
  EXPECT_NEAR(s[Quantity::static_defect], defect, 1e-12);
  EXPECT_NEAR(s[Quantity::corrected_static_pressure], 700.0 + defect, 1e-12);
  EXPECT_NEAR(s[Quantity::corrected_dynamic_pressure], 67.6 - defect, 1e-12);
  const double humidity = 4.2 / (700.0 + defect);
  const double heating = std::pow(767.6 / (700.0 + defect), 2.0 / 7.0 / (1.0 + humidity / 7.0)) - 1.0;
  EXPECT_NEAR(s[Quantity::corrected_mach], std::sqrt(5.0 * (1.0 + humidity / 5.0) * heating), 1e-12);
  EXPECT_EQ(sample_bits(loop), 0U);
  for (const Quantity result : all_results)
    EXPECT_TRUE(std::isfinite(s[result])) << pcor::info_of(result).name;
}

TEST(Loop, ConstantFlightGivesTheSameAtAnyRate) {
  Model model = c130();
  model.effects.push_back({"static-lag", {0.15}});
  Loop slow = build(model, level, 1.0);
  Loop fast = build(model, level, 25.0);
  for (int second = 0; second < 20; ++second) {
    run(slow, level, second);
    for (int i = 0; i < 25; ++i) {
      run(fast, level, second + i / 25.0);
      if (second >= static_cast<int>(slow.delay())) expect_same(fast, slow);
    }
  }
}

TEST(Loop, LoopsHaveIndependentStates) {
  Model model = c130();
  model.effects.push_back({"static-lag", {0.15}});
  const auto climb = [](double time, double rate) {
    return with_changes(level, {{Quantity::static_pressure, 700.0 - rate * time + 0.1 * std::sin(time)}});
  };
  Loop alone_slow = build(model, level, 1.0), alone_fast = build(model, level, 25.0);
  Loop slow = build(model, level, 1.0), fast = build(model, level, 25.0);
  for (int i = 0; i < 250; ++i) run(alone_fast, climb(i / 25.0, 2.0), i / 25.0);
  for (int i = 0; i < 10; ++i) run(alone_slow, climb(i, 0.5), i);
  for (int i = 0; i < 250; ++i) {
    if (i % 25 == 0) run(slow, climb(i / 25, 0.5), i / 25);
    run(fast, climb(i / 25.0, 2.0), i / 25.0);
  }
  expect_same(slow, alone_slow);
  expect_same(fast, alone_fast);
}

TEST(Loop, ComputesRatesForEffects) {
  Model model = c130();
  model.effects.push_back({"temp-lag", {2.0}});
  model.effects.push_back({"clock-skew", {0.5}});
  const auto sample = [](double time) {
    return with_changes(level, {{Quantity::static_pressure, 700.0 - 0.8 * time},
                                {Quantity::dynamic_pressure, 67.6 + 0.5 * time},
                                {Quantity::recovery_temperature, 280.0 - 0.06 * time}});
  };
  for (const double rate : {1.0, 25.0}) {
    Loop loop = build(model, level, rate);
    ASSERT_EQ(loop.delay(), rate == 1.0 ? 6U : 75U);
    const auto last = static_cast<int>(3 * loop.delay());
    for (int i = 0; i <= last; ++i) {
      run(loop, sample(i / rate), i / rate);
      EXPECT_EQ(std::isnan(loop.state()[Quantity::time]), static_cast<std::size_t>(i) < loop.delay());
      EXPECT_EQ(loop.last_time(), i / rate);
      EXPECT_EQ(sample_bits(loop), static_cast<std::size_t>(i) < loop.delay()
                                       ? static_cast<std::uint32_t>(Quality::awaiting_later_samples)
                                       : 0U);
    }
    const State<double> s = loop.state();
    const double time = (last - static_cast<double>(loop.delay())) / rate;
    EXPECT_NEAR(s[Quantity::time], time, 1e-12);
    EXPECT_EQ(s[Quantity::static_pressure], 700.0 - 0.8 * time) << "inputs are of the same sample";
    EXPECT_NEAR(s[Quantity::recovery_temperature_rate], -0.06, 1e-10);

    // The airspeed along the beam over the last half second, by a loop without effects of rates.
    Loop still = build(c130(), level, rate);
    const auto along_beam = [&](double t) {
      run(still, sample(t), t);
      const State<double>& now = still.state();
      return now[Quantity::corrected_airspeed] * pcor::beam_cosine(c130().lams.elevation, c130().lams.azimuth,
                                                                   now[Quantity::attack],
                                                                   now[Quantity::sideslip]);
    };
    // It is hardly curved: 0.01 m/s2 in a second.
    EXPECT_NEAR(s[Quantity::airspeed_rate], (along_beam(time) - along_beam(time - 0.5)) / 0.5, 2e-3);

    // The lag makes the air colder by 0.12 K at the thermometer, the late laser reads low.
    run(still, sample(time), time);
    EXPECT_NEAR(s[Quantity::ambient_temperature] - still.state()[Quantity::ambient_temperature],
                -0.12 / (1 + 0.95 * 0.2 * 0.36 * 0.36), 1e-3);
    EXPECT_LT(s[Quantity::lams_static_defect], still.state()[Quantity::lams_static_defect]);
  }
}

TEST(Loop, ImpossibleRateIsRefused) {
  for (const auto& [rate, text] :
       std::initializer_list<std::pair<double, const char*>>{{missing, "nan samples/s"},
                                                             {infinity, "inf samples/s"},
                                                             {0.0, "0 samples/s"},
                                                             {-1.0, "-1 samples/s"},
                                                             {1e15, "1e+15 samples/s"}}) {
    std::vector<Quantity> roles;
    for (const auto& [role, value] : level) roles.push_back(role);
    std::string error;
    EXPECT_FALSE(Loop::build(c130(), roles, rate, &error).has_value());
    EXPECT_THAT(error, testing::HasSubstr(text));
  }
}

// Rates of change are computed before the functors.
TEST(LoopOrder, WriterOfAQuantityWithARateIsRefused) {
  Model model;
  model.effects = {{"qcf-lag", {1.0}}};
  Loop loop = build(model, {{Quantity::static_pressure, 700.0}, {Quantity::dynamic_pressure, 70.0}}, 1.0);
  loop.add(make_functor({Quantity::dynamic_pressure}, {Quantity::dynamic_pressure},
                        [](State<double>& state) { state[Quantity::dynamic_pressure] *= 10.0; }));
  std::string error;
  EXPECT_FALSE(loop.order(&error));
  EXPECT_THAT(error, HasSubstr("dynamic_pressure"));
}

// The rate of the airspeed depends on the inputs of the model's airspeed.
TEST(LoopOrder, WriterOfAnInputOfTheAirspeedWithARateIsRefused) {
  Model model = c130();
  model.effects.push_back({"clock-skew", {2.0}});
  const Sample sample = with_changes(level, {{Quantity::roll, 2.0}});
  const auto error_of_writer = [&](Quantity quantity) {
    Loop loop = build(model, sample, 1.0);
    loop.add(
        make_functor({quantity}, {quantity}, [quantity](State<double>& state) { state[quantity] *= 1.5; }));
    std::string error;
    return loop.order(&error) ? std::string() : error;
  };
  for (const auto& [quantity, value] : level) {
    if (quantity == Quantity::lams_airspeed) continue;
    EXPECT_THAT(error_of_writer(quantity), HasSubstr(std::string(info_of(quantity).name)));
  }
  for (const Quantity quantity : {Quantity::lams_airspeed, Quantity::roll, Quantity::liquid_water})
    EXPECT_EQ(error_of_writer(quantity), "") << "no input of the airspeed";
}

// The late clock is corrected by the airspeed of the model, which does not depend on that of the laser.
TEST(LoopOrder, FunctorCorrectsALateLaser) {
  Model model = c130();
  model.effects.push_back({"clock-skew", {2.0}});
  Loop before = build(model, level, 1.0), inside = build(model, level, 1.0);
  inside.add(make_functor({Quantity::lams_airspeed}, {Quantity::lams_airspeed},
                          [](State<double>& state) { state[Quantity::lams_airspeed] *= 1.01; }));
  std::string error;
  ASSERT_TRUE(inside.order(&error)) << error;
  for (int i = 0; i < 20; ++i) {
    const Sample sample = with_changes(level, {{Quantity::dynamic_pressure, 67.6 + 0.5 * i}});
    run(inside, sample, i);
    run(before, with_changes(sample, {{Quantity::lams_airspeed, 1.01 * 117.0}}), i);
  }
  EXPECT_TRUE(std::isfinite(inside.state()[Quantity::lams_static_defect]));
  expect_same(inside, before);
}

TEST(Loop, ImpossibleClockSkewIsRefused) {
  for (const auto& [seconds, text] : std::initializer_list<std::pair<double, const char*>>{
           {missing, "nan s"}, {infinity, "inf s"}, {60.00001, "60.00001 s"}, {-1e300, "-1e+300 s"}}) {
    Model model = c130();
    model.effects.push_back({"clock-skew", {seconds}});
    std::vector<Quantity> roles;
    for (const auto& [role, value] : level) roles.push_back(role);
    std::string error;
    EXPECT_FALSE(Loop::build(model, roles, 25.0, &error).has_value());
    EXPECT_THAT(error, testing::HasSubstr(std::string("clock-skew is ") + text));
  }
}

TEST(Loop, WetThermometerDriesAfterACloud) {
  Model model = c130();
  model.effects.push_back({"temp-wetting", {-2.0, 10.0}});
  for (const double rate : {1.0, 25.0}) {
    const Sample dry = with_changes(level, {{Quantity::liquid_water, 0.0}});
    Loop loop = build(model, dry, rate);
    EXPECT_EQ(loop.delay(), 0U) << "what was before is enough";
    run(loop, dry, 0.0);
    const double air = loop.state()[Quantity::ambient_temperature];
    int i = 1;
    for (; i < 20 * rate; ++i) run(loop, with_changes(level, {{Quantity::liquid_water, 0.4}}), i / rate);
    EXPECT_GT(loop.state()[Quantity::ambient_temperature], air + 1.7) << "2 K at the thermometer";
    for (; i < 30 * rate; ++i) run(loop, dry, i / rate);
    const double remaining = (loop.state()[Quantity::ambient_temperature] - air) / 2.0;
    // exp(-1), the mean over the last sample; recovery makes it a few percent less.
    EXPECT_NEAR(remaining, std::exp(-1.0), 0.04);
    run(loop, dry, i / rate + 100.0);
    EXPECT_EQ(loop.state()[Quantity::ambient_temperature], air)
        << "after a gap nothing is known of the cloud";
    run(loop, with_changes(level, {{Quantity::liquid_water, missing}}), i / rate + 100.0 + 1.0 / rate);
    EXPECT_TRUE(std::isnan(loop.state()[Quantity::ambient_temperature]));
    EXPECT_TRUE(loop.quality().has(Quality::temperature_missing));
  }
  for (const auto& [drying, text] : std::initializer_list<std::pair<double, const char*>>{
           {missing, "nan s"}, {infinity, "inf s"}, {-1.0, "-1 s"}, {601.0, "601 s"}}) {
    model.effects.back().parameters = {-2.0, drying};
    std::vector<Quantity> roles{Quantity::liquid_water};
    for (const auto& [role, value] : level) roles.push_back(role);
    std::string error;
    EXPECT_FALSE(Loop::build(model, roles, 25.0, &error).has_value());
    EXPECT_THAT(error, testing::HasSubstr(std::string("temp-wetting is ") + text));
  }
}

// A lag of 0.3 s in both lines, undone at each rate: its remainder at periods of 2 s and more.
TEST(Loop, CorrectsLagsAtEveryRate) {
  constexpr double tau = 0.3;
  Model lagging;
  lagging.effects = {{"static-lag", {tau}}, {"total-lag", {tau}}};
  for (const double rate : {5.0, 25.0, 50.0}) {
    for (const double period : {2.0, 4.0, 20.0}) {
      const double turn = 2.0 * 3.14159265358979 / period;
      // Output of a first-order lag for the wave: smaller, and later.
      const double size = 1.0 / std::sqrt(1.0 + turn * turn * tau * tau);
      const double phase = std::atan(turn * tau);
      const auto true_static = [&](double t) { return 700.0 + std::sin(turn * t); };
      const auto true_dynamic = [&](double t) { return 70.0 + 2.0 * std::cos(turn * t); };
      const auto sample = [&](double t) {
        const double late_static = 700.0 + size * std::sin(turn * t - phase);
        const double late_total =
            770.0 + size * std::sin(turn * t - phase) + 2.0 * size * std::cos(turn * t - phase);
        return Sample{{Quantity::static_pressure, late_static},
                      {Quantity::dynamic_pressure, late_total - late_static}};
      };
      Loop loop = build(lagging, sample(0.0), rate);
      double before = 0.0;
      double after = 0.0;
      for (int i = 0; i < static_cast<int>(40 * rate); ++i) {
        run(loop, sample(i / rate), i / rate);
        const double t = loop.state()[Quantity::time];
        if (!(t > 5.0)) continue;
        const State<double>& s = loop.state();
        before = std::max(before, std::abs(s[Quantity::static_pressure] - true_static(t)));
        after = std::max(after, std::abs(s[Quantity::corrected_static_pressure] - true_static(t)));
        EXPECT_NEAR(s[Quantity::corrected_dynamic_pressure], true_dynamic(t), 0.02 * turn * tau);
      }
      EXPECT_LT(after, 0.01 * before) << rate << " Hz, " << period << " s";
    }
  }
}

TEST(LoopGap, RestartsAtGapsAndRepeatedTimes) {
  struct Case {
    double rate;
    double time;  // after samples at 100 and 100 + 1/rate
    bool gap;
  };
  const Case cases[] = {
      {1.0, 102.0, false},   {1.0, 102.49, false},  {1.0, 102.51, true},  {1.0, 1e6, true},
      {1.0, 101.0, true},    {1.0, 100.5, true},    {1.0, 0.0, true},     {1.0, missing, true},
      {1.0, infinity, true}, {25.0, 100.08, false}, {25.0, 100.12, true}, {25.0, 100.04, true},
      {25.0, 101.0, true},   {1.0, 101.001, false},
  };
  Model model;
  model.effects = {{"static-lag", {0.15}}};
  const Sample recorded{{Quantity::static_pressure, 700.0}, {Quantity::dynamic_pressure, 67.6}};
  for (const auto& [rate, time, gap] : cases) {
    SCOPED_TRACE(testing::Message() << rate << " Hz, " << time << " s");
    Loop loop = build(model, recorded, rate);
    const auto delay = static_cast<int>(loop.delay());
    for (int i = 0; i <= delay; ++i) {
      EXPECT_THAT(loop.state()[Quantity::corrected_static_pressure], IsNan());
      run(loop, recorded, 100.0 + (i + 1 - delay) / rate);
    }
    EXPECT_EQ(loop.state()[Quantity::corrected_static_pressure], 700.0);
    run(loop, recorded, time);
    EXPECT_EQ(std::isnan(loop.state()[Quantity::corrected_static_pressure]), gap);
    if (std::isnan(time)) continue;
    for (int i = 0; i <= delay; ++i) run(loop, recorded, 2000.0 + i / rate);
    EXPECT_EQ(loop.state()[Quantity::corrected_static_pressure], 700.0) << "and continues";
    EXPECT_EQ(loop.state()[Quantity::time], 2000.0);
    EXPECT_FALSE(loop.quality().has(Quality::after_gap));
  }
}

/// A lag of 5 s of a pressure that rises by 2 hPa/s, at the times given; the results and bits of each run.
struct Lagged {
  std::vector<double> defects{};
  std::vector<std::uint32_t> bits{};
  std::vector<double> times{};
};

Lagged run_lagged(double rate, const std::vector<double>& times) {
  Model model;
  model.effects = {{"static-lag", {5.0}}};
  const Sample sample{{Quantity::static_pressure, 700.0}, {Quantity::dynamic_pressure, 60.0}};
  Loop loop = build(model, sample, rate);
  Lagged result;
  for (const double time : times) {
    run(loop, with_changes(sample, {{Quantity::static_pressure, 700.0 + 2.0 * (time - times.front())}}),
        time);
    const State<double>& state = loop.state();
    result.defects.push_back(state[Quantity::port_static_pressure] - state[Quantity::static_pressure]);
    result.bits.push_back(loop.quality().bits());
    result.times.push_back(state[Quantity::time]);
  }
  return result;
}

std::vector<double> steps(const std::vector<std::pair<int, double>>& parts) {
  std::vector<double> times{0.0};
  for (const auto& [count, step] : parts)
    for (int i = 0; i < count; ++i) times.push_back(times.back() + step);
  return times;
}

/// Every result is correct, or missing or doubtful with the appropriate bit. Returns the number of correct
/// results.
std::size_t expect_right_or_told(const Lagged& lagged) {
  constexpr double right = 10.0;  // tau times the rate of change
  std::size_t count = 0;
  for (std::size_t i = 0; i < lagged.defects.size(); ++i) {
    if (std::abs(lagged.defects[i] - right) < 0.03 * right) {
      ++count;
    } else {
      const QualityFlags none;
      EXPECT_NE(lagged.bits[i] & (static_cast<std::uint32_t>(Quality::uneven_samples) |
                                  static_cast<std::uint32_t>(Quality::awaiting_later_samples) |
                                  static_cast<std::uint32_t>(Quality::after_gap)),
                none.bits())
          << i << ": " << lagged.defects[i];
    }
  }
  return count;
}

TEST(LoopInterval, ChangedIntervalGivesCorrectResultOrBit) {
  EXPECT_GT(expect_right_or_told(run_lagged(1.0, steps({{100, 1.0}, {90, 0.25}, {100, 1.0}}))), 150U);
  EXPECT_GT(expect_right_or_told(run_lagged(1.0, steps({{100, 1.0}, {90, 1.4}}))), 80U);
  expect_right_or_told(run_lagged(25.0, steps({{2000, 0.01}})));
  expect_right_or_told(run_lagged(25.0, steps({{2000, 0.05}})));
  std::vector<double> jitter;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> early(-0.4, 0.4);
  for (int i = 0; i < 500; ++i) jitter.push_back(i + early(random));
  expect_right_or_told(run_lagged(1.0, jitter));
}

TEST(LoopInterval, NominalIntervalSetsNoBit) {
  for (const double off : {1.0, 1.01, 0.99}) {
    const Lagged lagged = run_lagged(25.0, steps({{3000, off / 25.0}}));
    EXPECT_EQ(expect_right_or_told(lagged), 3001U - 75U);
    for (const std::uint32_t bits : lagged.bits)
      ASSERT_EQ(bits & static_cast<std::uint32_t>(Quality::uneven_samples), 0U);
  }
}

// With a lag the filter was reset 96 samples before the uneven step passed it.
TEST(LoopInterval, UnevenStepInterruptsTheLaserFilterAtTheSameSamplesWithALag) {
  const auto missing_times = [](const Model& model) {
    Loop loop = build(model, level, 1.0);
    std::vector<double> gaps;
    for (const double time : steps({{300, 1.0}, {1, 1.2}, {300, 1.0}})) {
      // A laser with one value for five minutes is frozen.
      run(loop, with_changes(level, {{Quantity::lams_airspeed, 117.0 + 1e-6 * time}}), time);
      const State<double>& state = loop.state();
      if (state[Quantity::time] > 150.0 && std::isnan(state[Quantity::filtered_lams_temperature]))
        gaps.push_back(state[Quantity::time]);
    }
    return gaps;
  };
  const std::vector<double> expected = missing_times(c130());
  EXPECT_FALSE(expected.empty());
  Model lagging = c130();
  lagging.effects.push_back({"qcf-lag", {0.5}});
  EXPECT_EQ(missing_times(lagging), expected);
}

TEST(LoopInterval, FlagsTheDelayOfTheFilter) {
  const Lagged lagged = run_lagged(1.0, steps({{20, 1.0}, {1, 100.0}, {20, 1.0}}));
  for (std::size_t i = 0; i < lagged.defects.size(); ++i) {
    const bool waits = i < 6 || (i > 20 && i < 27);
    EXPECT_EQ((lagged.bits[i] & static_cast<std::uint32_t>(Quality::awaiting_later_samples)) != 0, waits)
        << i;
    EXPECT_EQ(std::isnan(lagged.times[i]), waits) << i;
  }
}

/// Noisy flight at 25 Hz, in steps of `resolution`, in which one role is frozen for some time, and every
/// `dropout`-th of its values is missing: returns the samples with the bit.
std::vector<bool> told_frozen(Quantity role, double noise, double resolution, std::size_t from,
                              std::size_t to, std::size_t dropout = 0) {
  const Sample flown{{Quantity::static_pressure, 700.0},
                     {Quantity::dynamic_pressure, 60.0},
                     {Quantity::recovery_temperature, 280.0},
                     {Quantity::attack, 3.0},
                     {Quantity::sideslip, 0.5},
                     {Quantity::lams_airspeed, 120.0}};
  Model model;
  model.effects = {{"static-constant", {0.004}}};
  Loop loop = build(model, flown, 25.0);
  std::mt19937 random(3);
  std::normal_distribution<double> gauss(0.0, noise);
  double held = 0.0;
  std::vector<bool> told;
  for (std::size_t i = 0; i < 20000; ++i) {
    Sample sample = flown;
    for (auto& [quantity, value] : sample)
      value = std::round((value + std::sin(0.001 * static_cast<double>(i)) + gauss(random)) / resolution) *
              resolution;
    if (i >= from && i < to) {
      if (i == from) held = sample[role];
      sample[role] = held;
    }
    if (dropout > 0 && i % dropout == 0) sample[role] = missing;
    run(loop, sample, 0.04 * static_cast<double>(i));
    told.push_back(loop.quality().has(Quality::sensor_frozen));
  }
  return told;
}

TEST(LoopFrozen, ConstantSensorSetsABit) {
  for (const Quantity role :
       {Quantity::static_pressure, Quantity::dynamic_pressure, Quantity::recovery_temperature,
        Quantity::attack, Quantity::sideslip, Quantity::lams_airspeed}) {
    const std::vector<bool> told = told_frozen(role, 0.05, 0.001, 5000, 9000);
    for (std::size_t i = 0; i < told.size(); ++i)
      ASSERT_EQ(told[i], i >= 5000 + 124 && i < 9000) << i << " of " << pcor::info_of(role).name;
  }
}

TEST(LoopFrozen, CoarseSensorIsFlaggedAfterFiveMinutes) {
  const std::vector<bool> told = told_frozen(Quantity::static_pressure, 0.05, 0.5, 5000, 15000);
  for (std::size_t i = 0; i < told.size(); ++i) {
    if (i < 10000 || i >= 15000) {
      ASSERT_FALSE(told[i]) << i;
    }
  }
  EXPECT_TRUE(told[14000]);
}

// A missing value neither ends nor extends a run of one value, also that of the dynamic pressure, without
// which it is unknown whether the aircraft flies.
TEST(LoopFrozen, DropoutsDoNotRestartTheSearch) {
  for (const Quantity role : {Quantity::recovery_temperature, Quantity::dynamic_pressure}) {
    const std::vector<bool> told = told_frozen(role, 0.05, 0.001, 5000, 9000, 19);
    for (std::size_t i = 0; i < told.size(); ++i)  // seven of the first 132 samples are missing
      ASSERT_EQ(told[i], i >= 5000 + 131 && i < 9000 && i % 19 != 0)
          << i << " of " << pcor::info_of(role).name;
  }
}

// A packet is lost in each minute: the next search of five seconds knows the noise.
TEST(LoopFrozen, GapsDoNotHideAFrozenSensor) {
  Model model;
  model.effects = {{"static-constant", {0.004}}};
  const Sample flown{{Quantity::static_pressure, 700.0}, {Quantity::dynamic_pressure, 60.0}};
  Loop loop = build(model, flown, 25.0);
  std::mt19937 random(3);
  std::normal_distribution<double> gauss(0.0, 0.05);
  double time = 0.0;
  for (int i = 0; i < 15000; ++i) {
    time += i % 1500 == 0 ? 1.0 : 0.04;
    const double p = 700.0 + (i < 3000 ? gauss(random) : 0.0);
    run(loop, {{Quantity::static_pressure, p}, {Quantity::dynamic_pressure, 60.0 + gauss(random)}}, time);
    if (i >= 3000) {
      ASSERT_EQ(loop.quality().has(Quality::sensor_frozen), i % 1500 >= 124) << i;
    }
  }
}

// A vane with steps of 0.022 deg, in turbulence for ten minutes and then in calm air.
TEST(LoopFrozen, CalmAirAfterTurbulenceSetsNoBit) {
  const Sample flown{
      {Quantity::static_pressure, 700.0}, {Quantity::dynamic_pressure, 60.0}, {Quantity::attack, 3.0}};
  Model model;
  model.effects = {{"static-attack", {0.0005}}};
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Loop loop = build(model, flown, 25.0);
    std::mt19937 random(seed);
    std::normal_distribution<double> gauss;
    double wave = 0.0;
    for (int i = 0; i < 25 * 1200; ++i) {
      const bool is_calm = i >= 25 * 600;
      const double memory = std::exp(-0.04 / (is_calm ? 5.0 : 1.0));
      wave = memory * wave + std::sqrt(1.0 - memory * memory) * (is_calm ? 0.01 : 0.7) * gauss(random);
      run(loop,
          {{Quantity::static_pressure, 700.0 + 0.02 * gauss(random)},
           {Quantity::dynamic_pressure, 60.0 + 0.05 * gauss(random)},
           {Quantity::attack, 0.022 * std::round((3.0 + wave) / 0.022)}},
          0.04 * i);
      ASSERT_FALSE(loop.quality().has(Quality::sensor_frozen)) << i << " of seed " << seed;
    }
  }
}

// A frozen laser is missing, so the model corrects; other frozen readings are used, without an uncertainty.
TEST(LoopFrozen, FrozenSensorIsIdentifiedAndALaserMissing) {
  const Sample flown{{Quantity::static_pressure, 700.0},
                     {Quantity::dynamic_pressure, 67.6},
                     {Quantity::recovery_temperature, 280.0},
                     {Quantity::attack, 3.0},
                     {Quantity::lams_airspeed, 121.0}};
  Model model;
  model.effects = {{"static-attack", {0.0005}}};
  model.recovery = {{0.95}};
  pcor::ModelUncertainty uncertainty;
  uncertainty.static_defect = 0.3;
  std::string error;
  for (const Quantity frozen : {Quantity::attack, Quantity::lams_airspeed}) {
    std::optional<Loop> loop =
        Loop::build(model, roles_of(flown), 25.0, &error, CorrectWith::lams, uncertainty);
    ASSERT_TRUE(loop) << error;
    std::mt19937 random(1);
    std::normal_distribution<double> gauss(0.0, 0.05);
    for (int i = 0; i < 1000; ++i) {
      Sample sample = flown;
      for (auto& [quantity, value] : sample) value += quantity == frozen && i > 500 ? 0.0 : gauss(random);
      run(*loop, sample, 0.04 * i);
    }
    const bool is_laser = frozen == Quantity::lams_airspeed;
    const auto& state = loop->state();
    EXPECT_TRUE(loop->quality().has(Quality::sensor_frozen));
    EXPECT_EQ(loop->is_frozen(Quantity::attack), !is_laser);
    EXPECT_EQ(loop->is_frozen(Quantity::lams_airspeed), is_laser);
    EXPECT_EQ(loop->quality().has(Quality::corrected_with_lams), !is_laser);
    EXPECT_FALSE(std::isnan(state[Quantity::corrected_static_pressure]));
    EXPECT_EQ(std::isnan(state[Quantity::static_defect_uncertainty]), !is_laser);
  }
}

TEST(LoopFrozen, GroundSamplesSetNoBit) {
  const Sample parked{{Quantity::static_pressure, 1000.0}, {Quantity::dynamic_pressure, 0.0}};
  Model model;
  model.effects = {{"static-constant", {0.004}}};
  Loop loop = build(model, parked, 25.0);
  for (int i = 0; i < 20000; ++i) {
    run(loop, parked, 0.04 * i);
    ASSERT_FALSE(loop.quality().has(Quality::sensor_frozen));
  }
}

// Delta-p of the laser, which shows its lock, needs a thermometer; the temperature is then compared with that
// of the standard atmosphere.
TEST(Loop, LamsTemperatureWithoutLockOrThermometerIsMissing) {
  Sample flown{{Quantity::static_pressure, 700.0},
               {Quantity::dynamic_pressure, 67.6},
               {Quantity::recovery_temperature, missing},
               {Quantity::attack, 3.0},
               {Quantity::lams_airspeed, 121.0}};
  Model model;
  model.effects = {{"static-qp", {0.03}}};
  model.recovery = {{0.95}};
  Loop loop = build(model, flown, 1.0);
  run(loop, flown, 0.0);
  EXPECT_NEAR(loop.state()[Quantity::lams_temperature], 282.7, 0.1);
  for (const double unlocked : {140.0, 100.0}) {
    flown[Quantity::lams_airspeed] = unlocked;
    run(loop, flown, loop.last_time() + 1.0);
    EXPECT_THAT(loop.state()[Quantity::lams_temperature], IsNan()) << unlocked;
  }
}

TEST(Loop, CompilerKeepsNan) { EXPECT_TRUE(pcor::arithmetic_keeps_nan()); }

TEST(LoopGap, ResetRestartsTheState) {
  Model model;
  model.effects = {{"static-lag", {0.15}}};
  const Sample recorded{{Quantity::static_pressure, 700.0}, {Quantity::dynamic_pressure, 67.6}};
  Loop loop = build(model, recorded, 1.0);
  for (int i = 0; i < 10; ++i) run(loop, recorded, i);
  EXPECT_EQ(loop.state()[Quantity::corrected_static_pressure], 700.0);
  loop.reset();
  EXPECT_THAT(loop.last_time(), IsNan());
  run(loop, recorded, 10.0);
  EXPECT_THAT(loop.state()[Quantity::corrected_static_pressure], IsNan());
}

// One sample between two gaps has no neighbour, and so no rate of change. Runs without values flush the
// samples in the loop.
TEST(LoopGap, FlagsAnIsolatedSample) {
  Model model;
  model.effects = {{"static-lag", {0.15}}};
  const Sample recorded{{Quantity::static_pressure, 700.0}, {Quantity::dynamic_pressure, 67.6}};
  Loop loop = build(model, recorded, 1.0);
  run(loop, recorded, 0.0);
  const Sample nothing{{Quantity::static_pressure, missing}, {Quantity::dynamic_pressure, missing}};
  for (std::size_t i = 1; i <= loop.delay(); ++i) run(loop, nothing, static_cast<double>(i));
  EXPECT_EQ(loop.state()[Quantity::time], 0.0);
  EXPECT_TRUE(loop.quality().has(Quality::after_gap));
  EXPECT_THAT(loop.state()[Quantity::corrected_static_pressure], IsNan());
}

TEST(LoopGap, RestartSetsABit) {
  Loop loop = build(c130(), level, 1.0);
  run(loop, level, 0.0);
  EXPECT_EQ(sample_bits(loop), 0U) << "the first sample";
  run(loop, level, 50.0);
  EXPECT_EQ(sample_bits(loop), bits({Quality::after_gap}));
  run(loop, level, 51.0);
  EXPECT_EQ(sample_bits(loop), 0U);
  for (const double time : {51.0, 50.0, infinity, 52.0, -infinity, 53.0, missing, missing}) {
    run(loop, level, time);
    EXPECT_EQ(sample_bits(loop), bits({Quality::uneven_samples})) << time;
  }
  loop.reset();
  run(loop, level, 100.0);
  EXPECT_EQ(sample_bits(loop), 0U) << "after reset";
}

// Every sample restarts the watch of frozen sensors, and the wait for later samples.
TEST(LoopGap, WrongRateSetsABitAtEverySample) {
  Model lagged = c130();
  lagged.effects.push_back({"static-lag", {0.05}});
  for (const Model& model : {c130(), lagged}) {
    Loop loop = build(model, level, 25.0);
    for (int i = 0; i < 5; ++i) {
      run(loop, level, i);
      EXPECT_EQ(loop.quality().has(Quality::after_gap), i > 0);
    }
    run(loop, level, missing);
    EXPECT_TRUE(loop.quality().has(Quality::uneven_samples));
  }
}

TEST(LoopVariables, EachNameHasOneIndex) {
  Loop loop(1.0);
  const auto first = loop.add_variable("N1");
  const auto second = loop.add_variable("N2");
  ASSERT_TRUE(first && second);
  EXPECT_NE(*first, *second);
  EXPECT_EQ(loop.add_variable("N1"), first);
  EXPECT_EQ(loop.add_variable("altitude"), Quantity::altitude);
  EXPECT_THAT(loop.extra_names(), ElementsAre("N1", "N2"));
  for (std::size_t i = 2; i < pcor::extra_capacity; ++i) {
    EXPECT_TRUE(loop.add_variable("M" + std::to_string(i)));
  }
  EXPECT_FALSE(loop.add_variable("one too many"));
  EXPECT_EQ(loop.add_variable("N2"), second);
}

TEST(LoopVariables, FormulaVariablesAreListedAndUsed) {
  Model model;
  model.effects = {formula(EffectLocation::static_defect, "k * ENGTRQ / 100 + SPLR", {"k"}, {2.0})};
  const Sample recorded{{Quantity::static_pressure, 700.0}, {Quantity::dynamic_pressure, 67.6}};
  Loop loop = build(model, recorded, 1.0);
  EXPECT_THAT(loop.extra_names(), ElementsAre("ENGTRQ", "SPLR"));
  loop.state()[pcor::extra_quantity(0)] = 50.0;
  loop.state()[pcor::extra_quantity(1)] = 0.25;
  run(loop, recorded, 0.0);
  EXPECT_EQ(loop.state()[Quantity::static_defect], 1.25);
  loop.state()[pcor::extra_quantity(1)] = missing;
  run(loop, recorded, 1.0);
  EXPECT_THAT(loop.state()[Quantity::static_defect], IsNan());
  EXPECT_TRUE(loop.quality().has(Quality::effect_input_missing));
}

// Results of a user's functor are available before the stage that reads them, for any stage.
TEST(LoopFunctors, CanRunBetweenModelStages) {
  Model model = c130();
  model.effects.push_back(formula(EffectLocation::static_defect, "THRUST"));
  Sample recorded = level;
  recorded.erase(Quantity::lams_airspeed);
  Loop loop = build(model, recorded, 1.0);
  recorded.erase(Quantity::vapor_pressure);
  const Quantity thrust = *loop.add_variable("THRUST");
  const Quantity speed = *loop.add_variable("N1");
  const Quantity mixing = *loop.add_variable("hygrometer");
  loop.add(
      make_functor({speed}, {thrust}, [=](State<double>& state) { state[thrust] = state[speed] / 200.0; }));
  loop.add(make_functor(
      {mixing, Quantity::corrected_static_pressure}, {Quantity::vapor_pressure}, [=](State<double>& state) {
        state[Quantity::vapor_pressure] = state[mixing] * state[Quantity::corrected_static_pressure];
      }));
  const Quantity twice = *loop.add_variable("twice the airspeed");
  loop.add(make_functor({Quantity::corrected_airspeed}, {twice}, [=](State<double>& state) {
    state[twice] = 2.0 * state[Quantity::corrected_airspeed];
  }));
  std::string error;
  ASSERT_TRUE(loop.order(&error)) << error;
  for (int i = 0; i < 3; ++i) {
    SCOPED_TRACE(i);
    loop.state()[speed] = 80.0 + i;
    loop.state()[mixing] = 0.001 * (i + 1);
    run(loop, recorded, i);
    Loop plain = build(c130(), recorded, 1.0);
    run(plain, recorded, 0.0);
    const State<double>& s = loop.state();
    EXPECT_NEAR(s[Quantity::static_defect], plain.state()[Quantity::static_defect] + 0.4 + i / 200.0, 1e-12);
    EXPECT_NEAR(s[Quantity::humidity], 0.001 * (i + 1), 1e-15);
    EXPECT_EQ(s[twice], 2.0 * s[Quantity::corrected_airspeed]);
    EXPECT_EQ(loop.quality().bits(), 0U);
  }
}

TEST(LoopFunctors, ImplausibleTemperatureIsMissing) {
  const Sample recorded{{Quantity::static_pressure, 700.0},
                        {Quantity::dynamic_pressure, 67.6},
                        {Quantity::ambient_temperature, 274.0}};
  for (const double temperature : {-5000.0, 5000.0}) {
    Loop loop = build(Model{}, recorded, 1.0);
    loop.add(make_functor({Quantity::corrected_static_pressure}, {Quantity::ambient_temperature},
                          [=](State<double>& state) { state[Quantity::ambient_temperature] = temperature; }));
    std::string error;
    ASSERT_TRUE(loop.order(&error)) << error;
    run(loop, recorded, 0.0);
    EXPECT_THAT(loop.state()[Quantity::ambient_temperature], IsNan());
    EXPECT_THAT(loop.state()[Quantity::corrected_airspeed], IsNan());
    EXPECT_TRUE(loop.quality().has(Quality::temperature_missing));
  }
}

TEST(Loop, AirspeedNeedsARecordedTemperature) {
  const Sample recorded{{Quantity::static_pressure, 700.0}, {Quantity::dynamic_pressure, 67.6}};
  Loop loop = build(Model{}, recorded, 1.0);
  loop.state()[Quantity::ambient_temperature] = 280.0;
  run(loop, recorded, 0.0);
  EXPECT_THAT(loop.state()[Quantity::corrected_airspeed], IsNan());
  EXPECT_EQ(loop.state()[Quantity::ambient_temperature], 280.0) << "value of the host";
}

TEST(LoopLams, CorrectsAndFlagsValidSamples) {
  Loop with_model = build(c130(), level, 1.0);
  Loop with_lams = build(c130(), level, 1.0, CorrectWith::lams);
  run(with_model, level, 0.0);
  run(with_lams, level, 0.0);
  const State<double>& s = with_lams.state();
  EXPECT_EQ(sample_bits(with_model), 0U);
  EXPECT_EQ(sample_bits(with_lams), bits({Quality::corrected_with_lams}));
  EXPECT_EQ(s[Quantity::static_defect], with_model.state()[Quantity::static_defect]);
  EXPECT_EQ(s[Quantity::lams_static_defect], with_model.state()[Quantity::lams_static_defect]);
  EXPECT_NE(s[Quantity::lams_static_defect], s[Quantity::static_defect]);
  EXPECT_EQ(s[Quantity::corrected_static_pressure], 700.0 + s[Quantity::lams_static_defect]);
  // Approach 4 is an identity: from pressures corrected by this very laser its temperature is the
  // thermometer's.
  EXPECT_NEAR(s[Quantity::lams_temperature], s[Quantity::ambient_temperature], 1e-6);

  const Sample unlocked = with_changes(level, {{Quantity::lams_airspeed, missing}});
  run(with_model, unlocked, 1.0);
  run(with_lams, unlocked, 1.0);
  expect_same(with_lams, with_model);
  EXPECT_EQ(sample_bits(with_lams), bits({Quality::lams_missing}));
}

// Delta-p of a sample depended on the sideslip of the sample before.
TEST(Loop, EffectOnTheAttackRatioReadsTheSideslipOfItsOwnSample) {
  Model model = c130();
  ModelEffect effect;
  effect.id = "of-the-user";
  effect.location = EffectLocation::attack_ratio;
  effect.formula = "c * sideslip";
  effect.parameter_names = {"c"};
  effect.parameters = {0.01};
  model.effects.push_back(effect);
  const Sample turned = with_changes(level, {{Quantity::sideslip_differential_pressure, 20.0}});
  Loop after_another = build(model, level, 1.0), alone = build(model, level, 1.0);
  run(after_another, level, 0.0);
  run(after_another, turned, 1.0);
  run(alone, turned, 1.0);
  EXPECT_EQ(after_another.state()[Quantity::static_defect], alone.state()[Quantity::static_defect]);
  EXPECT_FALSE(std::isnan(alone.state()[Quantity::static_defect]));

  model.effects.back().formula = "c * attack";
  std::vector<Quantity> recorded;
  for (const auto& each : level) recorded.push_back(each.first);
  pcor::BindingError error;
  EXPECT_FALSE(pcor::Chain::build(model, recorded, &error)) << "attack is derived from this ratio";
  EXPECT_EQ(error.code, pcor::BindingError::Code::circular_dependency);
}

TEST(Loop, LaserFilterCanBeOmitted) {
  std::vector<Quantity> recorded;
  for (const auto& each : level) recorded.push_back(each.first);
  std::string error;
  std::optional<Loop> bare =
      Loop::build(c130(), recorded, 1.0, &error, CorrectWith::model, {}, pcor::LaserFilter::without);
  ASSERT_TRUE(bare) << error;
  EXPECT_FALSE(bare->writes(Quantity::filtered_lams_temperature));
  Loop filtered = build(c130(), level, 1.0);
  EXPECT_TRUE(filtered.writes(Quantity::filtered_lams_temperature));
  for (int second = 0; second < 20; ++second) {
    run(*bare, level, second);
    run(filtered, level, second);
  }
  EXPECT_FALSE(std::isnan(filtered.state()[Quantity::filtered_lams_temperature]));
  EXPECT_TRUE(std::isnan(bare->state()[Quantity::filtered_lams_temperature]));
  EXPECT_EQ(bare->state()[Quantity::lams_temperature], filtered.state()[Quantity::lams_temperature]);
  EXPECT_EQ(bare->quality().bits(), filtered.quality().bits());
}

// Delta-p from LAMS needs the humidity, so a humidity may not wait for the pressures that it corrects.
TEST(LoopFunctors, CircularDependencyIsRefused) {
  const auto add_inlet = [](Loop loop, std::string* error) {
    loop.add(make_functor({Quantity::corrected_static_pressure}, {Quantity::vapor_pressure},
                          [](State<double>&) {}));
    return loop.order(error);
  };
  std::string error;
  EXPECT_TRUE(add_inlet(build(c130(), level, 1.0, CorrectWith::model), &error)) << error;
  EXPECT_FALSE(add_inlet(build(c130(), level, 1.0, CorrectWith::lams), &error));
  EXPECT_THAT(error, HasSubstr("'vapor_pressure'"));
}

// A laser without lock shows any speed: beyond a static defect of three tenths of q the model corrects.
TEST(LoopLams, LaserWithoutLockIsReplacedByTheModel) {
  Loop loop = build(c130(), level, 1.0, CorrectWith::lams);
  Loop model = build(c130(), level, 1.0);
  double time = 0.0;
  for (const auto& [speed, is_locked] :
       {std::pair{117.0, true}, {122.0, true}, {60.0, false}, {90.0, false}, {140.0, false}, {117.0, true}}) {
    const Sample sample = with_changes(level, {{Quantity::lams_airspeed, speed}});
    run(loop, sample, time);
    run(model, sample, time);
    time += 1.0;
    EXPECT_EQ(loop.quality().has(Quality::corrected_with_lams), is_locked) << speed;
    EXPECT_EQ(loop.quality().has(Quality::lams_missing), !is_locked) << speed;
    EXPECT_EQ(loop.state()[Quantity::corrected_static_pressure] ==
                  model.state()[Quantity::corrected_static_pressure],
              !is_locked)
        << speed;
    EXPECT_EQ(pcor::is_missing(loop.state()[Quantity::lams_temperature]), !is_locked) << speed;
  }
}

// An iced radome stagnation port makes delta-p of the model tens of hPa wrong; the laser does not use it.
TEST(LoopLams, SoundLaserCorrectsIfTheModelIsWrong) {
  Model model = c130();
  model.sideslip_radome = {};
  const Sample sound = with_changes(level, {{Quantity::attack, 3.0}, {Quantity::sideslip, 0.5}});
  Loop loop = build(model, sound, 1.0, CorrectWith::lams);
  double time = 0.0;
  for (const double radome : {67.1, 8.0, 5.0, 4.0, missing}) {
    SCOPED_TRACE(radome);
    run(loop, with_changes(sound, {{Quantity::radome_dynamic_pressure, radome}}), time++);
    EXPECT_TRUE(loop.quality().has(Quality::corrected_with_lams));
    EXPECT_FALSE(loop.quality().has(Quality::lams_missing));
    // 4 hPa of the laser at 117 m/s.
    EXPECT_NEAR(loop.state()[Quantity::corrected_static_pressure], 704.0, 1.0);
    EXPECT_FALSE(std::isnan(loop.state()[Quantity::lams_temperature]));
  }
}

TEST(LoopLams, UnlockedLaserHasNoResults) {
  for (const CorrectWith source : {CorrectWith::model, CorrectWith::lams}) {
    Loop loop = build(c130(), level, 1.0, source);
    double time = 0.0;
    for (const auto& [speed, is_locked] :
         {std::pair{117.0, true}, {80.0, false}, {90.0, false}, {140.0, false}, {170.0, false}}) {
      SCOPED_TRACE(speed);
      run(loop, with_changes(level, {{Quantity::lams_airspeed, speed}}), time++);
      EXPECT_EQ(loop.quality().has(Quality::lams_missing), !is_locked);
      // Saturation at the temperature of a wrong laser is not a limit of the humidity.
      EXPECT_FALSE(loop.quality().has(Quality::humidity_limited));
      for (const Quantity result : {Quantity::lams_temperature, Quantity::lams_dynamic_pressure})
        EXPECT_EQ(std::isnan(loop.state()[result]), !is_locked) << pcor::info_of(result).name;
    }
    // The temperature from LAMS replaces that of a failed thermometer.
    run(loop, with_changes(level, {{Quantity::recovery_temperature, missing}}), time);
    EXPECT_NEAR(loop.state()[Quantity::lams_temperature], 261.0, 10.0);
    EXPECT_TRUE(loop.quality().has(Quality::lams_missing));
  }
}

TEST(LoopLams, IsRefusedWithoutLaserAirspeed) {
  Sample recorded = level;
  recorded.erase(Quantity::lams_airspeed);
  std::string error;
  EXPECT_FALSE(Loop::build(c130(), roles_of(recorded), 1.0, &error, CorrectWith::lams));
  EXPECT_EQ(error,
            "correction with LAMS needs the role 'lams_airspeed', which is not among the recorded "
            "quantities; add it, in a "
            "model file as a variable in [variables]");
  EXPECT_FALSE(Loop::build(c130(), roles_of(recorded), 1.0, nullptr, CorrectWith::lams));
}

// Approach 3 takes the radiometer's temperature, not the thermometer's that the loop might derive.
TEST(LoopLams, RecordedAmbientIsUsedWithRecovery) {
  Model model = c130();
  model.lams.approach = pcor::LamsApproach::with_temperature;
  Sample radiometer = with_changes(level, {{Quantity::ambient_temperature, 274.0}});
  Loop both = build(model, radiometer, 1.0);
  run(both, radiometer, 0.0);
  EXPECT_EQ(both.state()[Quantity::ambient_temperature], 274.0);
  radiometer.erase(Quantity::recovery_temperature);
  Loop alone = build(model, radiometer, 1.0);
  run(alone, radiometer, 0.0);
  expect_same(both, alone);
}

// At an absurd airspeed all of the total pressure would be dynamic, and the static pressure zero.
TEST(LoopLams, DefectBelowVacuumIsMissing) {
  Model model = c130();
  model.lams.approach = pcor::LamsApproach::with_temperature;
  const Sample radiometer = with_changes(level, {{Quantity::ambient_temperature, 274.0}});
  Loop loop = build(model, radiometer, 1.0, CorrectWith::lams);
  run(loop, with_changes(radiometer, {{Quantity::lams_airspeed, 1e60}}), 0.0);
  EXPECT_THAT(loop.state()[Quantity::lams_static_defect], IsNan());
  EXPECT_EQ(sample_bits(loop), bits({Quality::lams_missing}));
}

struct QualityCase {
  const char* name;
  Sample changes;
  std::uint32_t expected;
  std::vector<Quantity> lost;  // NaN; all other results are finite
};

// Each way in which a sample can be bad, one at a time, in a loop where every stage is at work.
TEST(LoopQuality, BadInputIsFlaggedAndRemovesOnlyDependentResults) {
  using Q = Quality;
  const std::vector<Quantity> with_temperature{Quantity::ambient_temperature, Quantity::corrected_airspeed,
                                               Quantity::lams_dynamic_pressure};
  std::vector<Quantity> all_of_temperature = with_temperature;
  all_of_temperature.push_back(Quantity::lams_static_defect);
  const std::vector<Quantity> of_laser{Quantity::lams_static_defect, Quantity::lams_temperature,
                                       Quantity::lams_dynamic_pressure};
  std::vector<QualityCase> cases{
      {"good", {}, 0, {}},
      {"dry", {{Quantity::vapor_pressure, missing}}, bits({Q::dry_air_assumed}), {}},
      {"negative vapour", {{Quantity::vapor_pressure, -0.1}}, bits({Q::humidity_limited}), {}},
      {"much vapour", {{Quantity::vapor_pressure, 30.0}}, bits({Q::humidity_limited}), {}},
      {"outside",
       {{Quantity::dynamic_pressure, 130.0},
        {Quantity::lams_airspeed, 157.0},
        {Quantity::vapor_pressure, 1.0}},
       bits({Q::outside_domain}),
       {}},
      {"slow", {{Quantity::dynamic_pressure, 30.0}, {Quantity::lams_airspeed, 80.0}}, bits({Q::tapered}), {}},
      {"minimum", {{Quantity::attack_differential_pressure, -40.0}}, bits({Q::minimum_applied}), {}},
      {"no laser", {{Quantity::lams_airspeed, missing}}, bits({Q::lams_missing}), of_laser},
      {"no laser, zero", {{Quantity::lams_airspeed, 0.0}}, bits({Q::lams_missing}), of_laser},
      {"laser of almost nothing", {{Quantity::lams_airspeed, 1e-310}}, bits({Q::lams_missing}), of_laser},
      {"no temperature",
       {{Quantity::recovery_temperature, missing}},
       bits({Q::temperature_missing, Q::lams_missing}),
       all_of_temperature},
      {"impossible temperature",
       {{Quantity::recovery_temperature, -5.0}},
       bits({Q::temperature_missing, Q::lams_missing}),
       all_of_temperature},
      {"zero temperature",
       {{Quantity::recovery_temperature, 0.0}},
       bits({Q::temperature_missing, Q::lams_missing}),
       all_of_temperature},
      {"temperature beyond all thermometers",
       {{Quantity::recovery_temperature, 1e5}},
       bits({Q::temperature_missing, Q::lams_missing}),
       all_of_temperature},
      {"no attack",
       {{Quantity::attack_differential_pressure, missing}},
       bits({Q::effect_input_missing, Q::lams_missing}),
       all_results},
      {"radome blocked",
       {{Quantity::radome_dynamic_pressure, 0.0}},
       bits({Q::effect_input_missing, Q::lams_missing, Q::impossible_radome_pressure}),
       all_results},
      {"no static pressure",
       {{Quantity::static_pressure, missing}},
       bits({Q::static_pressure_missing, Q::lams_missing}),
       all_results},
      {"no dynamic pressure",
       {{Quantity::dynamic_pressure, missing}},
       bits({Q::dynamic_pressure_missing, Q::lams_missing}),
       all_results},
      {"static pressure of a fill value",
       {{Quantity::static_pressure, 1e30}},
       bits({Q::static_pressure_missing, Q::lams_missing}),
       all_results},
      {"static pressure of almost nothing",
       {{Quantity::static_pressure, 1e-40}},
       bits({Q::impossible_static_pressure, Q::lams_missing, Q::dry_air_assumed}),
       all_results},
      {"impossible static pressure",
       {{Quantity::static_pressure, -1.0}},
       bits({Q::impossible_static_pressure, Q::lams_missing}),
       all_results},
  };
  Model model = c130();
  model.policy.taper_below = 40.0;
  model.policy.minimum = -3.0;
  model.domain = {{"dynamic_pressure", 20.0, 120.0}};
  Loop loop = build(model, level, 1.0);
  double time = 0.0;
  for (const QualityCase& test : cases) {
    SCOPED_TRACE(test.name);
    run(loop, with_changes(level, test.changes), ++time);
    EXPECT_EQ(sample_bits(loop), test.expected) << std::hex << sample_bits(loop);
    for (const Quantity result : all_results) {
      const bool lost = std::count(test.lost.begin(), test.lost.end(), result) > 0;
      const double value = loop.state()[result];
      EXPECT_TRUE(lost ? std::isnan(value) : std::isfinite(value))
          << pcor::info_of(result).name << " " << value;
    }
  }
}

TEST(LoopQuality, HasNoAirspeedOnTheGround) {
  Loop strict = build(c130(), level, 1.0);
  Model model = c130();
  model.policy.taper_below = 40.0;
  Loop tapered = build(model, level, 1.0);
  const Sample ground =
      with_changes(level, {{Quantity::dynamic_pressure, -0.3}, {Quantity::radome_dynamic_pressure, -0.1}});
  run(strict, ground, 0.0);
  run(tapered, ground, 0.0);
  for (const Loop* loop : {&strict, &tapered}) {
    EXPECT_TRUE(loop->quality().has(Quality::impossible_dynamic_pressure));
    EXPECT_THAT(loop->state()[Quantity::corrected_mach], IsNan());
    EXPECT_THAT(loop->state()[Quantity::corrected_airspeed], IsNan());
  }
  EXPECT_THAT(strict.state()[Quantity::static_defect], IsNan());
  EXPECT_EQ(tapered.state()[Quantity::static_defect], 0.0);
  EXPECT_EQ(tapered.state()[Quantity::corrected_static_pressure], 700.0);
}

TEST(LoopQuality, FlagsAnEffectThatDividesByZero) {
  const EffectLocation locations[] = {EffectLocation::static_transducer, EffectLocation::static_line,
                                      EffectLocation::total_line,        EffectLocation::pitot,
                                      EffectLocation::static_defect,     EffectLocation::attack,
                                      EffectLocation::recovery};
  for (const EffectLocation location : locations) {
    Model model = c130();
    model.effects.push_back(formula(location, "1 / (static_pressure - 700)"));
    Loop loop = build(model, level, 1.0);
    run(loop, level, 0.0);
    // The angle of attack is of use to LAMS alone here.
    EXPECT_EQ(loop.quality().has(Quality::effect_input_missing), location != EffectLocation::attack)
        << pcor::info_of(location).name;
    EXPECT_TRUE(loop.quality().has(Quality::lams_missing) || location == EffectLocation::static_defect);
    for (const Quantity result : all_results) EXPECT_FALSE(std::isinf(loop.state()[result]));
    EXPECT_THAT(loop.state()[Quantity::corrected_airspeed],
                location == EffectLocation::attack ? Not(IsNan()) : testing::Matcher<double>(IsNan()));
  }
}

TEST(Loop, KeepsTheTotalPressure) {
  std::mt19937 random(18);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (const CorrectWith correct_with : {CorrectWith::model, CorrectWith::lams}) {
    Loop loop = build(c130(), level, 25.0, correct_with);
    for (int i = 0; i < 1000; ++i) {
      const double p = 200.0 + 800.0 * unit(random);
      const double q = 20.0 + 150.0 * unit(random);
      run(loop,
          with_changes(level, {{Quantity::static_pressure, p},
                               {Quantity::dynamic_pressure, q},
                               {Quantity::lams_airspeed, 20.0 + 250.0 * unit(random)}}),
          i / 25.0);
      const double corrected_p = loop.state()[Quantity::corrected_static_pressure];
      const double corrected_q = loop.state()[Quantity::corrected_dynamic_pressure];
      if (loop.quality().has(Quality::impossible_dynamic_pressure)) continue;
      ASSERT_NEAR(corrected_p + corrected_q, p + q, 1e-12 * (p + q));
    }
  }
}

// Random air over the envelope of an aircraft, and the readings of a pressure system with an error delta-p.
// The thermometer errs too: LAMS uses its reading as the truth.
Sample random_flight(bool jet, const pcor::RecoveryFactor& recovery, std::mt19937& random) {
  const auto between = [&random](double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
  };
  const double p = jet ? between(150.0, 850.0) : between(400.0, 1000.0);
  const double temperature = 288.0 * std::pow(p / 1013.0, 0.19) + between(-15.0, 15.0);
  const double humidity = between(0.0, 0.95) * pcor::vapor_pressure_over_water(temperature) / p;
  const pcor::MoistAir<double> air = pcor::moist_air(humidity);
  const double speed =
      jet ? between(0.4, 0.82) * pcor::speed_of_sound(temperature, air) : between(75.0, 150.0);
  const double mach = speed / pcor::speed_of_sound(temperature, air);
  const double q = pcor::dynamic_pressure_from_airspeed(p, speed, temperature, air);
  const double defect = jet ? between(-3.0, 1.0) : between(-2.0, 6.0);
  const double thermometer = temperature + between(-1.0, 1.0);
  return {
      {Quantity::static_pressure, p - defect},
      {Quantity::dynamic_pressure, q + defect},
      {Quantity::recovery_temperature, pcor::recovery_temperature(thermometer, mach, recovery(mach), air)},
      {Quantity::vapor_pressure, humidity * p},
      {Quantity::attack, between(-1.0, 6.0)},
      {Quantity::sideslip, between(-2.0, 2.0)},
      {Quantity::lams_airspeed, speed}};
}

// With the pressures corrected by LAMS sample by sample, the airspeed equals the airspeed of the laser and
// the temperature that of the thermometer, for any values and any calibration of the temperature: memo eq.
// 11 and 12.
TEST(LoopIdentity, LamsReturnsAirspeedAndTemperature) {
  std::mt19937 random(20120106);
  for (const bool jet : {false, true}) {
    for (const bool calibrated : {false, true}) {
      SCOPED_TRACE(testing::Message() << (jet ? "GV" : "C-130") << (calibrated ? ", calibrated" : ""));
      Model model;
      model.effects = {{"static-constant", {0.004}}};
      if (calibrated) model.effects.push_back({"temp-calibration", {0.55, 0.01, -0.0001}});
      model.recovery = {{0.988, 0.053, 0.09, 0.091}};
      model.lams.elevation = 1.5;
      model.lams.azimuth = -0.8;
      Loop loop = build(model, random_flight(jet, model.recovery, random), 25.0, CorrectWith::lams);
      for (int i = 0; i < 5000; ++i) {
        const Sample sample = random_flight(jet, model.recovery, random);
        run(loop, sample, i / 25.0);
        const State<double>& s = loop.state();
        // A thermometer below the truth may imply saturated air.
        ASSERT_EQ(sample_bits(loop) & ~bits({Quality::humidity_limited}),
                  bits({Quality::corrected_with_lams}));
        const double laser =
            sample.at(Quantity::lams_airspeed) /
            pcor::beam_cosine(1.5, -0.8, sample.at(Quantity::attack), sample.at(Quantity::sideslip));
        const double thermometer = s[Quantity::ambient_temperature];
        if (loop.quality().has(Quality::humidity_limited)) continue;
        // One part in 1e9. LAMS stops within 1e-9 hPa of its delta-p, which is 4e-9 K for the C-130.
        ASSERT_NEAR(s[Quantity::corrected_airspeed] / laser, 1.0, 1e-9);
        ASSERT_NEAR(s[Quantity::lams_temperature] / thermometer, 1.0, 1e-9);
      }
    }
  }
}

TEST(Loop, CalibratesARecordedTemperatureOnce) {
  Model model = c130();
  model.lams.approach = pcor::LamsApproach::with_temperature;
  model.effects.push_back({"temp-calibration", {0.55, 0.01, 0.0}});
  model.effects.push_back({"clock-skew", {0.5}});  // needs the rate of the recorded temperature
  Sample sample = level;
  sample.erase(Quantity::recovery_temperature);
  for (const CorrectWith correct_with : {CorrectWith::model, CorrectWith::lams}) {
    Loop loop =
        build(model, with_changes(sample, {{Quantity::ambient_temperature, 270.0}}), 1.0, correct_with);
    for (int i = 0; i < 20; ++i) {
      run(loop, with_changes(sample, {{Quantity::ambient_temperature, 263.15 - 0.5 * i}}), i);
      if (i < 6) continue;
      const double recorded = 263.15 - 0.5 * (i - 6);
      EXPECT_NEAR(loop.state()[Quantity::ambient_temperature], recorded + 0.55 + 0.01 * (recorded - 273.15),
                  1e-12);
      EXPECT_TRUE(std::isfinite(loop.state()[Quantity::lams_static_defect]));
    }
  }
}

TEST(Loop, FiltersTheTemperatureOfLams) {
  for (const double rate : {1.0, 25.0}) {
    Loop loop = build(c130(), level, rate);
    const int delay = static_cast<int>(pcor::LowPass::delay(rate));
    std::vector<double> unfiltered;
    for (int i = 0; i < 4 * delay; ++i) {
      run(loop, with_changes(level, {{Quantity::lams_airspeed, 117.0 + 0.02 * i / rate}}), i / rate);
      unfiltered.push_back(loop.state()[Quantity::lams_temperature]);
      if (i < 2 * delay) continue;
      // The temperature varies with the square of the airspeed: a curve of 2e-5 K/s2, which a filter with a
      // negligible second moment keeps within 1e-3 K.
      EXPECT_NEAR(loop.state()[Quantity::filtered_lams_temperature],
                  unfiltered[static_cast<std::size_t>(i - delay)], 1e-3);
    }
    // After a gap it restarts.
    run(loop, level, 1e5);
    EXPECT_THAT(loop.state()[Quantity::filtered_lams_temperature], IsNan());
  }
}

// An infinite value is not a value: in every role, it invalidates the same results as a NaN, with the same
// bits.
TEST(LoopGarbage, InfinityCountsAsMissing) {
  for (const CorrectWith correct_with : {CorrectWith::model, CorrectWith::lams}) {
    Model model = c130();
    model.policy.taper_below = 40.0;
    model.policy.minimum = -3.0;
    Loop infinite = build(model, level, 1.0, correct_with);
    Loop absent = build(model, level, 1.0, correct_with);
    double time = 0.0;
    for (const auto& [role, value] : level) {
      for (const double garbage : {infinity, -infinity}) {
        SCOPED_TRACE(testing::Message() << pcor::info_of(role).name << " = " << garbage);
        run(infinite, with_changes(level, {{role, garbage}}), ++time);
        run(absent, with_changes(level, {{role, missing}}), time);
        expect_same(infinite, absent);
        EXPECT_NE(infinite.quality().bits(), 0U);
        for (const Quantity result : all_results) EXPECT_FALSE(std::isinf(infinite.state()[result]));
      }
    }
  }
}

TEST(LoopGarbage, InfinityCountsAsMissingInOtherRoles) {
  for (const auto& [role, good] : Sample{{Quantity::dew_point, 270.0},
                                         {Quantity::ambient_temperature, 274.0},
                                         {Quantity::attack, 3.0},
                                         {Quantity::sideslip, 0.5},
                                         {Quantity::mach, 0.37}}) {
    Sample recorded = with_changes(level, {{role, good}});
    if (role == Quantity::dew_point) recorded.erase(Quantity::vapor_pressure);
    if (role == Quantity::ambient_temperature) recorded.erase(Quantity::lams_airspeed);
    Model model = c130();
    model.effects.push_back({"static-mach2", {0.01}});
    Loop infinite = build(model, recorded, 1.0);
    Loop absent = build(model, recorded, 1.0);
    SCOPED_TRACE(pcor::info_of(role).name);
    run(infinite, with_changes(recorded, {{role, infinity}}), 0.0);
    run(absent, with_changes(recorded, {{role, missing}}), 0.0);
    expect_same(infinite, absent);
    EXPECT_NE(infinite.quality().bits(), 0U);
  }
}

double garbage(std::mt19937& random, double good) {
  const double values[] = {missing, infinity, -infinity, 0.0,   -0.0,  -1.0,   -good,
                           1e300,   -1e300,   1e-300,    1e30,  -1e30, good,   good,
                           good,    good,     -32767.0,  1e-40, 1e10,  273.15, good * 1.5};
  return values[random() % std::size(values)];
}

std::string text(const Sample& sample) {
  std::ostringstream text;
  for (const auto& [role, value] : sample) text << "\n  " << pcor::info_of(role).name << " = " << value;
  return text.str();
}

// No effect of a bad sample remains: after any number of them a good sample gives the result of a new loop.
TEST(LoopGarbage, DoesNotAffectTheNextSample) {
  std::mt19937 random(20111102);
  std::vector<Model> models(4, c130());
  models[1].lams.approach = pcor::LamsApproach::iterated;
  models[1].policy.taper_below = 40.0;
  models[2].effects.push_back({"static-mach2", {0.01}});
  models[2].effects.push_back(formula(EffectLocation::static_defect, "sqrt(dynamic_ratio) * log(mach)"));
  models[2].policy.minimum = -3.0;
  models[3].moist = false;
  models[3].recovery = {{0.9959, 0.0283, 0.0374, 0.0762}};
  for (const Model& model : models) {
    for (const CorrectWith correct_with : {CorrectWith::model, CorrectWith::lams}) {
      Loop fresh = build(model, level, 25.0, correct_with);
      run(fresh, level, 0.0);
      ASSERT_TRUE(std::isfinite(fresh.state()[Quantity::corrected_airspeed]));
      Loop loop = build(model, level, 25.0, correct_with);
      int time = 0;
      for (int i = 0; i < 2000; ++i) {
        for (std::size_t j = random() % 5; j > 0; --j) {
          Sample bad = level;
          for (auto& [role, value] : bad) value = garbage(random, value);
          run(loop, bad, ++time / 25.0);
          for (const Quantity result : all_results) {
            if (!std::isnan(loop.state()[result])) continue;
            ASSERT_NE(loop.quality().bits(), 0U)
                << pcor::info_of(result).name << " lost without a word:" << text(bad);
          }
        }
        run(loop, level, ++time / 25.0);
        expect_same(loop, fresh);
        if (HasFailure()) return;
      }
    }
  }
}

// A dropout of 0 hPa is impossible like a missing value: the rates of its neighbours do not use it.
TEST(LoopGarbage, ImpossiblePressureDoesNotAffectTheRatesOfItsNeighbours) {
  const struct {
    const char* lag;
    Quantity role;
    double value;
  } cases[] = {{"static-lag", Quantity::static_pressure, 0.0},
               {"static-lag", Quantity::static_pressure, -3.0},
               {"qcf-lag", Quantity::dynamic_pressure, -1999.0}};
  for (const auto& each : cases) {
    Model model;
    model.effects = {{each.lag, {0.15}}};
    const Sample cruise{{Quantity::static_pressure, 700.0}, {Quantity::dynamic_pressure, 70.0}};
    for (const double rate : {1.0, 25.0}) {
      Loop loop = build(model, cruise, rate);
      constexpr int bad = 300;
      for (int i = 0; i < 600; ++i) {
        run(loop, i == bad ? with_changes(cruise, {{each.role, each.value}}) : cruise, i / rate);
        if (std::abs(loop.state()[Quantity::time] * rate - bad) < 0.5) continue;
        if (loop.quality().has(Quality::awaiting_later_samples)) continue;
        EXPECT_NEAR(loop.state()[Quantity::port_static_pressure], 700.0, 1e-9) << each.lag << " " << i;
        EXPECT_NEAR(loop.state()[Quantity::port_dynamic_pressure], 70.0, 1e-9) << each.lag << " " << i;
      }
    }
  }
}

TEST(LoopGarbage, ImplausibleLiquidWaterGivesNoTemperature) {
  Model model;
  model.effects = {{"temp-wetting", {-2.0, 10.0}}};
  model.recovery = {{0.95}};
  const Sample cruise{{Quantity::static_pressure, 700.0},
                      {Quantity::dynamic_pressure, 70.0},
                      {Quantity::recovery_temperature, 280.0},
                      {Quantity::liquid_water, 0.0}};
  for (const double water : {-32767.0, 99999.0, infinity, missing}) {
    Loop loop = build(model, cruise, 1.0);
    run(loop, cruise, 0.0);
    EXPECT_FALSE(std::isnan(loop.state()[Quantity::ambient_temperature]));
    run(loop, with_changes(cruise, {{Quantity::liquid_water, water}}), 1.0);
    EXPECT_THAT(loop.state()[Quantity::ambient_temperature], IsNan()) << water;
    EXPECT_TRUE(loop.quality().has(Quality::temperature_missing)) << water;
  }
}

// With rates of change only the bad sample is lost.
TEST(LoopGarbage, LagLosesOnlyTheBadSample) {
  Model model = c130();
  model.effects.push_back({"static-lag", {0.15}});
  for (const double garbage : {missing, infinity, -infinity}) {
    Loop loop = build(model, level, 25.0);
    const auto delay = static_cast<int>(loop.delay());
    for (int i = 0; i < 3 * delay; ++i) {
      const bool is_bad = i == 100;
      run(loop, is_bad ? with_changes(level, {{Quantity::static_pressure, garbage}}) : level, i / 25.0);
      if (i < delay) continue;
      const bool leaves = i == 100 + delay;
      EXPECT_EQ(loop.quality().has(Quality::static_pressure_missing), leaves);
      EXPECT_EQ(std::isnan(loop.state()[Quantity::corrected_static_pressure]), leaves) << i;
    }
  }
}

}  // namespace
