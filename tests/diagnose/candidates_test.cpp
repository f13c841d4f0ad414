// Which effects can be tested on some flights.
#include "diagnose/candidates.hpp"

#include <gmock/gmock.h>
#include <pcor/effects/catalogue.hpp>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "campaign/columns.hpp"
#include "campaign/model_parameters.hpp"
#include "support/short_flight.hpp"

using pcor::ModelDefinition;
using pcor::ModelEffect;
using pcor::NotTestable;
using pcor::Quantity;
using pcor::internal::Candidate;
using pcor::internal::CandidateSet;
using pcor::test::laser_model;
using pcor::test::short_flight;
using testing::HasSubstr;

namespace {

/// A formula in addition to the catalogue, at another location than the ports and nonlinear in a quantity.
ModelEffect total_line_formula() {
  ModelEffect effect;
  effect.id = "try-1";
  effect.formula = "k * sin(roll / 10) + c * attack * mach";
  effect.parameter_names = {"k", "c"};
  effect.parameters = {0.0, 0.0};
  effect.location = pcor::EffectLocation::total_line;
  return effect;
}

const NotTestable* reason_for(const CandidateSet& set, const std::string& effect) {
  for (const NotTestable& each : set.not_testable) {
    if (each.effect == effect) return &each;
  }
  return nullptr;
}

bool has_candidate(const CandidateSet& set, const std::string& effect) {
  return std::any_of(set.candidates.begin(), set.candidates.end(),
                     [&](const Candidate& candidate) { return candidate.effect.id == effect; });
}

CandidateSet candidates_of_file(const ModelDefinition& model, const std::vector<ModelEffect>& formulas = {}) {
  return pcor::internal::find_candidates(model, formulas, {short_flight()}, {pcor::lams_reference()});
}

}  // namespace

TEST(Candidates, BaseExcludesSurfaceParameters) {
  ModelDefinition model = laser_model();
  const std::size_t terms = pcor::internal::free_parameters(model).size();
  model.model.effects.push_back(pcor::surface_effect(
      "static-surface", {{{Quantity::attack_ratio, -0.4, 0.0, 6}, {Quantity::mach, 0.2, 0.5, 6}}}));
  EXPECT_EQ(pcor::internal::free_parameters(model).size(), terms);
  const CandidateSet set = candidates_of_file(model);
  EXPECT_EQ(set.base.size(), terms);
  // Columns of every free parameter fit into the matrix of the base.
  const auto samples = std::make_shared<const pcor::FlightSamples>(
      pcor::read_samples(pcor::Flight(short_flight()), set.extended, *pcor::lams_reference(), {}));
  const pcor::internal::FlightColumns columns = pcor::internal::find_columns(samples, model, set, 0, {}, 1.0);
  EXPECT_EQ(static_cast<std::size_t>(columns.base.cols()), terms);
}

TEST(Candidates, AreTheCatalogueEffectsMissingFromTheModel) {
  const CandidateSet set = candidates_of_file(laser_model());
  for (const char* id : {"static-constant", "static-alpha", "static-qp"}) {
    EXPECT_FALSE(has_candidate(set, id));
    EXPECT_EQ(reason_for(set, id), nullptr);
  }
  std::size_t effects = 0;
  for (const Candidate& candidate : set.candidates) effects += candidate.is_variant ? 0 : 1;
  EXPECT_EQ(effects + set.not_testable.size() + 3, pcor::catalogue_size);
  for (const Candidate& candidate : set.candidates) {
    const pcor::EffectInfo& info = *pcor::effect_named(candidate.effect.id);
    EXPECT_FALSE(candidate.tested.empty());
    for (const pcor::internal::CandidateParameter& parameter : candidate.tested) {
      EXPECT_FALSE(info.parameters[parameter.index].shape);
      EXPECT_EQ(candidate.effect.parameters[parameter.index], info.parameters[parameter.index].neutral);
      EXPECT_LE(parameter.bounds.lower, 0.0) << candidate.effect.id;
      EXPECT_GE(parameter.bounds.upper, 0.0) << candidate.effect.id;
    }
  }
}

TEST(Candidates, EffectsWithAShapeAreTriedInSeveralShapes) {
  const CandidateSet set = candidates_of_file(laser_model());
  std::vector<double> onsets;
  for (const Candidate& candidate : set.candidates) {
    if (candidate.effect.id != "static-transonic") continue;
    EXPECT_EQ(candidate.is_variant, !onsets.empty());
    onsets.push_back(candidate.effect.parameters[1]);
  }
  ASSERT_GE(onsets.size(), 3U);
  EXPECT_EQ(onsets.front(), 0.82);
  for (const double onset : onsets) {
    EXPECT_GT(onset, 0.7);
    EXPECT_LT(onset, 0.95);
  }
}

TEST(Candidates, UseTheUsualVariables) {
  const CandidateSet set = candidates_of_file(laser_model());
  const std::map<Quantity, std::string>& variables = set.extended.variables;
  EXPECT_EQ(variables.at(Quantity::cabin_pressure), "PCAB");
  EXPECT_EQ(variables.at(Quantity::transducer_temperature), "TBAY");
  EXPECT_EQ(variables.at(Quantity::sideslip_differential_pressure), "BDIFR");
  // Variables named in the model stay.
  EXPECT_EQ(variables.at(Quantity::static_pressure), "PSFD");
  EXPECT_EQ(variables.at(Quantity::recovery_temperature), "TTRR");
}

TEST(Candidates, WithoutTheirInputsAreNotTestable) {
  const CandidateSet set = candidates_of_file(laser_model());
  const NotTestable* torque = reason_for(set, "speedbrake-thrust");
  ASSERT_NE(torque, nullptr);
  EXPECT_THAT(torque->reason, HasSubstr("engine_torque"));
  ModelDefinition named = laser_model();
  named.variables[Quantity::engine_torque] = "ENGTRQ";
  EXPECT_TRUE(has_candidate(candidates_of_file(named), "speedbrake-thrust"));
}

TEST(Candidates, HumidityEffectsDependOnTheGasConstants) {
  const CandidateSet moist = candidates_of_file(laser_model());
  ASSERT_NE(reason_for(moist, "humidity-neglected"), nullptr);
  EXPECT_THAT(reason_for(moist, "humidity-neglected")->reason, HasSubstr("moist"));
  EXPECT_TRUE(has_candidate(moist, "humidity-error"));
  ModelDefinition model = laser_model();
  model.model.moist = false;
  const CandidateSet dry = candidates_of_file(model);
  ASSERT_NE(reason_for(dry, "humidity-error"), nullptr);
  EXPECT_THAT(reason_for(dry, "humidity-error")->reason, HasSubstr("dry"));
  EXPECT_TRUE(has_candidate(dry, "humidity-neglected"));
}

TEST(Candidates, OtherSystemsHaveOneCandidateEach) {
  const pcor::FlightSet files{short_flight()};
  const auto number_of = [&files](const std::vector<std::string>& others, const std::string& id) {
    pcor::References references{pcor::lams_reference()};
    for (const std::string& other : others) references.push_back(pcor::read_reference(other, laser_model()));
    for (const Candidate& candidate :
         pcor::internal::find_candidates(laser_model(), {}, files, references).candidates) {
      if (candidate.id == id) return candidate.numbers_in_others;
    }
    return std::vector<std::optional<std::size_t>>();
  };
  const std::string pair = "total:PSFRD+QCFR";
  const std::string avionics = "total:PS_A+QC_A";
  EXPECT_TRUE(number_of({pair}, "reference:psfd-bias")[1]);
  EXPECT_THAT(number_of({pair, avionics}, "reference:psfd-bias"), testing::IsEmpty());
  const auto of_pair = number_of({pair, avionics}, "reference:PSFRD+QCFR:psfd-bias");
  ASSERT_THAT(of_pair, testing::SizeIs(3));
  EXPECT_TRUE(of_pair[1]);
  EXPECT_FALSE(of_pair[2]);
  const auto of_avionics = number_of({pair, avionics}, "reference:PS_A+QC_A:psfd-bias");
  ASSERT_THAT(of_avionics, testing::SizeIs(3));
  EXPECT_FALSE(of_avionics[1]);
  EXPECT_TRUE(of_avionics[2]);
  // Two references of one system share its effects, for any law in either reference.
  const std::string law = std::string("static:") + PCOR_SOURCE_DIR + "/data/models/c130-psfrd-eq18.toml";
  const auto of_both = number_of({law, pair}, "reference:psfd-bias");
  ASSERT_THAT(of_both, testing::SizeIs(3));
  EXPECT_TRUE(of_both[1]);
  EXPECT_TRUE(of_both[2]);
}

TEST(Candidates, FormulasNeedTheirVariables) {
  ModelEffect good = total_line_formula();
  ModelEffect bad = total_line_formula();
  bad.id = "try-2";
  bad.formula = "k * NO_SUCH_VARIABLE + c";
  const CandidateSet set = candidates_of_file(laser_model(), {good, bad});
  EXPECT_TRUE(has_candidate(set, "try-1"));
  ASSERT_NE(reason_for(set, "try-2"), nullptr);
  EXPECT_THAT(reason_for(set, "try-2")->reason, HasSubstr("has no variable NO_SUCH_VARIABLE"));
  // One that the model has is part of the model.
  ModelDefinition with = laser_model();
  with.model.effects.push_back(good);
  EXPECT_FALSE(has_candidate(candidates_of_file(with, {good}), "try-1"));
}
