// The uncertainties of results against the scatter of drawn errors, published sensitivities and derivatives
// in closed form, and what they do in a loop.
#include <pcor/realtime/result_uncertainty.hpp>

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <pcor/realtime/loop.hpp>
#include "realtime/sample.hpp"
#include "support/constants.hpp"
#include "support/test_name.hpp"

namespace pcor {
namespace {

using test::missing;
using test::roles_of;
using testing::HasSubstr;

using Recorded = test::Sample;

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

Recorded without_roles(Recorded recorded, std::initializer_list<Quantity> excluded) {
  for (const Quantity quantity : excluded) recorded.erase(quantity);
  return recorded;
}

/// The state after one sample at 1800 s, and the uncertainties where some are stated.
State<double> state_of(const Model& model, const Recorded& recorded,
                       const ModelUncertainty& uncertainty = {}) {
  std::string error;
  std::optional<Loop> loop =
      Loop::build(model, roles_of(recorded), 1.0, &error, CorrectWith::model, uncertainty);
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

/// Standard deviation of each result over 4000 samples with drawn errors: accurate to 1.1 %.
/// @param draw sets the errors of a state before the chain runs, and of its coefficients
template <class Draw>
std::array<double, uncertain_results.size()> scatter(const Model& model, const Recorded& recorded,
                                                     Draw draw) {
  const std::optional<Chain> chain = Chain::build(model, roles_of(recorded), nullptr);
  State<double> inputs;
  for (const auto& [quantity, value] : recorded) inputs[quantity] = value;
  inputs[Quantity::time] = 1800.0;
  inputs[Quantity::wetness] = state_of(model, recorded)[Quantity::wetness];
  std::mt19937_64 engine(1);
  constexpr int count = 4000;
  std::array<double, uncertain_results.size()> first{}, sum{}, squares{};
  for (int i = 0; i < count; ++i) {
    State<double> state = inputs;
    std::vector<double> parameters = chain->parameters();
    if (i > 0) draw(engine, state, parameters);
    NoQualityFlags flags;
    chain->correct_inputs(state, parameters.data(), flags);
    state[Quantity::static_defect] = chain->static_defect(state, parameters.data(), flags);
    chain->correct(state, state[Quantity::static_defect], flags);
    chain->air(state, parameters.data(), flags);
    for (std::size_t k = 0; k < first.size(); ++k) {
      const double result = state[uncertain_results[k].result];
      if (i == 0) first[k] = result;
      sum[k] += result - first[k];
      squares[k] += (result - first[k]) * (result - first[k]);
    }
  }
  for (std::size_t k = 0; k < first.size(); ++k)
    squares[k] = std::sqrt(std::max(0.0, squares[k] / count - sum[k] / count * sum[k] / count));
  return squares;
}

double normal(std::mt19937_64& engine) { return std::normal_distribution<double>()(engine); }

void expect_scatter(const State<double>& stated, const std::array<double, uncertain_results.size()>& scatter,
                    const std::string& what) {
  for (std::size_t k = 0; k < scatter.size(); ++k) {
    // Three times the error of the scatter; rounding of 1000 hPa.
    EXPECT_NEAR(stated[uncertain_results[k].uncertainty], scatter[k], 0.035 * scatter[k] + 1e-10)
        << what << ": " << info_of(uncertain_results[k].result).name;
  }
}

class EffectUncertainty : public testing::TestWithParam<EffectInfo> {};

// Coefficients whose errors have a correlation of one half.
TEST_P(EffectUncertainty, EqualsTheScatterOfDrawnCoefficients) {
  const EffectInfo& info = GetParam();
  const Recorded all = everything_recorded();
  for (const Recorded& recorded :
       {all, without_roles(all, {Quantity::attack, Quantity::sideslip, Quantity::lams_airspeed})}) {
    Model model = law();
    for (const ModelEffect& effect : model.effects) {
      if (effect.id == info.id) model.effects = {};
    }
    model.effects.push_back(typical(info));
    model.moist = info.constants != GasConstants::dry;
    const std::size_t count = parameter_count(model);
    const std::size_t first = count - info.parameter_count();
    std::vector<double> sizes(count, 0.0);
    for (std::size_t i = first; i < count; ++i) {
      const double usual = 0.02 * std::abs(info.parameters[i - first].typical);
      sizes[i] = usual > 0.0 ? usual : 0.1;  // shape parameter whose usual value is zero
    }
    ModelUncertainty uncertainty;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j)
        uncertainty.covariance.push_back((i == j ? 1.0 : 0.5) * sizes[i] * sizes[j]);
    }
    expect_scatter(state_of(model, recorded, uncertainty),
                   scatter(model, recorded,
                           [&](std::mt19937_64& engine, State<double>&, std::vector<double>& parameters) {
                             const double common = normal(engine);
                             for (std::size_t i = first; i < count; ++i)
                               parameters[i] += sizes[i] * std::sqrt(0.5) * (common + normal(engine));
                           }),
                   std::string(info.id));
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EffectUncertainty, testing::ValuesIn(effect_info),
                         [](const auto& effect) { return test::test_name(effect.param.id); });

// The gain multiplies the ratio as recorded. Taken at the corrected ratio, the uncertainty was 30 % too
// small.
TEST(ResultUncertainty, GainOfTheAttackRatioActsOnTheRecordedRatio) {
  Model model;
  model.effects = {{"static-alpha", {0.021}}, {"adif-drift", {0.3, 0.0, 0.0}}};
  const State<double> s = state_of(model, everything_recorded(), of_parameter(model, 1, 0.03));
  // d(delta-p) = -p a1 r d(gain), r = -18/79 as recorded; linear.
  EXPECT_NEAR(s[Quantity::static_defect_uncertainty], 700.0 * 0.021 * 18.0 / 79.0 * 0.03, 1e-12);
}

// The chain calibrates a recorded temperature in place: from -3.15 to +1.85 degrees Celsius.
TEST(ResultUncertainty, CalibrationActsOnTheRecordedTemperature) {
  Model model;
  model.effects = {{"temp-calibration", {5.0, 0.0, 0.0}}};
  const State<double> s = state_of(model,
                                   {{Quantity::static_pressure, 700.0},
                                    {Quantity::dynamic_pressure, 80.0},
                                    {Quantity::ambient_temperature, 270.0}},
                                   of_parameter(model, 2, 1e-4));
  // dT/da2 = t^2; linear.
  EXPECT_NEAR(s[Quantity::ambient_temperature_uncertainty], 1e-4 * 3.15 * 3.15, 1e-12);
}

TEST(ResultUncertainty, RoleUncertaintyEqualsTheScatterOfDrawnValues) {
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
        without_roles(everything_recorded(), {Quantity::attack, Quantity::sideslip, Quantity::lams_airspeed});
    ModelUncertainty uncertainty;
    uncertainty.random[index(role)] = size;
    expect_scatter(
        state_of(model, recorded, uncertainty),
        scatter(model, recorded,
                [role = role, size = size](std::mt19937_64& engine, State<double>& state,
                                           std::vector<double>&) { state[role] += size * normal(engine); }),
        std::string(info_of(role).name));
  }
}

// With h = (1 + q/p)^(2/7) - 1 of dry air, T = T_r/(1 + r h) and v^2 = 2 c_p T h:
//     dh = 2/7 (1 + h) (dq - q/p dp)/(p + q),   dT = -T r dh/(1 + r h),   dv = v/2 (dh/h + dT/T)
TEST(ResultUncertainty, RoleUncertaintyEqualsTheClosedForm) {
  Model model;
  model.effects = {{"static-constant", {0.004}}};
  model.recovery = {{0.95}};
  model.moist = false;
  const Recorded recorded{{Quantity::static_pressure, 700.0},
                          {Quantity::dynamic_pressure, 80.0},
                          {Quantity::recovery_temperature, 280.0}};
  const double p = 1.004 * 700.0, q = 80.0 - 0.004 * 700.0;
  const double h = std::pow(1.0 + q / p, 2.0 / 7.0) - 1.0;
  struct Case {
    Quantity role;
    double dp, dq, of_thermometer;  // changes by one unit of the role
  };
  for (const Case& each :
       {Case{Quantity::static_pressure, 1.004, -0.004, 0.0}, Case{Quantity::dynamic_pressure, 0.0, 1.0, 0.0},
        Case{Quantity::recovery_temperature, 0.0, 0.0, 1.0}}) {
    constexpr double size = 0.01;
    ModelUncertainty uncertainty;
    uncertainty.random[index(each.role)] = size;
    const State<double> s = state_of(model, recorded, uncertainty);
    const double dh = 2.0 / 7.0 * (1.0 + h) * (each.dq - q / p * each.dp) / (p + q);
    const double temperature = s[Quantity::ambient_temperature];
    const double dt = (each.of_thermometer - temperature * 0.95 * dh) / (1.0 + 0.95 * h);
    const double dv = 0.5 * s[Quantity::corrected_airspeed] * (dh / h + dt / temperature);
    // Cubic terms of a step of 0.01 hPa or K: below (0.01/80)^2.
    const auto expect = [](double stated, double slope) {
      EXPECT_NEAR(stated, size * std::abs(slope), 1e-7 * size * std::abs(slope) + 1e-12);
    };
    expect(s[Quantity::corrected_static_pressure_uncertainty], each.dp);
    expect(s[Quantity::corrected_dynamic_pressure_uncertainty], each.dq);
    expect(s[Quantity::ambient_temperature_uncertainty], dt);
    expect(s[Quantity::corrected_airspeed_uncertainty], dv);
  }
}

// The derivative of delta-p from LAMS by the airspeed, at a fixed temperature, is the inverse of that of the
// airspeed by delta-p. Values and states: "Numerically checked" table of the propagation of errors.
TEST(ResultUncertainty, AirspeedUncertaintyAgreesWithPublishedSensitivities) {
  struct Row {
    double p, v, mach, q, by_airspeed;  // hPa, m/s, 1, hPa, hPa per m/s
  };
  for (const Row& row : {Row{900.0, 110.0, 0.327, 69.1, 1.20}, Row{700.0, 120.0, 0.365, 67.6, 1.06},
                         Row{500.0, 145.0, 0.456, 76.5, 0.96}, Row{850.0, 160.0, 0.478, 144.0, 1.63},
                         Row{500.0, 200.0, 0.629, 152.0, 1.28}, Row{250.0, 230.0, 0.772, 121.0, 0.81},
                         Row{160.0, 240.0, 0.813, 87.2, 0.55}}) {
    Model model;
    model.moist = false;
    ModelUncertainty uncertainty;
    uncertainty.static_defect = 0.1;
    const double sound = row.v / row.mach;
    const State<double> s = state_of(model,
                                     {{Quantity::static_pressure, row.p},
                                      {Quantity::dynamic_pressure, row.q},
                                      {Quantity::ambient_temperature, sound * sound / (1.4 * 287.05)}},
                                     uncertainty);
    // Two to three digits of the table: 1 %.
    EXPECT_NEAR(0.1 / s[Quantity::corrected_airspeed_uncertainty], row.by_airspeed, 0.01 * row.by_airspeed)
        << row.p << " hPa, " << row.v << " m/s";
  }
}

// d ln e/dT = 17.62 * 243.12/(243.12 + t)^2 (Magnus). The ratio e/p changes h = M^2/5 and c_p.
TEST(ResultUncertainty, DewPointAndAmbientTemperatureUncertaintiesPropagate) {
  Recorded recorded =
      without_roles(everything_recorded(), {Quantity::vapor_pressure, Quantity::recovery_temperature,
                                            Quantity::recovery_temperature_rate, Quantity::lams_airspeed});
  recorded[Quantity::ambient_temperature] = 270.0;
  recorded[Quantity::dew_point] = 264.0;
  for (const Quantity role : {Quantity::ambient_temperature, Quantity::dew_point}) {
    ModelUncertainty uncertainty;
    uncertainty.random[index(role)] = 1.0;
    const State<double> s = state_of(law(), recorded, uncertainty);
    const double v = s[Quantity::corrected_airspeed];
    const double h = 0.2 * s[Quantity::corrected_mach] * s[Quantity::corrected_mach];
    // d ln h = -(1 + h/2)/7 d(e/p), d ln c_p = 0.52 d(e/p).
    const double by_ratio = 0.5 * v * (0.52 - (1.0 + 0.5 * h) / 7.0);
    const double by_point = s[Quantity::humidity] * 17.62 * 243.12 / ((264.0 - 30.03) * (264.0 - 30.03));
    const bool is_ambient = role == Quantity::ambient_temperature;
    const double airspeed = is_ambient ? 0.5 * v / 270.0 : by_ratio * by_point;
    // The constants of dry air within 2 %, the slope of saturation within 2 %.
    EXPECT_NEAR(s[Quantity::corrected_airspeed_uncertainty], airspeed, 0.03 * airspeed);
    EXPECT_NEAR(s[Quantity::ambient_temperature_uncertainty], is_ambient ? 1.0 : 0.0, 1e-12);
  }
}

// A formula of the pitch, at locations from which its noise reaches the results by other quantities.
TEST(ResultUncertainty, NoiseReachesResultsThroughEveryLocation) {
  const Recorded recorded = without_roles(everything_recorded(), {Quantity::lams_airspeed});
  struct Case {
    EffectLocation location;
    double slope;  // change of delta-p by one unit of the effect
  };
  Model law;
  law.effects = {{"static-attack", {0.001}}, {"static-alpha", {0.02}}};
  // An added dynamic pressure q' of the radome changes the ratio -18/79 by -ratio q'/79.
  for (const Case& each :
       {Case{EffectLocation::attack, 0.001 * 700.0}, Case{EffectLocation::attack_ratio, 0.02 * 700.0},
        Case{EffectLocation::radome, 0.02 * 700.0 * 18.0 / 79.0 / 79.0}}) {
    Model model = law;
    ModelEffect effect;
    effect.id = "of-pitch";
    effect.formula = "k * (pitch - 4)";
    effect.parameter_names = {"k"};
    effect.parameters = {1e-3};
    effect.location = each.location;
    model.effects.push_back(effect);
    ModelUncertainty uncertainty;
    uncertainty.random[index(Quantity::pitch)] = 2.0;
    // Linear except for the radome: (0.002/79)^2.
    EXPECT_NEAR(state_of(model, recorded, uncertainty)[Quantity::static_defect_uncertainty],
                2e-3 * each.slope, 1e-9 * each.slope);
  }
}

// Below zero the air counts as dry, so that an error counts on one side only.
TEST(ResultUncertainty, LimitOfHumidityHalvesTheUncertainty) {
  Recorded recorded = without_roles(everything_recorded(), {Quantity::lams_airspeed});
  ModelUncertainty uncertainty;
  uncertainty.random[index(Quantity::vapor_pressure)] = 0.2;
  Model model;
  model.recovery = {{0.97}};
  const auto of_airspeed = [&](double vapor) {
    recorded[Quantity::vapor_pressure] = vapor;
    return state_of(model, recorded, uncertainty)[Quantity::corrected_airspeed_uncertainty];
  };
  const double inside = of_airspeed(1.0);
  EXPECT_GT(inside, 0.0);
  EXPECT_NEAR(of_airspeed(0.0) / inside, 0.5, 0.01) << "the slopes differ by e/p";
}

TEST(ResultUncertainty, TaperAndMinimumKeepLawUncertainty) {
  Model model = law();
  model.policy.taper_below = 100.0;
  const Recorded recorded = everything_recorded();
  const auto of_constant = [&recorded](const Model& of) {
    return state_of(of, recorded, of_parameter(of, 0, 1e-4))[Quantity::static_defect_uncertainty];
  };
  EXPECT_NEAR(of_constant(model), 1e-4 * 700.0 * 0.8 * 0.8 * 0.8, 1e-12);
  model.policy = {};
  EXPECT_NEAR(of_constant(model), 1e-4 * 700.0, 1e-12);
  model.policy.minimum = 40.0;
  EXPECT_NEAR(of_constant(model), 1e-4 * 700.0, 1e-12) << "the limit is not known better than the law";
}

// The errors of all coefficients at the ports are one change of delta-p.
TEST(ResultUncertainty, CoefficientsAtThePortsAddTheirSquares) {
  Model model = law();
  model.policy.taper_below = 100.0;
  ModelEffect surface{"static-surface", {}};
  surface.surface = Surface{{{{Quantity::attack_ratio, -0.3, -0.1, 5}, {Quantity::mach, 0.2, 0.5, 4}}}};
  for (std::size_t i = 0; i < surface.surface->parameter_count(); ++i)
    surface.parameters.push_back(0.01 * std::sin(3.0 * static_cast<double>(i)));
  model.effects.push_back(surface);
  model.effects.push_back({"temp-offset", {0.1, 0.001}});
  const Recorded recorded = everything_recorded();
  const std::size_t count = parameter_count(model);
  const double size = 1e-4;
  ModelUncertainty uncertainty;
  uncertainty.covariance.assign(count * count, 0.0);
  std::array<double, uncertain_results.size()> squares{};
  std::size_t position = 0;
  for (ModelEffect& effect : model.effects) {
    for (double& parameter : effect.parameters) {
      uncertainty.covariance[position * (count + 1)] = size * size;
      ++position;
      const double value = parameter;
      parameter = value + size;
      const State<double> above = state_of(model, recorded);
      parameter = value - size;
      const State<double> below = state_of(model, recorded);
      parameter = value;
      for (std::size_t k = 0; k < squares.size(); ++k) {
        const Quantity result = uncertain_results[k].result;
        squares[k] += std::pow(0.5 * (above[result] - below[result]), 2);
      }
    }
  }
  const State<double> stated = state_of(model, recorded, uncertainty);
  for (std::size_t k = 0; k < squares.size(); ++k) {
    // Curvature of the results over a change of 0.1 hPa.
    EXPECT_NEAR(stated[uncertain_results[k].uncertainty] / std::sqrt(squares[k]), 1.0, 1e-4)
        << info_of(uncertain_results[k].result).name;
  }
}

TEST(ResultUncertainty, IsMissingOutsideTheDomainOfTheLaw) {
  Model model = law();
  const Recorded recorded = everything_recorded();
  const ModelUncertainty uncertainty = of_parameter(model, 0, 1e-4);
  model.domain = {{"dynamic_pressure", 20.0, 79.0}};
  const State<double> outside = state_of(model, recorded, uncertainty);
  model.domain = {{"dynamic_pressure", 20.0, 81.0}};
  const State<double> inside = state_of(model, recorded, uncertainty);
  for (const UncertainResult& each : uncertain_results) {
    EXPECT_EQ(outside[each.result], inside[each.result]) << info_of(each.result).name;
    EXPECT_TRUE(std::isnan(outside[each.uncertainty])) << info_of(each.result).name;
    EXPECT_FALSE(std::isnan(inside[each.uncertainty])) << info_of(each.result).name;
  }
}

// Attack noise of 0.3 hPa at a radome pressure of 0.001 hPa exceeds all possible angles in both directions.
TEST(ResultUncertainty, IsMissingWithABitWhereTheNoiseOfAnInputExceedsItsRange) {
  Recorded recorded = without_roles(everything_recorded(), {Quantity::attack, Quantity::sideslip});
  recorded[Quantity::radome_dynamic_pressure] = 1e-3;
  recorded[Quantity::attack_differential_pressure] = 0.0;
  recorded[Quantity::sideslip_differential_pressure] = 0.0;
  ModelUncertainty uncertainty;
  for (const double noise : {1e-6, 0.3}) {
    uncertainty.random[index(Quantity::attack_differential_pressure)] = noise;
    std::optional<Loop> loop =
        Loop::build(law(), roles_of(recorded), 1.0, nullptr, CorrectWith::model, uncertainty);
    ASSERT_TRUE(loop);
    for (const auto& [quantity, value] : recorded) loop->state()[quantity] = value;
    loop->run(1800.0);
    const bool is_possible = noise < 1e-3;
    EXPECT_FALSE(std::isnan(loop->state()[Quantity::static_defect]));
    EXPECT_EQ(std::isnan(loop->state()[Quantity::static_defect_uncertainty]), !is_possible);
    EXPECT_EQ(loop->quality().has(Quality::outside_domain), !is_possible);
  }
}

TEST(ResultUncertainty, TaperDependsOnTheDynamicPressure) {
  Model model;
  model.effects = {{"static-constant", {0.02}}};
  model.policy.taper_below = 100.0;
  const Recorded recorded{{Quantity::static_pressure, 700.0}, {Quantity::dynamic_pressure, 70.0}};
  ModelUncertainty uncertainty;
  uncertainty.random[index(Quantity::dynamic_pressure)] = 0.5;
  const State<double> s = state_of(model, recorded, uncertainty);
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
  const State<double> s =
      state_of(model, without_roles(everything_recorded(), {Quantity::lams_airspeed}), uncertainty);
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
    auto loop = Loop::build(model, roles_of(level), 1.0, &error, CorrectWith::model, uncertainty);
    ASSERT_TRUE(loop) << error;
    loop->do_not_watch_sensors();  // the other roles are constant
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
  const State<double> s = state_of(model, recorded, uncertainty);
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
    const State<double> s = state_of(model, recorded, uncertainty);
    const double of_law = 1e-4 * 700.0;
    EXPECT_NEAR(s[Quantity::static_defect_uncertainty], of_law, 1e-9);
    EXPECT_NEAR(s[Quantity::corrected_dynamic_pressure_uncertainty], of_law, 1e-9);
    EXPECT_NEAR(s[Quantity::corrected_static_pressure_uncertainty],
                std::sqrt(of_law * of_law + b * b - 2.0 * correlation * of_law * b), 1e-9)
        << "a bias is removed";
  }
}

// Two errors of 14 hPa that cancel except for 0.002 hPa, as terms of a law of many powers do.
TEST(ResultUncertainty, NearlyCancellingErrorsKeepTheirRest) {
  Model model;
  model.effects = {{"static-constant", {0.004}}, {"psfd-bias", {0.0}}};
  constexpr double a = 0.02, b = 14.0, epsilon = 1e-8;
  ModelUncertainty uncertainty;
  uncertainty.covariance = {a * a, (1.0 - epsilon) * a * b, (1.0 - epsilon) * a * b, b * b};
  const State<double> s = state_of(model, everything_recorded(), uncertainty);
  // Rounding of the covariance: 1e-16 of a variance against 2e-8.
  EXPECT_NEAR(s[Quantity::corrected_static_pressure_uncertainty], b * std::sqrt(2.0 * epsilon), 1e-7 * b);
}

TEST(ResultUncertainty, ImpossibleUncertaintyIsRefused) {
  for (const double number : {missing, std::numeric_limits<double>::infinity(), -0.3}) {
    const auto error_of = [](const ModelUncertainty& uncertainty) {
      std::string error;
      Loop::build(law(), roles_of(everything_recorded()), 1.0, &error, CorrectWith::model, uncertainty);
      return error;
    };
    const auto refused = HasSubstr("negative or not finite; give zero or a positive number");
    ModelUncertainty uncertainty;
    uncertainty.static_defect = number;
    EXPECT_THAT(error_of(uncertainty), refused);
    uncertainty = {};
    uncertainty.static_defect_ratio = number;
    EXPECT_THAT(error_of(uncertainty), refused);
    uncertainty = {};
    uncertainty.random[index(Quantity::static_pressure)] = number;
    EXPECT_THAT(error_of(uncertainty), refused);
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
  const State<double> a = state_of(model, everything_recorded(), once);
  const State<double> b = state_of(model, everything_recorded(), twice);
  const State<double> c = state_of(model, everything_recorded(), other_role);
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
  const State<double> all = state_of(model, everything_recorded(), whole);
  const State<double> systematic = state_of(model, everything_recorded(), whole.systematic_part());
  const State<double> random = state_of(model, everything_recorded(), whole.random_part());
  for (const UncertainResult& each : uncertain_results) {
    EXPECT_NEAR(all[each.uncertainty], std::hypot(systematic[each.uncertainty], random[each.uncertainty]),
                1e-9);
  }
  EXPECT_NEAR(random[Quantity::static_defect_uncertainty], 0.00045 * 700.0, 1e-12);
}

// A loop at 25 Hz through missing values, the ramp, and LAMS.
class InALoop : public testing::Test {
 protected:
  void build(CorrectWith with, std::size_t uncertain = 0) {
    Model model = law();
    model.lams.elevation = 1.5;
    ModelUncertainty uncertainty = of_parameter(model, uncertain, 1e-4);
    uncertainty.random[index(Quantity::recovery_temperature)] = 0.1;
    std::string error;
    loop_ = Loop::build(model, roles_of(recorded_), 25.0, &error, with, uncertainty);
    ASSERT_TRUE(loop_) << error;
  }

  const State<double>& run(Quantity changed = Quantity::count, double to = missing) {
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
    for (const auto& [quantity, to] : {std::pair{Quantity::static_pressure, missing},
                                       {Quantity::dynamic_pressure, missing},
                                       {Quantity::dynamic_pressure, 0.3},
                                       {Quantity::recovery_temperature, missing},
                                       {Quantity::attack_differential_pressure, missing},
                                       {Quantity::attack, missing}}) {
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

TEST_F(InALoop, UncertaintyIsThatOfTheSample) {
  build(CorrectWith::model);
  EXPECT_NEAR(run()[Quantity::static_defect_uncertainty], 0.07, 1e-12);
  EXPECT_NEAR(run(Quantity::static_pressure, 690.0)[Quantity::static_defect_uncertainty], 0.069, 1e-12);
}

// A ratio of -7.6 gives a delta-p above the dynamic pressure, and a slope far from that of its neighbours.
TEST_F(InALoop, ImpossibleSampleDoesNotSpoilTheNext) {
  build(CorrectWith::model, 1);
  run(Quantity::attack_differential_pressure, -600.0);
  ASSERT_TRUE(std::isnan(loop_->state()[Quantity::static_defect]));
  EXPECT_NEAR(run()[Quantity::static_defect_uncertainty], 1e-4 * 700.0 * 18.0 / 79.0, 1e-12);
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
  EXPECT_FALSE(is_covariance({missing}, 1));
  EXPECT_FALSE(is_covariance({std::numeric_limits<double>::infinity()}, 1));
  EXPECT_FALSE(is_covariance({1.0, missing, missing, 1.0}, 2));
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
