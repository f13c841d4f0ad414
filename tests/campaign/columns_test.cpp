// Columns of a diagnosis against differences of residuals through the whole chain.
#include "campaign/columns.hpp"

#include <gmock/gmock.h>
#include <pcor/effects/catalogue.hpp>
#include <pcor/realtime/chain.hpp>
#include <pcor/residuals/residuals.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "campaign/model_parameters.hpp"
#include "diagnose/candidates.hpp"
#include "support/short_flight.hpp"

using namespace pcor::internal;

using pcor::FlightSamples;
using pcor::ModelDefinition;
using pcor::ModelEffect;
using pcor::Quantity;
using pcor::Residuals;
using pcor::test::laser_model;

namespace {

/// Where a made series lies, and how far it swings.
struct Swing {
  double middle = 0.0;
  double size = 0.0;
};

/// Some of each quantity, so that every effect acts.
Swing swing_of(Quantity quantity) {
  static const std::map<Quantity, Swing> swings{{Quantity::static_pressure, {600.0, 150.0}},
                                                {Quantity::dynamic_pressure, {70.0, 20.0}},
                                                {Quantity::recovery_temperature, {275.0, 10.0}},
                                                {Quantity::vapor_pressure, {0.5, 0.3}},
                                                {Quantity::radome_dynamic_pressure, {75.0, 15.0}},
                                                {Quantity::attack_differential_pressure, {-12.0, 10.0}},
                                                {Quantity::sideslip_differential_pressure, {1.0, 8.0}},
                                                {Quantity::attack, {2.0, 3.0}},
                                                {Quantity::sideslip, {0.3, 3.0}},
                                                {Quantity::mach, {0.4, 0.1}},
                                                {Quantity::true_airspeed, {120.0, 20.0}},
                                                {Quantity::altitude, {3000.0, 2000.0}},
                                                {Quantity::latitude, {40.0, 1.0}},
                                                {Quantity::pitch, {2.0, 3.0}},
                                                {Quantity::roll, {0.0, 20.0}},
                                                {Quantity::heading, {90.0, 60.0}},
                                                {Quantity::ground_speed, {120.0, 20.0}},
                                                {Quantity::ground_track, {90.0, 60.0}},
                                                {Quantity::flaps, {2.0, 2.0}},
                                                {Quantity::height_above_ground, {300.0, 290.0}},
                                                {Quantity::liquid_water, {0.1, 0.1}},
                                                {Quantity::transducer_temperature, {288.0, 6.0}},
                                                {Quantity::cabin_pressure, {850.0, 40.0}},
                                                {Quantity::time, {3600.0, 3600.0}},
                                                {Quantity::static_pressure_rate, {0.1, 1.0}},
                                                {Quantity::dynamic_pressure_rate, {0.1, 1.0}},
                                                {Quantity::recovery_temperature_rate, {0.01, 0.1}},
                                                {Quantity::airspeed_rate, {0.05, 0.5}},
                                                {Quantity::wetness, {0.5, 0.5}}};
  const auto found = swings.find(quantity);
  return found == swings.end() ? Swing{0.5, 2.0} : found->second;
}

/// Samples of everything that a model can read; the laser shows the speed of the pressures and noise.
FlightSamples made_flight(const std::vector<Quantity>& roles, double laser_noise) {
  constexpr std::size_t count = 400;
  FlightSamples samples;
  samples.name = "made";
  std::vector<Quantity> recorded = roles;
  for (const Quantity further :
       {Quantity::time, Quantity::static_pressure_rate, Quantity::dynamic_pressure_rate,
        Quantity::recovery_temperature_rate, Quantity::airspeed_rate, Quantity::wetness})
    recorded.push_back(further);
  for (std::size_t i = 0; i < count; ++i) samples.time.push_back(1321560000.0 + static_cast<double>(i));
  samples.motion.time = samples.time;
  double frequency = 0.05;
  for (const Quantity quantity : recorded) {
    const Swing swing = swing_of(quantity);
    std::vector<double> values;
    // Frequencies that have no ratio in common.
    frequency = 0.02 + std::fmod(frequency + 0.0618034, 0.3);
    for (std::size_t i = 0; i < count; ++i)
      values.push_back(swing.middle + swing.size * std::sin(frequency * static_cast<double>(i)));
    samples.model.columns.emplace_back(quantity, std::move(values));
  }
  samples.model.roles = recorded;
  if (const auto* altitude = samples.model.find(Quantity::altitude))
    samples.reference.columns = {{Quantity::altitude, *altitude}};
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  if (auto* laser = samples.model.find(Quantity::lams_airspeed)) {
    const std::vector<double>& p = *samples.model.find(Quantity::static_pressure);
    const std::vector<double>& q = *samples.model.find(Quantity::dynamic_pressure);
    for (std::size_t i = 0; i < count; ++i) {
      // Mach number and speed of sound of dry air, within what the mask allows of the laser.
      const double mach = std::sqrt(5.0 * (std::pow(q[i] / p[i] + 1.0, 2.0 / 7.0) - 1.0));
      const double recovery = (*samples.model.find(Quantity::recovery_temperature))[i];
      const double speed = mach * std::sqrt(1.4 * 287.0 * recovery / (1.0 + 0.19 * mach * mach));
      (*laser)[i] = speed + laser_noise * normal(engine);
    }
  }
  return samples;
}

/// A formula in addition to the catalogue, at another location than the ports and nonlinear in a quantity.
ModelEffect formula() {
  ModelEffect effect;
  effect.id = "try-1";
  effect.formula = "k * sin(roll / 10) + c * attack * mach";
  effect.parameter_names = {"k", "c"};
  effect.parameters = {0.0, 0.0};
  effect.location = pcor::EffectLocation::total_line;
  return effect;
}

struct Made {
  ModelDefinition model = laser_model();
  std::shared_ptr<const pcor::Reference> reference;
  CandidateSet set;
  std::shared_ptr<const FlightSamples> samples;
  FlightColumns columns;

  explicit Made(double laser_noise = 0.3,
                std::shared_ptr<const pcor::Reference> compared_with = pcor::lams_reference())
      : reference(std::move(compared_with)),
        set(find_candidates(model, {formula()}, {}, {reference})),
        samples(std::make_shared<const FlightSamples>(made_flight(set.extended.roles(), laser_noise))),
        columns(find_columns(samples, model, set, 0, {}, 1.0)) {}
};

/// The same samples with the laser at the model's airspeed.
std::shared_ptr<const FlightSamples> without_laser_noise(const Made& made) {
  const Residuals residuals(made.samples, made.model, *made.reference);
  auto samples = std::make_shared<FlightSamples>(*made.samples);
  *samples->model.find(Quantity::lams_airspeed) =
      residuals.predicted_sensor(residuals.parameters().data())->second;
  return samples;
}

std::vector<double> residual_of(const std::shared_ptr<const FlightSamples>& samples,
                                const ModelDefinition& model, const std::vector<double>& parameters,
                                const pcor::Reference& reference) {
  const Residuals residuals(samples, model, reference);
  std::vector<std::size_t> all(samples->time.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<double> values(all.size());
  residuals.evaluate_at_sensor(all, parameters.data(), {}, values.data(), nullptr);
  return values;
}

/// Columns of the first candidate with an effect.
Eigen::MatrixXf columns_of(const FlightColumns& columns, const CandidateSet& set, const std::string& effect) {
  std::size_t number = 0;
  while (set.candidates.at(number).effect.id != effect) ++number;
  return columns.candidates.middleCols(static_cast<Eigen::Index>(set.first_column(number)),
                                       static_cast<Eigen::Index>(set.candidates[number].tested.size()));
}

/// Compares a column with a centred difference of the residuals of `quiet`.
/// @param position of the coefficient among the parameters of `model`
void expect_difference(const Made& made, const std::shared_ptr<const FlightSamples>& quiet,
                       const ModelDefinition& model, std::size_t position, const Eigen::VectorXf& column,
                       const std::string& name) {
  std::vector<double> parameters;
  for (const ModelEffect& effect : model.model.effects)
    parameters.insert(parameters.end(), effect.parameters.begin(), effect.parameters.end());
  const double largest = static_cast<double>(column.cwiseAbs().maxCoeff());
  // A centred difference over 0.01 hPa: curvature below 1e-6 of the derivative, rounding below 1e-9.
  const double size = 0.01 / largest;
  const double middle = parameters[position];
  parameters[position] = middle + size;
  const std::vector<double> above = residual_of(quiet, model, parameters, *made.reference);
  parameters[position] = middle - size;
  const std::vector<double> below = residual_of(quiet, model, parameters, *made.reference);
  for (std::size_t i = 0; i < above.size(); i += 3) {
    if (std::isnan(made.columns.given[i])) continue;
    const double difference = -(above[i] - below[i]) / (2.0 * size);
    // Columns have the precision of a float, 6e-8.
    EXPECT_NEAR(static_cast<double>(column[static_cast<Eigen::Index>(i)]), difference, 2e-5 * largest)
        << name << " at " << i;
  }
}

/// Compares every column of a candidate with differences of residuals with the effect in the model. @return
/// the effects of which nothing reaches the residual
std::set<std::string> expect_differences(const Made& made,
                                         const std::shared_ptr<const FlightSamples>& quiet) {
  std::set<std::string> without_trace;
  EXPECT_GT(made.set.candidates.size(), 35U);
  Eigen::Index column = 0;
  for (const Candidate& candidate : made.set.candidates) {
    ModelDefinition with = made.model;
    with.model.effects.push_back(candidate.effect);
    with.fits.clear();
    for (const auto& [role, variable] : made.set.extended.variables) with.variables[role] = variable;
    for (const CandidateParameter& tested : candidate.tested) {
      const Eigen::VectorXf found = made.columns.candidates.col(column++);
      if (candidate.is_shared || candidate.memory != 0.0) continue;  // its column is made of one of these
      if (found.cwiseAbs().maxCoeff() == 0.0F) {
        without_trace.insert(candidate.effect.id);
      } else {
        expect_difference(made, quiet, with, parameter_count(made.model.model) + tested.index, found,
                          candidate.effect.id + "." + tested.name);
      }
    }
  }
  EXPECT_EQ(column, made.columns.candidates.cols());
  return without_trace;
}

}  // namespace

TEST(Columns, EqualFiniteDifferencesOfTheWholeChain) {
  const Made made;
  ASSERT_EQ(std::count(made.columns.mask.begin(), made.columns.mask.end(), pcor::Mask::none),
            static_cast<std::ptrdiff_t>(made.samples->time.size()));
  const std::set<std::string> without_trace = expect_differences(made, without_laser_noise(made));
  // All effects except one act here: there are no transonic speeds.
  EXPECT_THAT(without_trace, testing::ElementsAre("static-transonic"));
}

// The height holds a minute together, in which an effect is at each sample another.
TEST(Columns, HeightColumnsEqualFiniteDifferencesOverOneMinute) {
  const Made made(0.3, pcor::height_reference(laser_model()));
  EXPECT_EQ(made.columns.window, 60.0);
  const std::set<std::string> without_trace = expect_differences(made, made.samples);
  EXPECT_THAT(without_trace, testing::IsSupersetOf({"lams-scale", "lams-elevation", "static-transonic"}));
  for (const char* seen : {"temp-offset", "psfd-bias", "static-lag", "temp-lag", "recovery-factor", "try-1"})
    EXPECT_EQ(without_trace.count(seen), 0U) << seen;
}

TEST(Columns, HeightColumnsSkipMinutesWithUnusedSamples) {
  Made made(0.3, pcor::height_reference(laser_model()));
  auto samples = std::make_shared<FlightSamples>(*made.samples);
  samples->flaps.assign(samples->time.size(), 0.0);
  samples->flaps[200] = 30.0;  // percent
  const FlightColumns columns = find_columns(samples, made.model, made.set, 0, {}, 1.0);
  for (const std::size_t i : {35U, 169U, 231U, 365U}) EXPECT_FALSE(std::isnan(columns.given[i])) << i;
  for (const std::size_t i : {29U, 170U, 200U, 230U, 370U}) EXPECT_TRUE(std::isnan(columns.given[i])) << i;
}

TEST(Columns, BaseColumnsEqualFiniteDifferences) {
  const Made made;
  const std::shared_ptr<const FlightSamples> quiet = without_laser_noise(made);
  ASSERT_EQ(made.columns.base.cols(), 3);
  std::vector<std::string> base;
  for (const BaseCoefficient& coefficient : made.set.base) base.push_back(coefficient.name);
  EXPECT_THAT(base, testing::ElementsAre("static-constant.a0", "static-alpha.a1", "static-qp.a2"));
  for (std::size_t k = 0; k < 3; ++k)
    expect_difference(made, quiet, made.model, k, made.columns.base.col(static_cast<Eigen::Index>(k)),
                      base[k]);
}

TEST(Columns, FixedCoefficientsHaveNoColumn) {
  Made made;
  made.model.fits.resize(3);
  for (pcor::EffectFit& fit : made.model.fits) fit.resize(1);
  made.model.fits[1][0].fixed = true;
  made.set = find_candidates(made.model, {formula()}, {}, {made.reference});
  const FlightColumns columns = find_columns(made.samples, made.model, made.set, 0, {}, 1.0);
  EXPECT_EQ(columns.base.cols(), 2);
  EXPECT_TRUE(columns.base.col(1).isApprox(made.columns.base.col(2)));
}

// Such columns were zero, so the diagnosis did not see that the effects of the two systems are aliases.
TEST(Columns, EffectsAddToTheMinimumOfTheLaw) {
  const Made without;
  Made made;
  made.model.model.policy.minimum = 3.0;  // hPa, more than the law gives at many samples
  made.set = find_candidates(made.model, {}, {}, {made.reference});
  const FlightColumns columns = find_columns(made.samples, made.model, made.set, 0, {}, 1.0);
  const Eigen::VectorXf expected = columns_of(without.columns, without.set, "static-alpha-quad").col(0);
  const Eigen::VectorXf found = columns_of(columns, made.set, "static-alpha-quad").col(0);
  std::size_t at_minimum = 0;
  for (Eigen::Index i = 0; i < found.size(); ++i) {
    if (columns.base.row(i).cwiseAbs().maxCoeff() > 0.0F) continue;
    ++at_minimum;
    // The air is that of another delta-p: up to 3 hPa of at least 50 hPa.
    EXPECT_NEAR(found[i], expected[i], 0.1F * std::abs(expected[i])) << i;
  }
  EXPECT_GT(at_minimum, 50U);
}

// Otherwise laser noise would be explained by columns that contain it.
TEST(Columns, ExcludeLaserNoise) {
  const Made quiet(0.0);
  const Made noisy(0.5);
  double change = 0.0;
  for (std::size_t i = 0; i < quiet.columns.given.size(); ++i)
    change = std::max(change, std::abs(quiet.columns.given[i] - noisy.columns.given[i]));
  EXPECT_GT(change, 0.5);
  ASSERT_EQ(quiet.columns.candidates.cols(), noisy.columns.candidates.cols());
  for (Eigen::Index c = 0; c < quiet.columns.candidates.cols(); ++c) {
    // The precision of floats, and of the speed that the model predicts.
    EXPECT_LE((quiet.columns.candidates.col(c) - noisy.columns.candidates.col(c)).cwiseAbs().maxCoeff(),
              1e-6F * quiet.columns.candidates.col(c).cwiseAbs().maxCoeff())
        << c;
  }
  EXPECT_TRUE(quiet.columns.base.isApprox(noisy.columns.base, 1e-6F));
}

TEST(Columns, ResidualsEqualThoseOfTheModel) {
  const Made made;
  const Residuals residuals(made.samples, made.model, *made.reference);
  EXPECT_EQ(made.columns.given,
            residual_of(made.samples, made.model, residuals.parameters(), *made.reference));
  // The pressure of the model is that of its chain.
  EXPECT_EQ(made.columns.corrected_pressure,
            residuals.quantity(Quantity::corrected_static_pressure, residuals.parameters().data()));
  EXPECT_EQ(made.columns.quantity(Quantity::attack), *made.samples->model.find(Quantity::attack));
  EXPECT_TRUE(made.columns.quantity(Quantity::cabin_pressure).empty());
}

TEST(Columns, SamplesAfterTheFirstPartAreMissing) {
  Made made;
  const FlightColumns half = find_columns(made.samples, made.model, made.set, 0, {}, 0.5);
  for (std::size_t i = 0; i < half.given.size(); ++i) {
    EXPECT_EQ(std::isnan(half.given[i]), i >= 200) << i;
  }
  EXPECT_TRUE(half.candidates.topRows(200).isApprox(made.columns.candidates.topRows(200), 1e-6F));
}

TEST(Columns, OnlyShortGapsAreBridged) {
  Made made;
  const auto with_gap = [&](std::size_t gap) {
    auto samples = std::make_shared<FlightSamples>(*made.samples);
    std::fill_n(samples->model.find(Quantity::cabin_pressure)->begin() + 100, gap, std::nan(""));
    const FlightColumns columns = find_columns(samples, made.model, made.set, 0, {}, 1.0);
    // The model itself does not need the cabin.
    EXPECT_EQ(std::count(columns.mask.begin(), columns.mask.end(), pcor::Mask::none), 400);
    return Eigen::VectorXf(columns_of(columns, made.set, "static-leak").col(0));
  };
  const Eigen::VectorXf few = with_gap(30);
  EXPECT_TRUE(few.allFinite());
  EXPECT_EQ(few[115], few[99]);
  EXPECT_FALSE(with_gap(60).allFinite());
}

// Such a column was NaN, and the candidate was dropped because of an input that does not matter.
TEST(Columns, AreZeroWhereTheReferenceSeesNothing) {
  const Made made;
  ModelEffect effect = formula();
  effect.location = pcor::EffectLocation::temperature;
  const pcor::References references{made.reference, pcor::pressure_reference("PS")};
  const CandidateSet set = find_candidates(made.model, {effect}, {}, references);
  auto samples = std::make_shared<FlightSamples>(*made.samples);
  samples->reference.columns = {
      {Quantity::corrected_static_pressure, *samples->model.find(Quantity::static_pressure)}};
  std::fill_n(samples->model.find(Quantity::roll)->begin() + 100, 100, std::nan(""));
  const FlightColumns columns = find_columns(samples, made.model, set, 1, {}, 1.0);
  EXPECT_GT(std::count(columns.mask.begin() + 100, columns.mask.begin() + 200, pcor::Mask::none), 0);
  EXPECT_EQ(columns_of(columns, set, effect.id).cwiseAbs().sum(), 0.0F);
}
