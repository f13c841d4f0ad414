// The uncertainties of results against differences of the chain itself, and what they do in a loop.
#include <pcor/realtime/result_uncertainty.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <pcor/realtime/loop.hpp>
#include "support/test_name.hpp"

namespace pcor {
namespace {

using testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

using Recorded = std::map<Quantity, double>;

// A climbing, slipping aircraft near the ground in moist air, so that every effect is felt.
Recorded everything_recorded() {
  return {{Quantity::static_pressure, 700.0},
          {Quantity::dynamic_pressure, 80.0},
          {Quantity::recovery_temperature, 280.0},
          {Quantity::vapor_pressure, 3.0},
          {Quantity::radome_dynamic_pressure, 79.0},
          {Quantity::attack_differential_pressure, -18.0},
          {Quantity::sideslip_differential_pressure, 4.0},
          {Quantity::attack, 3.0},
          {Quantity::sideslip, 2.0},
          {Quantity::lams_airspeed, 130.0},
          {Quantity::true_airspeed, 131.0},
          {Quantity::altitude, 3000.0},
          {Quantity::vertical_speed, 5.0},
          {Quantity::latitude, 40.0},
          {Quantity::pitch, 4.0},
          {Quantity::roll, 20.0},
          {Quantity::heading, 90.0},
          {Quantity::ground_speed, 135.0},
          {Quantity::ground_track, 92.0},
          {Quantity::normal_acceleration, 2.0},
          {Quantity::longitudinal_acceleration, 0.5},
          {Quantity::flaps, 4.0},
          {Quantity::engine_torque, 60.0},
          {Quantity::height_above_ground, 20.0},
          {Quantity::liquid_water, 0.2},
          {Quantity::transducer_temperature, 300.0},
          {Quantity::cabin_pressure, 850.0},
          {Quantity::date, 4323.5},
          {Quantity::static_pressure_rate, -0.5},
          {Quantity::dynamic_pressure_rate, 0.3},
          {Quantity::recovery_temperature_rate, -0.03},
          {Quantity::airspeed_rate, 0.4}};
}

Recorded without(Recorded recorded, std::initializer_list<Quantity> excluded) {
  for (const Quantity quantity : excluded) recorded.erase(quantity);
  return recorded;
}

std::vector<Quantity> roles(const Recorded& recorded) {
  std::vector<Quantity> result;
  for (const auto& [quantity, value] : recorded) result.push_back(quantity);
  return result;
}

/// The state after one sample at 1800 s, and the uncertainties where some are stated.
State<double> fly(const Model& model, const Recorded& recorded, const ModelUncertainty& uncertainty = {}) {
  std::string error;
  std::optional<Loop> loop =
      Loop::build(model, roles(recorded), 1.0, &error, CorrectWith::model, uncertainty);
  if (!loop) throw std::runtime_error(error);
  for (const auto& [quantity, value] : recorded) loop->state()[quantity] = value;
  loop->run(1800.0);
  return loop->state();
}

ModelEffect typical(const EffectInfo& info) {
  ModelEffect effect{std::string(info.id), {}};
  for (std::size_t i = 0; i < info.parameter_count(); ++i)
    effect.parameters.push_back(info.parameters[i].typical);
  return effect;
}

/// The published law that an effect joins: it reads what most effects change.
Model law() {
  Model model;
  model.effects = {{"static-constant", {0.004}}, {"static-alpha", {0.021}},      {"static-qp", {0.03}},
                   {"static-attack", {0.001}},   {"static-beta-even", {0.0001}}, {"static-mach3", {-0.02}}};
  model.recovery = {{0.97, 0.0, 0.0, 0.0}};
  model.attack_radome = {5.776, 15.031, 0.0};
  model.sideslip_radome = {-0.012, 12.2, 1.0};
  return model;
}

double& parameter_at(Model& model, std::size_t position) {
  for (ModelEffect& effect : model.effects) {
    if (position < effect.parameters.size()) return effect.parameters[position];
    position -= effect.parameters.size();
  }
  throw std::out_of_range("no such parameter");
}

std::size_t parameter_count(const Model& model) {
  std::size_t count = 0;
  for (const ModelEffect& effect : model.effects) count += effect.parameters.size();
  return count;
}

ModelUncertainty of_parameter(const Model& model, std::size_t position, double size) {
  const std::size_t count = parameter_count(model);
  ModelUncertainty uncertainty;
  uncertainty.covariance.assign(count * count, 0.0);
  uncertainty.covariance[position * count + position] = size * size;
  return uncertainty;
}

/// Effect on each result of a change by `size` up and down, by the chain alone, in addition to the stated
/// one.
void expect_stated(const State<double>& stated, const State<double>& above, const State<double>& below,
                   const std::string& what) {
  for (const UncertainResult& each : uncertain_results) {
    const double difference = std::abs(above[each.result] - below[each.result]) / 2.0;
    // Dry constants are within 2 %. Omitted: effect of the calibration of the temperature, 0.5 K here, on an
    // effect at that temperature: 3e-4 K.
    EXPECT_NEAR(stated[each.uncertainty], difference, 0.02 * difference + 3e-4)
        << what << ": " << info_of(each.result).name;
  }
}

class EffectUncertainty : public testing::TestWithParam<EffectInfo> {};

TEST_P(EffectUncertainty, EqualsTheFiniteDifferenceByItsCoefficient) {
  const EffectInfo& info = GetParam();
  const Recorded all = everything_recorded();
  for (const Recorded& recorded :
       {all, without(all, {Quantity::attack, Quantity::sideslip, Quantity::lams_airspeed})}) {
    Model model = law();
    for (const ModelEffect& effect : model.effects) {
      if (effect.id == info.id) model.effects = {};
    }
    model.effects.push_back(typical(info));
    model.moist = info.constants != GasConstants::dry;
    const std::size_t first = parameter_count(model) - info.parameter_count();
    for (std::size_t i = 0; i < info.parameter_count(); ++i) {
      const double typical_size = 0.1 * std::abs(info.parameters[i].typical);
      const double size =
          typical_size > 0.0 ? typical_size : 0.5;  // shape parameter whose usual value is zero
      Model above = model;
      parameter_at(above, first + i) += size;
      Model below = model;
      parameter_at(below, first + i) -= size;
      expect_stated(fly(model, recorded, of_parameter(model, first + i, size)), fly(above, recorded),
                    fly(below, recorded), std::string(info.id) + '.' + std::string(info.parameters[i].name));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EffectUncertainty, testing::ValuesIn(effect_info),
                         [](const auto& effect) { return test::test_name(effect.param.id); });

// The gain multiplies the ratio as recorded. Taken at the corrected ratio, the uncertainty was 30 % too
// small.
TEST(ResultUncertainty, GainOfTheAttackRatioActsOnTheRecordedRatio) {
  constexpr double size = 0.03;
  const auto with_gain = [](double gain) {
    Model model = law();
    model.effects.push_back({"adif-drift", {gain, 0.0, 0.0}});
    return model;
  };
  const Model model = with_gain(0.3);
  const Recorded recorded =
      without(everything_recorded(), {Quantity::attack, Quantity::sideslip, Quantity::lams_airspeed});
  expect_stated(fly(model, recorded, of_parameter(model, parameter_count(law()), size)),
                fly(with_gain(0.3 + size), recorded), fly(with_gain(0.3 - size), recorded), "gain");
}

TEST(ResultUncertainty, RoleUncertaintyEqualsTheFiniteDifference) {
  Model model = law();
  model.effects.push_back({"pitot-angle", {0.0001, 0.0}});
  for (const auto& [role, size] : std::map<Quantity, double>{{Quantity::static_pressure, 0.1},
                                                             {Quantity::dynamic_pressure, 0.1},
                                                             {Quantity::radome_dynamic_pressure, 0.1},
                                                             {Quantity::attack_differential_pressure, 0.1},
                                                             {Quantity::sideslip_differential_pressure, 0.1},
                                                             {Quantity::recovery_temperature, 0.1},
                                                             {Quantity::vapor_pressure, 0.2}}) {
    const Recorded recorded =
        without(everything_recorded(), {Quantity::attack, Quantity::sideslip, Quantity::lams_airspeed});
    ModelUncertainty uncertainty;
    uncertainty.random[index(role)] = size;
    Recorded above = recorded;
    above[role] += size;
    Recorded below = recorded;
    below[role] -= size;
    expect_stated(fly(model, recorded, uncertainty), fly(model, above), fly(model, below),
                  std::string(info_of(role).name));
  }
}

TEST(ResultUncertainty, DewPointAndAmbientTemperatureUncertaintiesPropagate) {
  Recorded recorded =
      without(everything_recorded(), {Quantity::vapor_pressure, Quantity::recovery_temperature,
                                      Quantity::recovery_temperature_rate, Quantity::lams_airspeed});
  recorded[Quantity::ambient_temperature] = 270.0;
  recorded[Quantity::dew_point] = 264.0;
  for (const Quantity role : {Quantity::ambient_temperature, Quantity::dew_point}) {
    ModelUncertainty uncertainty;
    uncertainty.random[index(role)] = 1.0;
    Recorded above = recorded;
    above[role] += 1.0;
    Recorded below = recorded;
    below[role] -= 1.0;
    const State<double> stated = fly(law(), recorded, uncertainty);
    const double airspeed = std::abs(fly(law(), above)[Quantity::corrected_airspeed] -
                                     fly(law(), below)[Quantity::corrected_airspeed]) /
                            2.0;
    // The slope of saturation is that of Magnus, within 2 %.
    EXPECT_NEAR(stated[Quantity::corrected_airspeed_uncertainty], airspeed, 0.03 * airspeed);
    const double temperature = role == Quantity::ambient_temperature ? 1.0 : 0.0;
    EXPECT_NEAR(stated[Quantity::ambient_temperature_uncertainty], temperature, 1e-12);
  }
}

TEST(ResultUncertainty, TaperAndMinimumKeepLawUncertainty) {
  Model model = law();
  model.policy.taper_below = 100.0;
  const Recorded recorded = everything_recorded();
  const auto of_constant = [&recorded](const Model& of) {
    return fly(of, recorded, of_parameter(of, 0, 1e-4))[Quantity::static_defect_uncertainty];
  };
  EXPECT_NEAR(of_constant(model), 1e-4 * 700.0 * 0.8 * 0.8 * 0.8, 1e-12);
  model.policy = {};
  EXPECT_NEAR(of_constant(model), 1e-4 * 700.0, 1e-12);
  model.policy.minimum = 50.0;
  EXPECT_NEAR(of_constant(model), 1e-4 * 700.0, 1e-12) << "the limit is not known better than the law";
}

TEST(ResultUncertainty, IsMissingOutsideTheDomainOfTheLaw) {
  Model model = law();
  const Recorded recorded = everything_recorded();
  const ModelUncertainty uncertainty = of_parameter(model, 0, 1e-4);
  model.domain = {{"dynamic_pressure", 20.0, 79.0}};
  const State<double> outside = fly(model, recorded, uncertainty);
  model.domain = {{"dynamic_pressure", 20.0, 81.0}};
  const State<double> inside = fly(model, recorded, uncertainty);
  for (const UncertainResult& each : uncertain_results) {
    EXPECT_EQ(outside[each.result], inside[each.result]) << info_of(each.result).name;
    EXPECT_TRUE(std::isnan(outside[each.uncertainty])) << info_of(each.result).name;
    EXPECT_FALSE(std::isnan(inside[each.uncertainty])) << info_of(each.result).name;
  }
}

TEST(ResultUncertainty, TaperDependsOnTheDynamicPressure) {
  Model model;
  model.effects = {{"static-constant", {0.02}}};
  model.policy.taper_below = 100.0;
  const Recorded recorded{{Quantity::static_pressure, 700.0}, {Quantity::dynamic_pressure, 70.0}};
  ModelUncertainty uncertainty;
  uncertainty.random[index(Quantity::dynamic_pressure)] = 0.5;
  const State<double> s = fly(model, recorded, uncertainty);
  // d(14 (q/100)^3)/dq = 0.2058 at 70 hPa; the difference over 0.5 hPa is accurate to (0.5/70)^2/3.
  EXPECT_NEAR(s[Quantity::static_defect_uncertainty], 0.5 * 0.2058, 1e-5);
  EXPECT_NEAR(s[Quantity::corrected_dynamic_pressure_uncertainty], 0.5 * (1.0 - 0.2058), 1e-5);
}

TEST(ResultUncertainty, VapourIsIrrelevantToAModelOfDryAir) {
  Model model;
  model.recovery = {{0.95}};
  model.moist = false;
  ModelUncertainty uncertainty;
  uncertainty.random[index(Quantity::vapor_pressure)] = 2.0;
  const State<double> s = fly(model, without(everything_recorded(), {Quantity::lams_airspeed}), uncertainty);
  EXPECT_EQ(s[Quantity::corrected_airspeed_uncertainty], 0.0);
  EXPECT_EQ(s[Quantity::ambient_temperature_uncertainty], 0.0);
}

// The lag multiplies the rate of change, and with it the noise that the filter of the rate passes.
TEST(ResultUncertainty, LagAmplifiesTheNoiseOfItsSensor) {
  const Recorded level{{Quantity::static_pressure, 700.0},
                       {Quantity::dynamic_pressure, 70.0},
                       {Quantity::recovery_temperature, 285.0}};
  struct Case {
    ModelEffect lag;
    Quantity role;
    Quantity result;
    Quantity uncertainty;
  };
  for (const Case& each : {Case{{"temp-lag", {2.3}},
                                Quantity::recovery_temperature,
                                Quantity::ambient_temperature,
                                Quantity::ambient_temperature_uncertainty},
                           Case{{"static-lag", {0.15}},
                                Quantity::static_pressure,
                                Quantity::corrected_static_pressure,
                                Quantity::corrected_static_pressure_uncertainty}}) {
    Model model;
    model.recovery = {{0.95}};
    model.effects = {each.lag};
    ModelUncertainty uncertainty;
    uncertainty.random[index(each.role)] = 0.1;
    std::string error;
    auto loop = Loop::build(model, roles(level), 1.0, &error, CorrectWith::model, uncertainty);
    ASSERT_TRUE(loop) << error;
    std::mt19937_64 engine(1);
    std::normal_distribution<double> noise(0.0, 0.1);
    constexpr int count = 20000;
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < count; ++i) {
      for (const auto& [quantity, value] : level) loop->state()[quantity] = value;
      loop->state()[each.role] += noise(engine);
      loop->run(i);
      if (i < 100) continue;
      sum += loop->state()[each.result];
      squares += loop->state()[each.result] * loop->state()[each.result];
    }
    const double mean = sum / (count - 100);
    const double scatter = std::sqrt(squares / (count - 100) - mean * mean);
    // 20,000 samples determine a standard deviation to 0.5 %; the sensitivities are accurate to 2 %.
    EXPECT_NEAR(loop->state()[each.uncertainty], scatter, 0.03 * scatter) << each.lag.id;
    EXPECT_GT(scatter, 0.1 * (each.lag.id == "temp-lag" ? 3.0 : 1.0));
  }
}

TEST(ResultUncertainty, TemperatureUncertaintyOnRampIsThatOfTheThermometer) {
  Model model = law();
  model.policy.taper_below = 40.0;
  Recorded recorded = everything_recorded();
  recorded[Quantity::dynamic_pressure] = 0.5;
  ModelUncertainty uncertainty;
  uncertainty.random[index(Quantity::recovery_temperature)] = 0.1;
  const State<double> s = fly(model, recorded, uncertainty);
  EXPECT_NEAR(s[Quantity::ambient_temperature_uncertainty], 0.1, 1e-4);
  EXPECT_TRUE(std::isnan(s[Quantity::corrected_airspeed_uncertainty]));
}

// Two errors of delta-p that are the same one add up, or cancel.
TEST(ResultUncertainty, IncludesCorrelations) {
  Model model;
  model.effects = {{"static-constant", {0.004}}, {"psfd-bias", {0.0}}};
  const Recorded recorded = everything_recorded();
  for (const double correlation : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    ModelUncertainty uncertainty;
    const double a = 1e-4, b = 0.05;
    uncertainty.covariance = {a * a, correlation * a * b, correlation * a * b, b * b};
    const State<double> s = fly(model, recorded, uncertainty);
    const double of_law = 1e-4 * 700.0;
    EXPECT_NEAR(s[Quantity::static_defect_uncertainty], of_law, 1e-9);
    EXPECT_NEAR(s[Quantity::corrected_dynamic_pressure_uncertainty], of_law, 1e-9);
    EXPECT_NEAR(s[Quantity::corrected_static_pressure_uncertainty],
                std::sqrt(of_law * of_law + b * b - 2.0 * correlation * of_law * b), 1e-9)
        << "a bias is removed";
  }
}

TEST(ResultUncertainty, CovarianceRootScalesUncertainty) {
  const Model model = law();
  ModelUncertainty once = of_parameter(model, 1, 0.001);
  once.random[index(Quantity::dynamic_pressure)] = 0.05;
  once.static_defect = 0.2;
  ModelUncertainty twice = of_parameter(model, 1, 0.002);
  twice.random[index(Quantity::dynamic_pressure)] = 0.1;
  twice.static_defect = 0.4;
  ModelUncertainty other_role;  // role without influence on delta-p or pressures
  other_role.random[index(Quantity::recovery_temperature)] = 0.1;
  const State<double> a = fly(model, everything_recorded(), once);
  const State<double> b = fly(model, everything_recorded(), twice);
  const State<double> c = fly(model, everything_recorded(), other_role);
  for (const UncertainResult& each : uncertain_results)
    EXPECT_NEAR(b[each.uncertainty] / a[each.uncertainty], 2.0, 1e-4);
  EXPECT_EQ(c[Quantity::static_defect_uncertainty], 0.0);
  EXPECT_EQ(c[Quantity::corrected_static_pressure_uncertainty], 0.0);
}

TEST(ResultUncertainty, RandomAndSystematicPartsGiveTheTotal) {
  const Model model = law();
  ModelUncertainty whole = of_parameter(model, 1, 0.001);
  whole.random[index(Quantity::recovery_temperature)] = 0.2;
  whole.static_defect_ratio = 0.00045;
  const State<double> all = fly(model, everything_recorded(), whole);
  const State<double> systematic = fly(model, everything_recorded(), whole.systematic_part());
  const State<double> random = fly(model, everything_recorded(), whole.random_part());
  for (const UncertainResult& each : uncertain_results) {
    EXPECT_NEAR(all[each.uncertainty], std::hypot(systematic[each.uncertainty], random[each.uncertainty]),
                1e-9);
  }
  EXPECT_NEAR(random[Quantity::static_defect_uncertainty], 0.00045 * 700.0, 1e-12);
}

// A loop at 25 Hz through missing values, the ramp, and LAMS.
class InALoop : public testing::Test {
 protected:
  void build(CorrectWith with) {
    Model model = law();
    model.lams.elevation = 1.5;
    ModelUncertainty uncertainty = of_parameter(model, 0, 1e-4);
    uncertainty.random[index(Quantity::recovery_temperature)] = 0.1;
    std::string error;
    loop_ = Loop::build(model, roles(recorded_), 25.0, &error, with, uncertainty);
    ASSERT_TRUE(loop_) << error;
  }

  const State<double>& run(Quantity changed = Quantity::count, double to = nan) {
    for (const auto& [quantity, value] : recorded_) loop_->state()[quantity] = value;
    if (changed != Quantity::count) loop_->state()[changed] = to;
    loop_->run(time_ += 0.04);
    return loop_->state();
  }

  Recorded recorded_ = everything_recorded();
  std::optional<Loop> loop_;
  double time_ = 0.0;
};

TEST_F(InALoop, IsMissingExactlyWhereItsResultIsMissing) {
  build(CorrectWith::model);
  for (int second = 0; second < 3; ++second) {
    for (const auto& [quantity, to] : {std::pair{Quantity::static_pressure, nan},
                                       {Quantity::dynamic_pressure, nan},
                                       {Quantity::dynamic_pressure, 0.3},
                                       {Quantity::recovery_temperature, nan},
                                       {Quantity::attack_differential_pressure, nan},
                                       {Quantity::attack, nan}}) {
      for (const UncertainResult& each : uncertain_results) {
        run(quantity, to);
        EXPECT_EQ(std::isnan(loop_->state()[each.uncertainty]), std::isnan(loop_->state()[each.result]))
            << info_of(quantity).name << ' ' << to << ": " << info_of(each.result).name;
        EXPECT_GT(run()[each.uncertainty], 0.0) << "the sample after";
      }
    }
    time_ += 1.0;  // a gap
  }
}

TEST_F(InALoop, UncertaintyIsUpdatedWithPressures) {
  build(CorrectWith::model);
  EXPECT_NEAR(run()[Quantity::static_defect_uncertainty], 0.07, 1e-12);
  EXPECT_NEAR(run(Quantity::static_pressure, 690.0)[Quantity::static_defect_uncertainty], 0.07, 1e-12)
      << "1.4 % of an uncertainty";
  EXPECT_NEAR(run(Quantity::static_pressure, 600.0)[Quantity::static_defect_uncertainty], 0.06, 1e-12);
}

TEST_F(InALoop, LaserCorrectedResultsHaveNoUncertainty) {
  build(CorrectWith::lams);
  run();
  ASSERT_TRUE(loop_->quality().has(Quality::corrected_with_lams));
  EXPECT_GT(loop_->state()[Quantity::static_defect_uncertainty], 0.0);
  for (std::size_t i = 1; i < uncertain_results.size(); ++i)
    EXPECT_TRUE(std::isnan(loop_->state()[uncertain_results[i].uncertainty])) << i;
  run(Quantity::lams_airspeed);
  for (const UncertainResult& each : uncertain_results) EXPECT_GT(loop_->state()[each.uncertainty], 0.0);
}

TEST(ResultUncertainty, CovarianceOfWrongSizeIsRefused) {
  const auto error_of = [](const std::vector<double>& covariance) {
    Model model;
    model.effects = {{"static-constant", {0.004}}, {"static-qp", {0.03}}};
    ModelUncertainty uncertainty;
    uncertainty.covariance = covariance;
    std::string error = "no error";
    Loop::build(model, {Quantity::static_pressure, Quantity::dynamic_pressure}, 1.0, &error,
                CorrectWith::model, uncertainty);
    return error;
  };
  EXPECT_THAT(error_of({1e-8}), HasSubstr("not of this model, which has 2 parameter(s)"));
  EXPECT_THAT(error_of({1e-8, 2e-8, 2e-8, 1e-8}), HasSubstr("negative variance"));
  EXPECT_EQ(error_of({1e-8, 1e-8, 1e-8, 1e-8}), "no error");
}

TEST(Covariance, InvalidMatrixIsRefused) {
  EXPECT_TRUE(is_covariance({}, 0));
  EXPECT_TRUE(is_covariance({0.0}, 1));
  EXPECT_FALSE(is_covariance({-1.0}, 1));
  EXPECT_FALSE(is_covariance({nan}, 1));
  EXPECT_FALSE(is_covariance({std::numeric_limits<double>::infinity()}, 1));
  EXPECT_FALSE(is_covariance({1.0, nan, nan, 1.0}, 2));
  EXPECT_FALSE(is_covariance({1.0, 0.9, -0.9, 1.0}, 2)) << "not symmetric";
  EXPECT_FALSE(is_covariance({0.0, 1e-3, 1e-3, 1.0}, 2)) << "what is known exactly varies with nothing";
  // Three variables, each pair with correlation c, exist for c >= -1/2 only; each pair alone always does.
  for (const double c : {-0.51, -0.5, 0.0, 0.9, 1.0}) {
    const std::vector<double> scaled{1.0,      c * 1e-4, c * 1e3,  c * 1e-4, 1e-8,
                                     c * 1e-1, c * 1e3,  c * 1e-1, 1e6};
    EXPECT_EQ(is_covariance(scaled, 3), c >= -0.5) << c;
  }
  // A sum of two: its covariance is singular, and written with seven digits.
  EXPECT_TRUE(is_covariance({1.0, 0.0, 0.7071068, 0.0, 1.0, 0.7071068, 0.7071068, 0.7071068, 1.0}, 3));
}

TEST(Covariance, SquareOfTheRootIsTheMatrix) {
  const auto error_of_root = [](const std::vector<double>& matrix, std::size_t size) {
    const auto root = covariance_root(matrix, size);
    EXPECT_TRUE(root);
    double error = 0.0;
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t j = 0; j < size; ++j) {
        double sum = 0.0;
        for (const std::vector<double>& change : *root) sum += change[i] * change[j];
        const double scale = std::sqrt(matrix[i * size + i] * matrix[j * size + j]);
        error = std::max(error, std::abs(sum - matrix[i * size + j]) / scale);
      }
    }
    return error;
  };
  // Rounding of sums of three products.
  EXPECT_LT(error_of_root({4.0, 2e-3, -1e3, 2e-3, 9e-6, 0.1, -1e3, 0.1, 1e6}, 3), 1e-15);
  // One error three times: its rounded correlations are of no covariance, so they return within the rounding.
  const double c = 1.0 - 1e-9, r = 1.0 - 5e-7;
  for (const auto& [a, b, d] : {std::array{r, 1.0, c}, {1.0, r, c}, {c, r, 1.0}, {r, c, 1.0}, {1.0, c, r}})
    EXPECT_LT(error_of_root({1.0, a, b, a, 1.0, d, b, d, 1.0}, 3), 1e-6);
}

}  // namespace
}  // namespace pcor
