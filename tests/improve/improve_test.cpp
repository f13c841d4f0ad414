#include <gmock/gmock.h>
#include <pcor/base/error.hpp>
#include <pcor/roles/add_effects.hpp>

#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "diagnose/rms.hpp"
#include "improve/improve_loop.hpp"
#include "improve/rival_choice.hpp"
#include "numerics/missing.hpp"
#include "support/synthetic_samples.hpp"

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

namespace pcor::internal {
namespace {

/// A loop with invented fits: fit number i leaves the held-out rms number i, and after it comes
/// diagnosis number i.
class Improve : public testing::Test {
 protected:
  Improve() {
    loop_.has_holdout = true;
    loop_.flights = "one.nc";
    loop_.refit = [this](const TrialModel& model) { return fitted(model.file); };
    loop_.diagnose = [this](const TrialModel&) {
      const Diagnosis next = diagnoses_.front();
      if (diagnoses_.size() > 1) diagnoses_.pop_front();
      return next;
    };
    loop_.add = [](const TrialModel& model, const AddedEffect& added) {
      return TrialModel{add_effects(model.file, {added.effect})};
    };
    loop_.try_models = [this](const std::vector<TrialModel>& models) { return tried(models); };
  }

  RefitResult fitted(const ModelDefinition& model) {
    RefitResult fit;
    fit.model = model;
    fit.model.law.rms_hpa = rms_.front();
    fit.rms = rms_.front() - 0.01;
    fit.noise_rms = rms_.front() / 2.0;
    for (const ModelEffect& effect : model.model.effects) {
      for (const std::string& name : parameter_names(effect))
        fit.parameters.push_back({effect.id + "." + name, "s", 0.0, 0.25, 0.02, 0.0, 0.0, true});
    }
    FlightFit training;
    training.after.samples = 1000;
    training.after.rms = 99.0;
    FlightFit held = training;
    held.holdout = true;
    held.after.rms = rms_.front();
    fit.flights = {training, held};
    if (rms_.size() > 1) rms_.pop_front();
    return fit;
  }

  /// A flight of half an hour, and a held-out flight, with the rms stated by the fit of a model, and static
  /// pressures that its effects change by `changes_`.
  std::vector<TrialFlight> tried(const std::vector<TrialModel>& models) {
    auto samples = std::make_shared<FlightSamples>();
    samples->name = "made.nc";
    for (std::size_t i = 0; i < 1800; ++i) samples->time.push_back(static_cast<double>(i));
    samples->step = 1.0;
    TrialFlight flight;
    flight.samples = samples;
    // Noise of an rms of exactly one.
    std::mt19937_64 engine(1);
    std::normal_distribution<double> normal;
    std::vector<double> noise;
    for (std::size_t i = 0; i < samples->time.size(); ++i) {
      flight.fitted.push_back(i);
      noise.push_back(normal(engine));
    }
    const double rms = square_sum_of(noise).rms();
    for (double& value : noise) value /= rms;
    for (const auto& [model, shared_effects] : models) {
      for (double& value : flight.residuals.emplace_back(noise))
        value *= model.law.rms_hpa.value_or(given_rms_);
      double change = 0.0;
      for (const ModelEffect& effect : model.model.effects) change += changes_[effect.id];
      flight.static_pressures.emplace_back(noise.size(), 700.0 + change);
    }
    std::vector<TrialFlight> flights{flight};
    if (loop_.has_holdout) {
      std::swap(flight.fitted, flight.held_out);
      if (!held_out_tells_) flight.residuals.assign(models.size(), noise);
      flights.push_back(flight);
    }
    return flights;
  }

  Improvement run(std::deque<Diagnosis> diagnoses, std::deque<double> rms = {1.0}) {
    diagnoses_ = std::move(diagnoses);
    rms_ = std::move(rms);
    return loop_.run(made::model({"static-constant", "static-qp"}));
  }

  ImproveLoop loop_;
  std::deque<double> rms_;
  std::deque<Diagnosis> diagnoses_;
  double given_rms_ = 1.0;
  bool held_out_tells_ = true;             // the held-out flight knows one model from another
  std::map<std::string, double> changes_;  // change of the static pressure by effects, hPa
};

Diagnosis diagnosis(Verdict verdict, const std::vector<std::string>& findings = {}) {
  Diagnosis result;
  result.verdict = verdict;
  for (const std::string& id : findings) {
    Finding& finding = result.findings.emplace_back();
    finding.effect = neutral_effect(id);
    finding.title = "title of " + id;
    finding.chi2_reduction = 100.0;
    finding.chi2_reduction_error = 20.0;
  }
  return result;
}

Diagnosis with_predictor(Diagnosis result, const std::string& variable) {
  EmpiricalPredictor predictor;
  predictor.name = variable;
  predictor.slope = -0.03;
  predictor.formula = "k * (" + variable + " - 48)";
  result.unexplained.significant = true;
  result.unexplained.rms = 0.4;
  result.unexplained.regime = "climb";
  result.unexplained.variables.push_back(predictor);
  return result;
}

std::vector<std::string> added(const Improvement& improvement) {
  std::vector<std::string> names;
  for (const ImproveStep& step : improvement.steps) names.push_back(step.added);
  return names;
}

std::vector<std::string> effects(const ModelDefinition& model) {
  std::vector<std::string> ids;
  for (const ModelEffect& effect : model.model.effects) ids.push_back(effect.id);
  return ids;
}

TEST_F(Improve, StopsIfNoEffectIsMissing) {
  Diagnosis none_detected = diagnosis(Verdict::none_detected);
  none_detected.limits.resize(7);
  for (UpperLimit& limit : none_detected.limits) limit.chi2_at_usual_size = none_detected.threshold + 1.0;
  none_detected.limits[0].chi2_at_usual_size = 0.0;
  const Improvement improvement = run({none_detected});
  EXPECT_THAT(improvement.stop_explanation, HasSubstr("6 of 7")) << "diagnose prints the same numbers";
  EXPECT_THAT(added(improvement), ElementsAre(""));
  EXPECT_EQ(improvement.stop_reason, StopReason::nothing_missing);
  EXPECT_EQ(improvement.steps[0].terms, 2U);
  EXPECT_DOUBLE_EQ(improvement.steps[0].rms_train, 0.99);
  EXPECT_DOUBLE_EQ(improvement.steps[0].rms_holdout, 1.0);
  EXPECT_TRUE(improvement.holdout_is_flights);
}

TEST_F(Improve, JudgesAHeldOutFlightAsOneOfAll) {
  loop_.refit = [this](const TrialModel& model) {
    RefitResult fit = fitted(model.file);
    fit.flights.push_back(fit.flights.back());
    return fit;
  };
  const Improvement improvement = run({diagnosis(Verdict::none_detected)});
  const std::vector<HeldOutPart>& held_out = improvement.steps[0].diagnosis.held_out;
  ASSERT_EQ(held_out.size(), 2U);
  for (const HeldOutPart& part : held_out) EXPECT_EQ(part.parts, 2U);
}

TEST_F(Improve, AddsAnIdentifiedEffect) {
  const Improvement improvement =
      run({diagnosis(Verdict::identified, {"static-lag"}), diagnosis(Verdict::none_detected)}, {1.0, 0.5});
  EXPECT_THAT(added(improvement), ElementsAre("", "static-lag"));
  EXPECT_THAT(effects(improvement.model), ElementsAre("static-constant", "static-qp", "static-lag"));
  EXPECT_THAT(improvement.steps[1].title, "title of static-lag");
  EXPECT_THAT(improvement.steps[1].summary, HasSubstr("tau = 0.25 +- 0.02 s"));
  EXPECT_EQ(improvement.steps[1].terms, 3U);
  EXPECT_EQ(improvement.steps[1].diagnosis.verdict, Verdict::none_detected);
  EXPECT_EQ(improvement.stop_reason, StopReason::nothing_missing);
}

TEST_F(Improve, ByGpsAloneAnEffectMustDifferFromZeroByThreeErrors) {
  loop_.has_holdout = false;
  loop_.is_by_gps = true;
  // Parameters of the fits are 0.25 with this standard error.
  for (const auto& [error, is_added] : {std::pair(0.08, true), std::pair(0.09, false)}) {
    loop_.refit = [this, error = error](const TrialModel& model) {
      RefitResult fit = fitted(model.file);
      for (FittedParameter& parameter : fit.parameters) parameter.standard_error = error;
      return fit;
    };
    Diagnosis found = diagnosis(Verdict::identified, {"static-lag"});
    Diagnosis none_detected = diagnosis(Verdict::none_detected);
    found.residual_rms_held_out = 1.0;
    none_detected.residual_rms_held_out = 0.9;
    EXPECT_EQ(run({found, none_detected}).steps.size(), is_added ? 2U : 1U) << error;
  }
}

// A formula has no neutral start: a fit by GPS alone starts it at the estimate of the diagnosis.
TEST_F(Improve, ByGpsAloneAFormulaIsComparedWithZero) {
  loop_.is_by_gps = true;
  loop_.refit = [this](const TrialModel& model) {
    RefitResult fit = fitted(model.file);
    for (FittedParameter& parameter : fit.parameters) parameter.start = parameter.value;
    return fit;
  };
  Diagnosis found = diagnosis(Verdict::identified);
  ModelEffect& effect = found.findings.emplace_back().effect;
  effect.id = "try-1";
  effect.parameter_names = {"k"};
  effect.parameters = {0.25};
  effect.formula = "k * mach";
  found.findings[0].chi2_reduction = 100.0;
  found.findings[0].chi2_reduction_error = 20.0;
  EXPECT_THAT(added(run({found, diagnosis(Verdict::none_detected)}, {1.0, 0.5})), ElementsAre("", "try-1"));
}

TEST_F(Improve, ByGpsAloneAnEffectOfAnImpossibleSizeIsNotAdded) {
  Diagnosis found = diagnosis(Verdict::ambiguous, {"static-lag"});
  for (const auto& [relative_size, by_gps, steps] :
       {std::tuple{19.0, true, 2U}, {21.0, true, 1U}, {21.0, false, 2U}}) {
    loop_.is_by_gps = by_gps;
    found.findings[0].relative_size = relative_size;
    EXPECT_EQ(run({found, diagnosis(Verdict::none_detected)}, {1.0, 0.5}).steps.size(), steps)
        << relative_size;
  }
}

TEST_F(Improve, AddsEachFindingInItsOwnStep) {
  EXPECT_THAT(added(run({diagnosis(Verdict::identified, {"static-lag", "static-mach"}),
                         diagnosis(Verdict::identified, {"static-mach2"}), diagnosis(Verdict::none_detected)},
                        {1.0, 0.7, 0.5})),
              ElementsAre("", "static-lag", "static-mach"));
}

TEST_F(Improve, ListsEffectsThatAreNotSeparable) {
  Diagnosis ambiguous = diagnosis(Verdict::ambiguous, {"static-lag"});
  ambiguous.findings[0].aliases = {{}, {}};
  ambiguous.findings[0].aliases[0].effect = "temp-lag";
  ambiguous.findings[0].aliases[1].effect = "total-lag";
  ambiguous.findings[0].advice.sentence = "fly two climbs";
  const Improvement improvement = run({ambiguous, diagnosis(Verdict::none_detected)}, {1.0, 0.5});
  EXPECT_THAT(improvement.steps[1].aliases, ElementsAre("temp-lag", "total-lag"));
  EXPECT_THAT(improvement.steps[1].summary, HasSubstr("temp-lag, total-lag: fly two climbs"));
}

TEST_F(Improve, DropsAnEffectThatRaisesTheHeldOutResidual) {
  for (const double rms : {1.0051, 1.0001}) {
    const Improvement improvement =
        run({diagnosis(Verdict::identified, {"static-lag", "static-mach"})}, {1.0, rms});
    EXPECT_THAT(added(improvement), ElementsAre(""));
    EXPECT_THAT(effects(improvement.model), ElementsAre("static-constant", "static-qp"));
    EXPECT_EQ(improvement.stop_reason, StopReason::no_gain);
    EXPECT_THAT(improvement.stop_explanation, HasSubstr("static-lag"));
    EXPECT_DOUBLE_EQ(improvement.fit.flights[1].after.rms, 1.0);
  }
}

// The two models are compared on the samples of the larger fit: the diagnosis of the extended model does not
// count, and an accepted model has one.
TEST_F(Improve, ModelOfMoreSamplesIsDiagnosedIfAccepted) {
  loop_.has_holdout = false;
  loop_.refit = [this](const TrialModel& model) {
    RefitResult fit = fitted(model.file);
    fit.samples = 1000 + model.file.model.effects.size();
    return fit;
  };
  std::size_t diagnoses = 0;
  loop_.diagnose = [&diagnoses](const TrialModel&) {
    ++diagnoses;
    Diagnosis found = diagnosis(Verdict::partial, {"flaps-gear"});
    found.residual_rms_held_out = 0.7;
    return found;
  };
  const Improvement rejected = run({}, {1.0, 0.995});
  EXPECT_THAT(added(rejected), ElementsAre(""));
  EXPECT_EQ(rejected.stop_reason, StopReason::no_gain);
  EXPECT_EQ(diagnoses, 1U);
  const Improvement kept = run({}, {1.0, 0.5});
  EXPECT_THAT(added(kept), ElementsAre("", "flaps-gear"));
  EXPECT_EQ(diagnoses, 3U);
  EXPECT_EQ(kept.steps[1].diagnosis.verdict, Verdict::partial);
  EXPECT_DOUBLE_EQ(kept.steps[1].rms_holdout, 0.7);
}

TEST_F(Improve, RefusedFindingIsFollowedByTheOthers) {
  const Improvement improvement =
      run({diagnosis(Verdict::identified, {"static-lag", "static-mach"}), diagnosis(Verdict::none_detected)},
          {1.0, 1.1, 0.5});
  EXPECT_THAT(added(improvement), ElementsAre("", "static-mach"));
  EXPECT_EQ(improvement.stop_reason, StopReason::nothing_missing);
  ASSERT_EQ(improvement.fit.notes.size(), 1U);
  EXPECT_THAT(improvement.fit.notes[0].text, HasSubstr("rejected: static-lag"));
}

TEST_F(Improve, RefusedFindingThatIsAddedLaterHasNoNote) {
  const Improvement improvement =
      run({diagnosis(Verdict::identified, {"static-lag", "static-mach"}),
           diagnosis(Verdict::identified, {"static-lag"}), diagnosis(Verdict::none_detected)},
          {1.0, 1.1, 0.7, 0.5});
  EXPECT_THAT(added(improvement), ElementsAre("", "static-mach", "static-lag"));
  EXPECT_THAT(improvement.fit.notes, testing::IsEmpty());
}

TEST_F(Improve, FindingsOfTheLastDiagnosisAreTriedBeforeTheEnd) {
  const Improvement improvement =
      run({diagnosis(Verdict::identified, {"static-lag", "static-mach"}),
           diagnosis(Verdict::identified, {"static-mach2"}), diagnosis(Verdict::none_detected)},
          {1.0, 0.7, 0.8, 0.5});
  EXPECT_THAT(added(improvement), ElementsAre("", "static-lag", "static-mach2"));
  EXPECT_EQ(improvement.stop_reason, StopReason::nothing_missing);
}

TEST_F(Improve, RefusedFindingDoesNotCountAsAStep) {
  loop_.max_steps = 1;
  EXPECT_THAT(added(run({diagnosis(Verdict::identified, {"static-lag", "static-mach"}),
                         diagnosis(Verdict::none_detected)},
                        {1.0, 1.1, 0.5})),
              ElementsAre("", "static-mach"));
}

/// A diagnosis that cannot separate two effects; the first is present with `probability`.
Diagnosis two_rivals(const std::string& one, const std::string& other, double probability) {
  Diagnosis unclear = diagnosis(Verdict::ambiguous, {one});
  Alias alias;
  alias.effect = other;
  alias.probability = 1.0 - probability;
  if (other.find(':') == std::string::npos) alias.correction = neutral_effect(other);
  unclear.findings[0].aliases = {alias};
  unclear.findings[0].probability = probability;
  unclear.findings[0].advice.sentence = "fly a yaw manoeuvre";
  return unclear;
}

TEST_F(Improve, ChoosesTheRivalOfMinimumExpectedError) {
  changes_ = {{"static-lag", 0.8}, {"total-lag", 1.2}};
  const Improvement improvement =
      run({two_rivals("static-lag", "total-lag", 0.75), diagnosis(Verdict::none_detected)}, {1.0, 0.5});
  const ImproveStep& step = improvement.steps[1];
  ASSERT_EQ(step.rivals.size(), 2U);
  EXPECT_EQ(step.rivals[0].effect, "static-lag");
  EXPECT_DOUBLE_EQ(step.rivals[1].probability, 0.25);
  EXPECT_NEAR(step.rivals[1].static_change, 1.2, 1e-9);
  EXPECT_EQ(step.delivered, "static-lag");
  EXPECT_NEAR(step.rival_error, 0.4 * std::sqrt(0.25), 1e-9);
  EXPECT_THAT(effects(improvement.model), ElementsAre("static-constant", "static-qp", "static-lag"));
  EXPECT_GE(improvement.model.uncertainty.static_defect.value_or(0.0), step.rival_error);
  EXPECT_EQ(write_model(parse_model(write_model(improvement.model), "it")), write_model(improvement.model));
}

TEST_F(Improve, EqualRivalsKeepTheNamedEffect) {
  changes_ = {{"static-lag", 0.8}, {"total-lag", 0.81}};  // hPa, at a noise of 0.25
  const Improvement improvement =
      run({two_rivals("static-lag", "total-lag", 0.75), diagnosis(Verdict::none_detected)}, {1.0, 0.5});
  EXPECT_THAT(improvement.steps[1].rivals, testing::IsEmpty());
  EXPECT_THAT(effects(improvement.model), ElementsAre("static-constant", "static-qp", "static-lag"));
}

TEST_F(Improve, AppliesNoRivalIfAnotherMakesItHarmful) {
  changes_ = {{"static-lag", 0.8}, {"total-lag", -0.6}};
  const Improvement improvement =
      run({two_rivals("static-lag", "total-lag", 0.75), diagnosis(Verdict::none_detected)}, {1.0, 0.5});
  EXPECT_EQ(improvement.steps[1].delivered, "");
  EXPECT_THAT(effects(improvement.model), ElementsAre("static-constant", "static-qp"));
  EXPECT_NEAR(improvement.steps[1].rival_error, std::sqrt(0.75 * 0.64 + 0.25 * 0.36), 1e-9);
}

/// A surface that reduces the residual outside its fit.
SurfaceOffer helpful_surface(const TrialModel& model) {
  SurfaceOffer offer;
  offer.model = model;
  offer.compared.rms_before = 1.0;
  offer.compared.rms_after = 0.5;
  offer.compared.chi2_reduction = 100.0;
  return offer;
}

TEST_F(Improve, SurfaceThatCannotBeFittedIsNotAdded) {
  loop_.offer_surface = helpful_surface;
  std::size_t fits = 0;
  loop_.refit = [&](const TrialModel& model) {
    if (fits++ > 0) throw Error(Error::Code::fit, "not determined");
    return fitted(model.file);
  };
  const Improvement improvement = run({diagnosis(Verdict::unexplained)});
  EXPECT_EQ(improvement.steps.size(), 1U);
  EXPECT_EQ(improvement.model.model.effects.size(), 2U);
  EXPECT_THAT(improvement.stop_explanation, HasSubstr("not determined"));
}

// Against other systems alone a surface is as probable on either.
TEST_F(Improve, SurfaceThatMayBeOfTheReferenceIncreasesTheStatedError) {
  for (const bool may_be_of_reference : {false, true}) {
    loop_.offer_surface = [may_be_of_reference](const TrialModel& model) {
      SurfaceOffer offer = helpful_surface(model);
      offer.static_change = 0.4;
      offer.may_be_of_reference = may_be_of_reference;
      return offer;
    };
    const Improvement improvement = run({diagnosis(Verdict::unexplained)});
    ASSERT_EQ(improvement.steps.size(), 2U);
    const double expected = may_be_of_reference ? 0.4 * std::sqrt(0.5) : 0.0;
    EXPECT_DOUBLE_EQ(improvement.steps[1].rival_error, expected);
    EXPECT_EQ(improvement.steps[1].rivals.size(), may_be_of_reference ? 2U : 0U);
    EXPECT_EQ(improvement.steps[1].delivered, improvement.steps[1].added);
    EXPECT_DOUBLE_EQ(improvement.model.uncertainty.static_defect.value_or(0.0), expected);
  }
}

// A drift of either system cannot be added, and a surface of the attack would imitate it on these flights.
TEST_F(Improve, SurfaceDoesNotReplaceALargerEffectOfAnotherKind) {
  loop_.offer_surface = helpful_surface;
  for (const bool attack_is_larger : {false, true}) {
    Diagnosis both = diagnosis(Verdict::identified, {"time-drift", "static-alpha-quad"});
    both.findings[0].of_reference = both.findings[1].of_reference = true;
    both.findings[0].family = "drift";
    both.findings[0].rms = 0.2;
    both.findings[1].family = "attack";
    both.findings[1].rms = attack_is_larger ? 0.3 : 0.001;
    const Improvement improvement = run({both});
    EXPECT_EQ(improvement.steps.size(), attack_is_larger ? 2U : 1U);
  }
}

TEST_F(Improve, RivalsThatCannotBeFittedTogetherAreNotApplied) {
  changes_ = {{"static-lag", 0.8}, {"total-lag", 1.2}, {"static-mach", 0.8}, {"static-mach2", 1.2}};
  loop_.refit = [this](const TrialModel& trial) {
    if (has_effect(trial.file, "total-lag") && has_effect(trial.file, "static-mach2"))
      throw Error(Error::Code::fit, "these cannot be free together");
    return fitted(trial.file);
  };
  for (const bool is_surface_offered : {false, true}) {
    if (is_surface_offered) loop_.offer_surface = helpful_surface;
    const Improvement improvement =
        run({two_rivals("static-lag", "total-lag", 0.25), two_rivals("static-mach", "static-mach2", 0.25),
             diagnosis(Verdict::unexplained)},
            {1.0, 0.7, 0.5});
    EXPECT_EQ(improvement.steps.size(), is_surface_offered ? 4U : 3U);
    EXPECT_THAT(effects(improvement.model),
                ElementsAre("static-constant", "static-qp", "static-lag", "static-mach"));
    for (const std::size_t step : {1U, 2U}) {
      EXPECT_EQ(improvement.steps[step].delivered, improvement.steps[step].added);
      // The first of the rivals differs from the other, of probability 0.75, by 0.4 hPa.
      EXPECT_NEAR(improvement.steps[step].rival_error, 0.4 * std::sqrt(0.75), 1e-9);  // rounding
    }
    ASSERT_EQ(improvement.fit.notes.size(), 1U);
    EXPECT_THAT(improvement.fit.notes[0].text, HasSubstr("these cannot be free together"));
  }
}

TEST_F(Improve, KeepsTheModelIfTheReferenceMayBeWrong) {
  const Improvement improvement = run({two_rivals("psfd-bias", "reference:psfd-bias", 0.6)});
  EXPECT_THAT(added(improvement), ElementsAre(""));
  EXPECT_THAT(improvement.stop_explanation, AllOf(HasSubstr("psfd-bias"), HasSubstr("--trust-reference")));
  EXPECT_EQ(improvement.stop_reason, StopReason::reference_system);
  EXPECT_THAT(improvement.stop_explanation, HasSubstr("fly a yaw manoeuvre"));
}

// Shapes of nature differ from those of the catalogue, and then small differences of the likelihood are not
// evidence.
TEST_F(Improve, AnImprobableAliasOnTheOtherSystemCounts) {
  const Improvement improvement = run({two_rivals("adif-drift", "reference:time-drift", 0.999)});
  EXPECT_THAT(added(improvement), ElementsAre(""));
  EXPECT_EQ(improvement.stop_reason, StopReason::reference_system);
}

TEST_F(Improve, UninformativeHoldOutUsesFittedFlights) {
  held_out_tells_ = false;
  Diagnosis found = diagnosis(Verdict::identified, {"static-lag"});
  EXPECT_THAT(added(run({found, diagnosis(Verdict::none_detected)}, {1.0, 0.5})),
              ElementsAre("", "static-lag"));
  found.findings[0].chi2_reduction = 10.0;
  EXPECT_THAT(added(run({found}, {1.0, 0.5})), ElementsAre("")) << "less than two deviations";
}

TEST_F(Improve, DropsAnEffectThatCannotBeFitted) {
  loop_.refit = [this](const TrialModel& trial) {
    const ModelDefinition& model = trial.file;
    if (model.model.effects.size() > 2)
      throw Error(Error::Code::fit, "tau and a0 cannot all be free on these flights");
    return fitted(model);
  };
  const Improvement improvement = run({diagnosis(Verdict::identified, {"static-lag"})});
  EXPECT_THAT(added(improvement), ElementsAre(""));
  EXPECT_THAT(improvement.stop_explanation, AllOf(HasSubstr("static-lag"), HasSubstr("tau and a0")));
}

TEST_F(Improve, UnfittableModelIsReported) {
  loop_.refit = [](const TrialModel&) -> RefitResult {
    throw Error(Error::Code::samples, "no sample remains");
  };
  EXPECT_THROW(run({}), Error);
}

TEST_F(Improve, PartialFindingIsNotNamedAsCause) {
  const Improvement improvement =
      run({diagnosis(Verdict::partial, {"static-lag"}), diagnosis(Verdict::none_detected)}, {1.0, 0.9});
  EXPECT_THAT(added(improvement), ElementsAre("", "static-lag"));
  EXPECT_THAT(improvement.steps[1].summary, HasSubstr("not be the cause"));
}

TEST_F(Improve, TracesIfAPartialFindingDoesNotReduceTheResidual) {
  EXPECT_THAT(added(run({with_predictor(diagnosis(Verdict::partial, {"static-lag"}), "ENGTRQ"),
                         diagnosis(Verdict::none_detected)},
                        {1.0, 0.995, 0.6})),
              ElementsAre("", "traced-engtrq"));
}

TEST_F(Improve, AddsAFormulaOfATracedVariable) {
  const Improvement improvement =
      run({with_predictor(diagnosis(Verdict::unexplained), "ENG_Trq2"), diagnosis(Verdict::none_detected)},
          {1.0, 0.9});
  EXPECT_THAT(added(improvement), ElementsAre("", "traced-eng-trq2"));
  const ModelEffect& effect = improvement.model.model.effects.back();
  EXPECT_EQ(effect.formula, "k * (ENG_Trq2 - 48)");
  EXPECT_THAT(effect.parameters, ElementsAre(-0.03));
  EXPECT_THAT(effect.source, HasSubstr("one.nc"));
  EXPECT_EQ(write_model(parse_model(write_model(improvement.model), "it")), write_model(improvement.model));
  EXPECT_THAT(improvement.steps[1].summary, HasSubstr("cause is unknown"));
}

TEST_F(Improve, ATracedVariableMustReduceTheResidual) {
  const Improvement improvement =
      run({with_predictor(diagnosis(Verdict::unexplained), "ENGTRQ")}, {1.0, 0.991});
  EXPECT_THAT(added(improvement), ElementsAre(""));
  EXPECT_THAT(improvement.stop_explanation, HasSubstr("traced-engtrq"));
}

TEST_F(Improve, AdvisesTheRoleOfATracedVariableAfterARejection) {
  Diagnosis unnamed = with_predictor(diagnosis(Verdict::unexplained), "ENGTRQ");
  unnamed.unnamed_roles = {{"engine_torque", "ENGTRQ", "speedbrake-thrust"}};
  const Improvement improvement = run({unnamed}, {1.0, 0.991});
  EXPECT_EQ(improvement.stop_reason, StopReason::no_gain);
  EXPECT_THAT(improvement.stop_explanation, HasSubstr("engine_torque = \"ENGTRQ\""));
}

TEST_F(Improve, NeverAddsAnEffectTwice) {
  const Improvement improvement =
      run({with_predictor(diagnosis(Verdict::unexplained), "ENGTRQ")}, {1.0, 0.9, 0.8, 0.7});
  EXPECT_THAT(added(improvement), ElementsAre("", "traced-engtrq"));
  EXPECT_THAT(improvement.stop_explanation, HasSubstr("ENGTRQ"));
  EXPECT_EQ(run({diagnosis(Verdict::identified, {"static-qp"})}).stop_reason, StopReason::in_model);
}

TEST_F(Improve, TracesOnlyOnRequest) {
  loop_.trace_variables = false;
  const Improvement improvement = run({with_predictor(diagnosis(Verdict::unexplained), "ENGTRQ")});
  EXPECT_THAT(added(improvement), ElementsAre(""));
  EXPECT_EQ(improvement.stop_reason, StopReason::unexplained);
  EXPECT_THAT(improvement.stop_explanation, AllOf(HasSubstr("climb"), HasSubstr("ENGTRQ")));
}

TEST_F(Improve, ReportsAResidualThatNoVariableExplains) {
  Diagnosis unexplained = with_predictor(diagnosis(Verdict::unexplained), "ENGTRQ");
  unexplained.unexplained.variables.clear();
  const Improvement improvement = run({unexplained});
  EXPECT_EQ(improvement.stop_reason, StopReason::unexplained);
  EXPECT_THAT(improvement.stop_explanation, testing::Not(HasSubstr("ENGTRQ")));
}

TEST_F(Improve, StopsAfterTheMaximumNumberOfSteps) {
  loop_.max_steps = 2;
  const Improvement improvement = run(
      {diagnosis(Verdict::identified, {"static-lag", "static-mach", "static-mach2"})}, {1.0, 0.9, 0.8, 0.7});
  EXPECT_THAT(added(improvement), ElementsAre("", "static-lag", "static-mach"));
  EXPECT_EQ(improvement.stop_reason, StopReason::max_steps);
}

TEST_F(Improve, NoiseOfEachStepIsThatOfItsFit) {
  const Improvement improvement =
      run({diagnosis(Verdict::identified, {"static-lag"}), diagnosis(Verdict::none_detected)}, {1.0, 0.5});
  EXPECT_DOUBLE_EQ(improvement.steps[0].noise_rms, 0.5);
  EXPECT_DOUBLE_EQ(improvement.steps[1].noise_rms, 0.25);
}

TEST_F(Improve, DegradedModelIsReportedAsWorse) {
  given_rms_ = 0.75;
  EXPECT_THAT(run({diagnosis(Verdict::none_detected)}).rejection_reason, HasSubstr("1.3333"));
  given_rms_ = 1.25;
  const Improvement improvement = run({diagnosis(Verdict::none_detected)});
  EXPECT_EQ(improvement.rejection_reason, "");
  EXPECT_DOUBLE_EQ(improvement.given_rms_holdout, 1.25);
}

TEST_F(Improve, ModelThatFollowsTheFlightsButPredictsTheirPartsWorseIsReported) {
  loop_.has_holdout = false;
  Diagnosis none_detected = diagnosis(Verdict::none_detected);
  for (const double given : {1.0, 1.1}) {  // the fit has 1.0
    given_rms_ = given;
    const double before = run({none_detected}).given_rms_train;
    for (const double held_out : {1.24, 1.26}) {
      none_detected.residual_rms_held_out = held_out * before;
      EXPECT_EQ(run({none_detected}).rejection_reason.empty(), given == 1.0 || held_out < 1.25)
          << given << " " << held_out;
    }
  }
}

TEST_F(Improve, GivenModelWithoutResidualIsComparedByItsRefit) {
  given_rms_ = std::nan("");
  EXPECT_EQ(run({diagnosis(Verdict::none_detected)}).rejection_reason, "");
  loop_.offer_surface = helpful_surface;
  const Improvement improvement = run({diagnosis(Verdict::unexplained)}, {1.0, 1.5});
  EXPECT_TRUE(std::isnan(improvement.given_rms_holdout));
  EXPECT_THAT(improvement.rejection_reason, HasSubstr("1.5000"));
}

TEST_F(Improve, UnknownRmsOfTheGivenModelIsOmitted) {
  loop_.refit = [this](const TrialModel& model) {
    RefitResult fit = fitted(model.file);
    fit.rms_before = std::nan("");
    return fit;
  };
  EXPECT_THAT(run({diagnosis(Verdict::none_detected)}).steps[0].summary,
              AllOf(HasSubstr("0.9900"), testing::Not(HasSubstr("nan"))));
}

TEST_F(Improve, HeldOutBiasPreventsSilentVerdict) {
  loop_.refit = [this](const TrialModel& model) {
    RefitResult fit = fitted(model.file);
    fit.flights.back().after.rms = 0.272;
    fit.flights.back().flight = "later.nc";
    fit.flights.back().after.bias = 0.14;
    fit.flights.back().expected_bias = 0.03;
    return fit;
  };
  const Improvement improvement = run({diagnosis(Verdict::none_detected)});
  EXPECT_EQ(improvement.steps.back().diagnosis.verdict, Verdict::unexplained);
  EXPECT_THAT(improvement.stop_explanation, AllOf(HasSubstr("later.nc"), HasSubstr("+0.140 hPa"),
                                                  HasSubstr("0.272 hPa"), HasSubstr("+- 0.030 hPa")));
}

TEST_F(Improve, WithoutHeldOutFlightsCrossValidationDecides) {
  loop_.has_holdout = false;
  Diagnosis first = diagnosis(Verdict::identified, {"static-lag"});
  Diagnosis second = diagnosis(Verdict::none_detected);
  first.residual_rms_held_out = 0.8;
  second.residual_rms_held_out = 0.9;
  const Improvement improvement = run({first, second});
  EXPECT_THAT(added(improvement), ElementsAre(""));
  EXPECT_DOUBLE_EQ(improvement.steps[0].rms_holdout, 0.8);
  EXPECT_FALSE(improvement.holdout_is_flights);
  EXPECT_THAT(improvement.stop_explanation, HasSubstr("static-lag"));
}

TEST_F(Improve, UncertainEffectIsRejectedWithoutADiagnosisOfTheExtendedModel) {
  loop_.has_holdout = false;
  Diagnosis unsure = diagnosis(Verdict::identified, {"static-lag"});
  unsure.residual_rms_held_out = 1.0;
  unsure.findings.front().chi2_reduction = 1.6 * unsure.findings.front().chi2_reduction_error;
  Diagnosis better = diagnosis(Verdict::none_detected);
  better.residual_rms_held_out = 0.5;
  const Improvement improvement = run({unsure, better, better}, {1.0, 0.5});
  EXPECT_EQ(diagnoses_.size(), 2U) << "one diagnosis, of the input model";
  EXPECT_THAT(added(improvement), ElementsAre(""));
  EXPECT_THAT(improvement.stop_explanation, HasSubstr("static-lag"));
}

using Series = std::vector<double>;

TEST(RivalChoice, MoreProbableRivalIsChosen) {
  const RivalChoice choice = choose_rival({Series(10, 0.8), Series(10, 1.2)}, {0.75, 0.25}, 0.01);
  EXPECT_EQ(choice.rival, 0U);
  EXPECT_NEAR(choice.error, std::sqrt(0.25) * 0.4, 1e-12);  // rounding
}

TEST(RivalChoice, MiddleRivalOfLeastErrorIsChosen) {
  EXPECT_EQ(choose_rival({Series(5, 0.5), Series(5, 1.0), Series(5, 1.5)}, {0.4, 0.3, 0.3}, 0.01).rival, 1U);
}

TEST(RivalChoice, AppliesNoRivalIfAnotherMakesItHarmful) {
  const RivalChoice choice = choose_rival({Series(10, 0.8), Series(10, -0.6)}, {0.9, 0.1}, 0.01);
  EXPECT_NEAR(choice.error_of_first, 1.4 * std::sqrt(0.1), 1e-12);
  EXPECT_FALSE(choice.rival.has_value());
  EXPECT_NEAR(choice.error, std::sqrt(0.9 * 0.64 + 0.1 * 0.36), 1e-12);  // rounding
}

TEST(RivalChoice, UnchangedRivalLimitsCorrectionToTolerance) {
  EXPECT_FALSE(choose_rival({Series(10, 0.5), Series(10, 0.0)}, {0.99, 0.01}, 0.01).rival.has_value());
  EXPECT_TRUE(choose_rival({Series(10, 0.009), Series(10, 0.0)}, {0.99, 0.01}, 0.01).rival.has_value());
}

TEST(RivalChoice, IrrelevantDifferencesKeepTheFirstRival) {
  EXPECT_EQ(choose_rival({Series(10, 0.004), Series(10, -0.004)}, {0.5, 0.5}, 0.01).rival, 0U);
  EXPECT_EQ(choose_rival({Series(10, 0.0), Series(10, 0.0)}, {0.5, 0.5}, 0.0).rival, 0U);
}

TEST(RivalChoice, MissingSamplesAreIgnored) {
  const RivalChoice choice = choose_rival({{1.0, nan, 1.0}, {1.0, 5.0, nan}}, {0.5, 0.5}, 0.01);
  EXPECT_TRUE(choice.rival.has_value());
  EXPECT_EQ(choice.error, 0.0);
}

}  // namespace
}  // namespace pcor::internal
