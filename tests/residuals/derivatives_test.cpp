#include <ceres/jet.h>
#include <gtest/gtest.h>
#include <pcor/realtime/chain.hpp>

#include "support/input_range.hpp"
#include "support/test_name.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

// Automatic derivatives, of which fits are made, against central differences.

using pcor::BindingError;
using pcor::Chain;
using pcor::effect_functions;
using pcor::effect_info;
using pcor::EffectInfo;
using pcor::EffectLocation;
using pcor::Model;
using pcor::ModelEffect;
using pcor::Quantity;
using pcor::State;

namespace {

using Jet4 = ceres::Jet<double, 4>;

// With a step of 1e-5 of the range of x, a central difference errs by 1e-10 of f''' x^3/6 and by 1e-11 of
// rounding of f: 1e-6 of f/x covers both for powers up to the fourth.
template <class Function, class Point, class Index>
double difference(const Function& f, Point at, Index index, double h) {
  const double x = at[index];
  at[index] = x + h;
  const double above = f(at);
  at[index] = x - h;
  return (above - f(at)) / (2 * h);
}

std::vector<Jet4> dual(const std::vector<double>& parameters) {
  std::vector<Jet4> result;
  for (std::size_t i = 0; i < parameters.size(); ++i) result.emplace_back(parameters[i], static_cast<int>(i));
  return result;
}

using Engine = std::mt19937_64;

double draw(Engine& engine, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(engine);
}

State<double> draw_state(const EffectInfo& info, Engine& engine) {
  State<double> state;
  for (std::size_t i = 0; i < info.need_count(); ++i) {
    const InputRange range = input_range(info.needs[i]);
    state[info.needs[i]] = draw(engine, range.lower, range.upper);
  }
  return state;
}

std::vector<double> draw_parameters(const EffectInfo& info, Engine& engine) {
  std::vector<double> result;
  for (std::size_t i = 0; i < info.parameter_count(); ++i)
    result.push_back(draw(engine, info.parameters[i].lower, info.parameters[i].upper));
  return result;
}

class EveryEffect : public testing::TestWithParam<std::size_t> {
 protected:
  const EffectInfo& info() const { return effect_info[GetParam()]; }
  double value(const State<double>& state, const std::vector<double>& parameters) const {
    return effect_functions<double, double>[GetParam()](state, parameters.data());
  }
};

TEST_P(EveryEffect, DerivativeByEachParameterIsCorrect) {
  Engine engine(20120106);
  for (int n = 0; n < 20; ++n) {
    const State<double> state = draw_state(info(), engine);
    const std::vector<double> parameters = draw_parameters(info(), engine);
    const Jet4 result = effect_functions<double, Jet4>[GetParam()](state, dual(parameters).data());
    const double plain = value(state, parameters);
    EXPECT_NEAR(result.a, plain, 1e-14 * std::abs(plain));
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const double width = info().parameters[i].upper - info().parameters[i].lower;
      const auto along = [&](const std::vector<double>& moved) { return value(state, moved); };
      const double expected = difference(along, parameters, i, 1e-3 * width);
      EXPECT_NEAR(result.v[static_cast<Eigen::Index>(i)], expected, 1e-9 * (1 + std::abs(expected)))
          << info().parameters[i].name;
    }
  }
}

TEST_P(EveryEffect, DerivativeByEachInputIsCorrect) {
  Engine engine(20120106);
  for (int n = 0; n < 20; ++n) {
    const State<double> state = draw_state(info(), engine);
    const std::vector<double> parameters = draw_parameters(info(), engine);
    State<Jet4> dual;
    for (std::size_t i = 0; i < info().need_count(); ++i)
      dual[info().needs[i]] = Jet4(state[info().needs[i]], static_cast<int>(i));
    const Jet4 result = effect_functions<Jet4, double>[GetParam()](dual, parameters.data());
    const double plain = value(state, parameters);
    EXPECT_NEAR(result.a, plain, 1e-14 * std::abs(plain));
    for (std::size_t i = 0; i < info().need_count(); ++i) {
      const Quantity need = info().needs[i];
      const InputRange range = input_range(need);
      const auto along = [&](const State<double>& moved) { return value(moved, parameters); };
      const double expected = difference(along, state, need, 1e-5 * (range.upper - range.lower));
      EXPECT_NEAR(result.v[static_cast<Eigen::Index>(i)], expected, 1e-6 * (1 + std::abs(expected)))
          << info_of(need).name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryEffect, testing::Range<std::size_t>(0, pcor::catalogue_size),
                         [](const auto& effect) {
                           return pcor::test::test_name(effect_info[effect.param].id);
                         });

ModelEffect effect(std::string id, double parameter) {
  ModelEffect result;
  result.id = std::move(id);
  result.parameters = {parameter};
  return result;
}

// The C-130 of the memo, with the effects that act before the static ports.
Model memo_model(bool upstream) {
  Model model;
  model.effects = {effect("static-constant", .004127875), effect("static-alpha", .021279816),
                   effect("static-qp", .030849643)};
  if (upstream)
    model.effects = {effect("lams-elevation", 0.3), effect("recovery-factor", 0.01),
                     effect("static-lag", 0.1)};
  model.recovery = {{0.988, 0.053, 0.090, 0.091}};
  model.lams = {1.5, -0.8, pcor::LamsApproach::simultaneous};
  return model;
}

const std::pair<Quantity, double> record[] = {{Quantity::static_pressure, 697},
                                              {Quantity::dynamic_pressure, 70},
                                              {Quantity::radome_dynamic_pressure, 69},
                                              {Quantity::attack_differential_pressure, -20},
                                              {Quantity::sideslip_differential_pressure, -5},
                                              {Quantity::static_pressure_rate, -0.8},
                                              {Quantity::dynamic_pressure_rate, 0.4},
                                              {Quantity::recovery_temperature_rate, -0.05},
                                              {Quantity::airspeed_rate, 0.3},
                                              {Quantity::time, 5000},
                                              {Quantity::normal_acceleration, 2},
                                              {Quantity::longitudinal_acceleration, 0.5},
                                              {Quantity::roll, 20},
                                              {Quantity::flaps, 30},
                                              {Quantity::engine_torque, 60},
                                              {Quantity::height_above_ground, 30},
                                              {Quantity::liquid_water, 0.3},
                                              {Quantity::wetness, 0.6},
                                              {Quantity::transducer_temperature, 300},
                                              {Quantity::cabin_pressure, 900},
                                              {Quantity::date, 4323.5},
                                              {Quantity::recovery_temperature, 276},
                                              {Quantity::vapor_pressure, 3},
                                              {Quantity::attack, 2.5},
                                              {Quantity::sideslip, -1},
                                              {Quantity::lams_airspeed, 119.5}};

Chain build(const Model& model) {
  std::vector<Quantity> recorded;
  for (const auto& [quantity, value] : record) recorded.push_back(quantity);
  BindingError error;
  auto chain = Chain::build(model, recorded, &error);
  if (!chain) throw std::runtime_error(error.message());
  return *chain;
}

template <class S>
State<S> recorded_state() {
  State<S> state;
  for (const auto& [quantity, value] : record) state[quantity] = S(value);
  return state;
}

// Quantities that a fit compares: delta-p from LAMS, and the temperature of the corrected pressures.
template <class S>
State<S> run(const Chain& chain, const std::vector<S>& parameters) {
  State<S> state = recorded_state<S>();
  pcor::NoQualityFlags none;
  chain.correct_inputs(state, parameters.data(), none);
  state[Quantity::static_defect] = chain.static_defect(state, parameters.data(), none);
  state[Quantity::lams_static_defect] = chain.lams_static_defect(state, parameters.data(), none);
  chain.correct(state, state[Quantity::static_defect], none);
  chain.air(state, parameters.data(), none);
  chain.lams_air(state, parameters.data(), none);
  return state;
}

TEST(Chain, StaticDefectSeparatesStateFromParameters) {
  // The Jacobian of eq. 18 is its basis: p, ADIFR/QCR p and q.
  const Chain chain = build(memo_model(false));
  State<double> state = recorded_state<double>();
  pcor::NoQualityFlags none;
  chain.correct_inputs(state, chain.parameters().data(), none);
  const std::vector<Jet4> parameters = dual(chain.parameters());
  const Jet4 defect = chain.static_defect(state, parameters.data(), none);
  EXPECT_EQ(defect.a, chain.static_defect(state, chain.parameters().data(), none));
  EXPECT_NEAR(defect.v[0], 697, 1e-12);
  EXPECT_NEAR(defect.v[1], -20.0 / 69 * 697, 1e-12);
  EXPECT_NEAR(defect.v[2], 70, 1e-12);
}

TEST(Chain, StaticDefectDerivativeIncludesThePolicy) {
  Model model = memo_model(false);
  model.policy.taper_below = 140;  // the sample is at half of it
  Chain chain = build(model);
  State<double> state = recorded_state<double>();
  pcor::NoQualityFlags none;
  chain.correct_inputs(state, chain.parameters().data(), none);
  Jet4 defect = chain.static_defect(state, dual(chain.parameters()).data(), none);
  EXPECT_NEAR(defect.v[0], 697.0 / 8, 1e-10);

  model.policy.taper_below = 0;
  model.policy.minimum = 20;
  chain = build(model);
  defect = chain.static_defect(state, dual(chain.parameters()).data(), none);
  EXPECT_EQ(defect.a, 20);
  EXPECT_EQ(defect.v[0], 0) << "no change at the lower limit";
}

TEST(Chain, EveryStageHasCorrectDerivatives) {
  // The whole chain with every number dual: 1e-6 relative, from the central difference.
  for (const bool upstream : {false, true}) {
    const Chain chain = build(memo_model(upstream));
    const State<Jet4> state = run(chain, dual(chain.parameters()));
    const State<double> plain = run(chain, chain.parameters());
    for (const Quantity quantity :
         {Quantity::port_static_pressure, Quantity::static_defect, Quantity::lams_static_defect,
          Quantity::corrected_static_pressure, Quantity::corrected_mach, Quantity::ambient_temperature,
          Quantity::corrected_airspeed, Quantity::lams_temperature, Quantity::lams_dynamic_pressure}) {
      EXPECT_NEAR(state[quantity].a, plain[quantity], 1e-9) << info_of(quantity).name;
      for (std::size_t i = 0; i < chain.parameters().size(); ++i) {
        const auto along = [&](const std::vector<double>& moved) { return run(chain, moved)[quantity]; };
        const double expected = difference(along, chain.parameters(), i, 1e-5);
        EXPECT_NEAR(state[quantity].v[static_cast<Eigen::Index>(i)], expected,
                    1e-6 * (1 + std::abs(expected)))
            << info_of(quantity).name << " by parameter " << i << (upstream ? ", upstream" : "");
      }
    }
  }
}

TEST(Chain, LineLagChangesLamsDefectByPressureRate) {
  // An error of the line leaves pt, so delta-p from LAMS loses the whole of it: d/dtau = -dp/dt.
  const Chain chain = build(memo_model(true));
  const State<Jet4> state = run(chain, dual(chain.parameters()));
  EXPECT_NEAR(state[Quantity::lams_static_defect].v[2], 0.8, 1e-3) << "and p in e/p moves a little";
}

// Target of a fit with the laser, zero: delta-p required by the laser minus delta-p of the law.
template <class S>
S residual(const Chain& chain, const std::vector<S>& parameters) {
  const State<S> state = run(chain, parameters);
  return state[Quantity::lams_static_defect] - state[Quantity::static_defect];
}

TEST_P(EveryEffect, ResidualDerivativeIsCorrect) {
  // Each in the law of the memo with its typical coefficients; the shape of one that does not act here, below
  // the onset of the transonic pocket, alone moves nothing.
  Model model = memo_model(false);
  model.moist = info().constants != pcor::GasConstants::dry;
  ModelEffect added;
  added.id = std::string(info().id);
  for (std::size_t i = 0; i < info().parameter_count(); ++i)
    added.parameters.push_back(info().parameters[i].typical);
  if (info().id == "static-transonic") added.parameters[1] = 0.3;
  // A law has each effect once.
  const auto same = [&](const ModelEffect& each) { return each.id == added.id; };
  model.effects.erase(std::remove_if(model.effects.begin(), model.effects.end(), same), model.effects.end());
  model.effects.insert(model.effects.begin(), added);
  const Chain chain = build(model);
  std::vector<Jet4> parameters(chain.parameters().begin(), chain.parameters().end());
  for (std::size_t i = 0; i < info().parameter_count(); ++i)
    parameters[i] = Jet4(chain.parameters()[i], static_cast<int>(i));
  const Jet4 result = residual(chain, parameters);
  EXPECT_NEAR(result.a, residual(chain, chain.parameters()), 1e-9);
  for (std::size_t i = 0; i < info().parameter_count(); ++i) {
    const auto along = [&](const std::vector<double>& moved) { return residual(chain, moved); };
    const double width = info().parameters[i].upper - info().parameters[i].lower;
    const double expected = difference(along, chain.parameters(), i, 1e-4 * width);
    // 1e-7 hPa over the range of the coefficient, a thousandth of the resolution of a fit, and 1e-6 of the
    // derivative.
    EXPECT_NEAR(result.v[static_cast<Eigen::Index>(i)] * width, expected * width,
                1e-7 + 1e-6 * std::abs(expected * width))
        << info().parameters[i].name;
    // A date moves what lies between, and no sample does; the time of drying is in the wetness.
    if (info().parameters[i].name == "since" || info().parameters[i].name == "drying") continue;
    EXPECT_GT(std::abs(expected * width), 1e-3) << info().parameters[i].name << " moves nothing";
  }
}

}  // namespace
